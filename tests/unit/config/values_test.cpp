// SPDX-License-Identifier: BSD-3-Clause
#include "common/config/values.hpp"

#include <bit>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <limits>
#include <locale>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace clearway::config::internal {
namespace {

TEST(ParseNumberTest, AcceptsDecimalsWithSignAndExponent) {
  EXPECT_EQ(ParseNumber("0.05"), 0.05);
  EXPECT_EQ(ParseNumber("-3"), -3.0);
  EXPECT_EQ(ParseNumber("1e3"), 1000.0);
  EXPECT_EQ(ParseNumber("2.5E-2"), 0.025);
  EXPECT_EQ(ParseNumber(".5"), 0.5);
  EXPECT_FALSE(std::signbit(*ParseNumber("-0")));
}

class BadNumberTest : public testing::TestWithParam<const char*> {};

TEST_P(BadNumberTest, IsRefused) {
  EXPECT_EQ(ParseNumber(GetParam()), std::nullopt);
  EXPECT_EQ(ParseInteger(GetParam()), std::nullopt);
  EXPECT_EQ(ParseMilliseconds(GetParam()), std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(EachClass,
                         BadNumberTest,
                         testing::Values("",
                                         " ",
                                         "1.0x",
                                         "1 ",
                                         " 1",
                                         "+1",
                                         "--1",
                                         "0x10",
                                         "1,5",
                                         "1.5.2",
                                         "nan",
                                         "NaN",
                                         "inf",
                                         "-inf",
                                         "infinity",
                                         "1e999",
                                         "-1e999",
                                         "1e",
                                         "e5",
                                         "one",
                                         "-"));

TEST(ParseIntegerTest, RefusesFractionsAndWhatAnIntCannotHold) {
  EXPECT_EQ(ParseInteger("2147483647"), 2147483647);
  EXPECT_EQ(ParseInteger("-2147483648"), std::numeric_limits<int>::min());
  EXPECT_EQ(ParseInteger("2147483648"), std::nullopt);
  EXPECT_EQ(ParseInteger("99999999999999999999"), std::nullopt);
  EXPECT_EQ(ParseInteger("1.0"), std::nullopt);
  EXPECT_EQ(ParseInteger("1e3"), std::nullopt);
}

TEST(ParseMillisecondsTest, KeepsEachMicrosecondAndRefusesLess) {
  EXPECT_EQ(ParseMilliseconds("50"), 50'000);
  EXPECT_EQ(ParseMilliseconds("0.1"), 100);
  EXPECT_EQ(ParseMilliseconds("-1.001"), -1001);
  EXPECT_EQ(ParseMilliseconds("0.0005"), std::nullopt);
  EXPECT_EQ(ParseMilliseconds("1e300"), std::nullopt);
}

TEST(ParseMillisecondsTest, IsTheInverseOfFormat) {
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::int64_t> any_time_us(-1'000'000'000'000'000,
                                                          1'000'000'000'000'000);
  std::uniform_int_distribution<std::int64_t> short_time_us(-10'000'000, 10'000'000);

  for (int i = 0; i < 20'000; ++i) {
    const std::int64_t time_us = i % 2 == 0 ? any_time_us(random) : short_time_us(random);
    EXPECT_EQ(ParseMilliseconds(FormatMilliseconds(time_us)), time_us);
  }
}

TEST(FormatNumberTest, IsShortAndReadable) {
  EXPECT_EQ(FormatNumber(0.05), "0.05");
  EXPECT_EQ(FormatNumber(-0.0), "0");
  EXPECT_EQ(FormatNumber(100000.0), "100000");
  EXPECT_EQ(FormatNumber(0.0001), "0.0001");
  EXPECT_EQ(FormatNumber(0.1 + 0.2), "0.30000000000000004");
  EXPECT_EQ(FormatNumber(1e22), "1e+22");
}

TEST(FormatNumberTest, KeepsEveryBitOfAnyFiniteNumber) {
  std::mt19937_64 random(2);

  for (int i = 0; i < 20'000; ++i) {
    const double value = std::bit_cast<double>(random());
    if (!std::isfinite(value) || std::fpclassify(value) == FP_SUBNORMAL) continue;
    EXPECT_EQ(ParseNumber(FormatNumber(value)), value);
  }
}

TEST(FormatDegreesTest, ShowsWhatSomebodyWrote) {
  for (int tenths = -3600; tenths <= 3600; ++tenths) {
    const double angle_deg = tenths / 10.0;
    EXPECT_EQ(FormatDegrees(RadFromDeg(angle_deg)), FormatNumber(angle_deg));
    // The other order of operations, which code may use for a default.
    EXPECT_EQ(FormatDegrees(angle_deg * (std::numbers::pi / 180.0)), FormatNumber(angle_deg));
  }
  EXPECT_EQ(FormatDegrees(std::numbers::pi), "180");
  EXPECT_EQ(FormatDegrees(std::numbers::pi / 2), "90");
}

TEST(FormatDegreesTest, TextToRadiansToTextToRadiansIsExact) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any_angle_deg(-180.0, 180.0);

  for (int i = 0; i < 20'000; ++i) {
    const double angle_rad = ToCanonicalRad(any_angle_deg(random));
    EXPECT_EQ(RadFromDeg(*ParseNumber(FormatDegrees(angle_rad))), angle_rad);
  }
}

TEST(ToCanonicalRadTest, PrefersTheShortNumberNextToALongOne) {
  EXPECT_EQ(ToCanonicalRad(15.000000000000002), RadFromDeg(15.0));
  EXPECT_EQ(ToCanonicalRad(15.0000000001), RadFromDeg(15.0000000001));
}

/// Decimal comma and grouped thousands, without a locale having to be installed.
class GermanNumbers : public std::numpunct<char> {
 protected:
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(NumbersTest, DoNotDependOnTheLocale) {
  const std::locale before = std::locale::global(std::locale(std::locale(), new GermanNumbers));
  const std::string c_before = std::setlocale(LC_ALL, nullptr);
  for (const char* const name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"}) {
    if (std::setlocale(LC_ALL, name) != nullptr) break;
  }

  const auto number = ParseNumber("1234.5");
  const auto with_comma = ParseNumber("1234,5");
  const std::string text = FormatNumber(1234.5);
  std::setlocale(LC_ALL, c_before.c_str());
  std::locale::global(before);

  EXPECT_EQ(number, 1234.5);
  EXPECT_EQ(with_comma, std::nullopt);
  EXPECT_EQ(text, "1234.5");
}

TEST(QuoteTest, UnquoteIsItsInverse) {
  for (const std::string text : {"", "plain", "a \"b\" # c", "\\", "\\\"", " x = y "}) {
    EXPECT_EQ(Unquote(Quote(text)), text);
  }
}

TEST(UnquoteTest, RefusesIncompleteTexts) {
  for (const char* const text : {"", "\"", "a", "\"a", "a\"", "\"a\"b\"", "\"a\\\"", "\"\\n\""})
    EXPECT_EQ(Unquote(text), std::nullopt) << text;
}

TEST(ShownTest, IsOneShortLine) {
  EXPECT_EQ(Shown("a\nb\x7f"), "a\\x0ab\\x7f");
  EXPECT_EQ(Shown(std::string(100, 'x')), std::string(60, 'x') + "...");
  // 59 letters and a two-byte letter, which must not be cut in half.
  EXPECT_EQ(Shown(std::string(59, 'x') + "\xc3\xa4yy"), std::string(59, 'x') + "...");
}

}  // namespace
}  // namespace clearway::config::internal
