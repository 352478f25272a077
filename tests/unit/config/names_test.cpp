// SPDX-License-Identifier: BSD-3-Clause
#include "common/config/names.hpp"

#include <algorithm>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace clearway::config::internal {
namespace {

/// The definition, by recursion.
std::size_t DistanceByDefinition(std::string_view a, std::string_view b) {
  if (a.empty()) return b.size();
  if (b.empty()) return a.size();
  const std::size_t replaced =
      DistanceByDefinition(a.substr(1), b.substr(1)) + (a.front() == b.front() ? 0 : 1);
  return std::min({replaced,
                   DistanceByDefinition(a.substr(1), b) + 1,
                   DistanceByDefinition(a, b.substr(1)) + 1});
}

std::string RandomWord(std::mt19937& random) {
  std::string word(random() % 6, 'a');
  for (char& letter : word) letter = static_cast<char>('a' + random() % 3);
  return word;
}

TEST(EditDistanceTest, AgreesWithTheDefinition) {
  std::mt19937 random(4);

  for (int i = 0; i < 300; ++i) {
    const std::string a = RandomWord(random);
    const std::string b = RandomWord(random);
    EXPECT_EQ(EditDistance(a, b), DistanceByDefinition(a, b)) << a << " " << b;
  }
}

TEST(NearestNameTest, SuggestsTheNearestOfNearNames) {
  EXPECT_EQ(NearestName("heigth_m", {"width_m", "height_m"}), "height_m");
  EXPECT_EQ(NearestName("leafm", {"leaf_m", "min_points"}), "leaf_m");
  EXPECT_EQ(NearestName("ab", {"ac", "ad"}), "ac");
}

TEST(NearestNameTest, SuggestsNothingFarOff) {
  EXPECT_EQ(NearestName("banana", {"leaf_m", "min_points"}), "");
  EXPECT_EQ(NearestName("leaf_m", {}), "");
  EXPECT_EQ(NearestName(std::string(100, 'a'), {"a"}), "");
}

}  // namespace
}  // namespace clearway::config::internal
