// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/config/config.hpp"
#include "common/config/values.hpp"
#include "tests/unit/config/parse_problems.hpp"

namespace clearway::config {
namespace {

constexpr int kNumTrials = 500;

class RandomConfig {
 public:
  explicit RandomConfig(std::uint64_t seed) : random_(seed) {}

  sample::Root Make() {
    sample::Root root;
    root.speed_mps = Real(0.0, 5.0);
    root.preprocessor.backend =
        Whole(0, 1) == 0 ? sample::Backend::kNative : sample::Backend::kTextbook;
    root.preprocessor.deskew = Whole(0, 1) == 0;
    root.preprocessor.window_us = Whole(1000, 1'000'000);
    root.preprocessor.voxel_grid = {.leaf_m = Real(0.005, 2.0), .min_points = Whole(1, 100)};
    root.preprocessor.floor = {.tilt_rad = internal::RadFromDeg(Real(0.0, 45.0)),
                               .lo_m = Real(-1.0, 0.0),
                               .hi_m = Real(0.001, 1.0)};
    root.sensors.resize(static_cast<std::size_t>(Whole(1, 4)));
    for (std::size_t i = 0; i < root.sensors.size(); ++i) {
      root.sensors[i] = {.name = std::to_string(i) + Text(),
                         .x_m = Real(-10.0, 10.0),
                         .yaw_rad = internal::RadFromDeg(Real(-180.0, 180.0))};
    }
    return root;
  }

 private:
  double Real(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random_);
  }
  int Whole(int lo, int hi) { return std::uniform_int_distribution<int>(lo, hi)(random_); }

  std::string Text() {
    std::string text(static_cast<std::size_t>(Whole(0, 12)), ' ');
    for (char& letter : text) letter = static_cast<char>(Whole(' ', '~'));
    return text;
  }

  std::mt19937_64 random_;
};

TEST(RoundTripTest, ThroughXmlKeepsEveryBit) {
  RandomConfig random(11);

  for (int i = 0; i < kNumTrials; ++i) {
    const sample::Root root = random.Make();
    EXPECT_EQ(Parse<sample::Root>(ToXml(root), "a.xml").root, root);
    EXPECT_EQ(Parse<sample::Root>(ToXml(root, {.with_help = true}), "a.xml").root, root);
  }
}

/// The text before the comment of each line. No text value of this test holds "  # ".
std::vector<std::string> WithoutComments(const std::string& printed) {
  std::vector<std::string> lines;
  std::istringstream stream(printed);
  for (std::string line; std::getline(stream, line);)
    lines.push_back(line.substr(0, line.rfind("  # ")));
  return lines;
}

TEST(RoundTripTest, ThroughPrintAndSetKeepsEveryBit) {
  RandomConfig random(12);

  for (int i = 0; i < kNumTrials; ++i) {
    const sample::Root root = random.Make();
    std::string items;
    for (std::size_t k = 0; k < root.sensors.size(); ++k) items += "<sensor/>";
    const std::vector<std::string> overrides =
        WithoutComments(Print(LoadResult<sample::Root>{root, {}}));
    EXPECT_EQ(Parse<sample::Root>(InRoot(items), "a.xml", overrides).root, root);
  }
}

TEST(RoundTripTest, OfTheDefaultsKeepsEveryBit) {
  EXPECT_EQ(Parse<sample::Root>(ToXml(sample::Root{}), "a.xml").root, sample::Root{});
}

}  // namespace
}  // namespace clearway::config
