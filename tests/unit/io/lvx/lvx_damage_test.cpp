// SPDX-License-Identifier: BSD-3-Clause
// Files that were cut short or are damaged: what is whole is read, the rest is told.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/lvx/lvx_reader.hpp"
#include "tests/unit/io/lvx/lvx_maker.hpp"

namespace clearway::io {
namespace {

using test::BytesOf;
using test::LvxMaker;
using test::MakePackage;
using test::ReadAll;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::size_t kHeader = 88;
constexpr std::size_t kFrameHeader = 24;
constexpr std::size_t kPackage = 1363;

const std::string kA = MakePackage(0, 2, 1);
const std::string kB = MakePackage(0, 2, 2);
const std::string kC = MakePackage(0, 2, 3);
const std::string kD = MakePackage(0, 2, 4);

std::string File() {
  return LvxMaker{.frames = {{kA, kB}, {kC}, {kD}}}.File();
}
constexpr std::size_t kSecondFrame = kHeader + kFrameHeader + 2 * kPackage;
constexpr std::size_t kThirdFrame = kSecondFrame + kFrameHeader + kPackage;

void Put(std::string& file, std::size_t at, std::uint64_t number) {
  std::string bytes;
  test::AppendNumber(bytes, number, 8);
  file.replace(at, 8, bytes);
}

// Oracle: how many whole packages lie before the cut.
TEST(LvxDamage, AFileCutAnywhereIsReadAsFarAsItIsWhole) {
  const std::string file = File();
  const std::vector<std::size_t> ends{kHeader + kFrameHeader + kPackage,
                                      kHeader + kFrameHeader + 2 * kPackage,
                                      kThirdFrame,
                                      kThirdFrame + kFrameHeader + kPackage};
  for (std::size_t size = kHeader; size < file.size(); ++size) {
    LvxReader reader(file.substr(0, size), "a.lvx");

    const auto packages = ReadAll(reader);

    const auto whole =
        std::count_if(ends.begin(), ends.end(), [size](std::size_t end) { return end <= size; });
    ASSERT_EQ(packages.size(), static_cast<std::size_t>(whole)) << size;
    const bool is_between_frames = size == kHeader || size == kSecondFrame || size == kThirdFrame;
    EXPECT_EQ(reader.report().cut_at.has_value(), !is_between_frames) << size;
    EXPECT_EQ(reader.report().damages, 0) << size;
    if (!is_between_frames) {
      EXPECT_THAT(reader.report().cut, HasSubstr("a.lvx: byte ")) << size;
      EXPECT_LE(*reader.report().cut_at, size);
    }
  }
}

TEST(LvxDamage, ALastFrameThatWasNeverFinishedIsRead) {
  std::string file = File();
  Put(file, kThirdFrame + 8, 0);
  LvxReader reader(file, "a.lvx");

  EXPECT_THAT(BytesOf(ReadAll(reader)), ElementsAre(kA, kB, kC, kD));
  EXPECT_THAT(reader.report().cut, HasSubstr("was never finished"));
}

TEST(LvxDamage, PackagesOfOtherSensorsArePassedOverAndCounted) {
  for (const std::uint8_t type : std::vector<std::uint8_t>{6, 7, 8}) {
    LvxReader reader(LvxMaker{.frames = {{kA, MakePackage(0, type, 9), kB}, {kC}}}.File(), "a.lvx");

    EXPECT_THAT(BytesOf(ReadAll(reader)), ElementsAre(kA, kB, kC));
    EXPECT_EQ(reader.report().foreign_types, 1);
    EXPECT_EQ(reader.report().damages, 0);
    EXPECT_THAT(reader.report().first_problem,
                HasSubstr("byte 1475: a package of data type " + std::to_string(type)));
  }
}

TEST(LvxDamage, PackagesOfADeviceThatIsNotListedArePassedOverAndCounted) {
  LvxReader reader(LvxMaker{.frames = {{kA, MakePackage(1, 2, 9), kB}}}.File(), "a.lvx");

  EXPECT_THAT(BytesOf(ReadAll(reader)), ElementsAre(kA, kB));
  EXPECT_EQ(reader.report().unknown_devices, 1);
  EXPECT_THAT(reader.report().first_problem, HasSubstr("byte 1475: a package of device 1"));
}

// Without a size there is no way to the next package: the rest of the frame is lost, no more.
TEST(LvxDamage, WhatIsNoPackageCostsTheRestOfItsFrame) {
  struct Case {
    std::size_t at;
    char value;
    const char* text;
  };
  for (const Case& damage : {Case{1, 4, "its version must be 5 and is 4"},
                             Case{9, 6, "no type of time stamp 6"},
                             Case{10, 9, "no data type 9"},
                             Case{10, -1, "no data type 255"}}) {
    std::string file = File();
    file[kHeader + kFrameHeader + damage.at] = damage.value;
    LvxReader reader(file, "a.lvx");

    EXPECT_THAT(BytesOf(ReadAll(reader)), ElementsAre(kC, kD)) << damage.text;
    EXPECT_EQ(reader.report().damages, 1);
    EXPECT_EQ(reader.report().lost_bytes, 2 * kPackage);
    EXPECT_THAT(reader.report().first_problem, HasSubstr(damage.text));
    EXPECT_FALSE(reader.report().cut_at);
  }
}

TEST(LvxDamage, AFrameThatEndsInsideAPackageLosesThatPackageOnly) {
  std::string file = File();
  file[kHeader + kFrameHeader + 10] = 7;  // Triple returns: 1279 bytes, so that all shifts.
  LvxReader reader(file, "a.lvx");

  EXPECT_THAT(BytesOf(ReadAll(reader)), ElementsAre(kC, kD));
  EXPECT_GE(reader.report().damages, 1);
}

class LvxChainTest : public testing::TestWithParam<std::uint64_t> {};

// Wherever the first frame says that it ends: nothing but packages is given, and the others come.
TEST_P(LvxChainTest, AFrameWithAWrongEndCostsNoOtherFrame) {
  std::string file = File();
  Put(file, kHeader + 8, GetParam());
  LvxReader reader(file, "a.lvx");

  const auto packages = BytesOf(ReadAll(reader));

  EXPECT_EQ(reader.report().damages, 1);
  EXPECT_THAT(reader.report().first_problem, HasSubstr("a.lvx: byte "));
  ASSERT_GE(packages.size(), 2U);
  EXPECT_THAT((std::vector<std::string>(packages.end() - 2, packages.end())), ElementsAre(kC, kD));
}

INSTANTIATE_TEST_SUITE_P(Ends,
                         LvxChainTest,
                         testing::Values(0,
                                         1,
                                         kHeader,
                                         kHeader + kFrameHeader - 1,
                                         kHeader + kFrameHeader + 5,
                                         kSecondFrame - 1,
                                         kSecondFrame + 1,
                                         1'000'000,
                                         ~std::uint64_t{0}));

TEST(LvxDamage, AHoleBetweenFramesIsPassedOver) {
  const std::string whole = File();
  std::string file = whole;
  file.replace(kSecondFrame, kFrameHeader + kPackage, kFrameHeader + kPackage, '\x55');
  LvxReader reader(file, "a.lvx");

  EXPECT_THAT(BytesOf(ReadAll(reader)), ElementsAre(kA, kB, kD));
  EXPECT_EQ(reader.report().damages, 1);
  EXPECT_EQ(reader.report().lost_bytes, kFrameHeader + kPackage);
}

TEST(LvxDamage, BytesBehindTheLastFrameAreTold) {
  LvxReader reader(File() + std::string(100, 'x'), "a.lvx");

  EXPECT_EQ(ReadAll(reader).size(), 4U);
  EXPECT_EQ(reader.report().damages, 1);
  EXPECT_EQ(reader.report().lost_bytes, 100U);
}

}  // namespace
}  // namespace clearway::io
