// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/mid70_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace clearway::core {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kCell_deg = 0.28;  // Width of the MID-70's beam.
constexpr int kHalfGrid = 130;      // Cells from the middle to beyond the rim.

double OffAxis_rad(const Eigen::Vector3d& direction) {
  return std::atan2(std::hypot(direction.y(), direction.z()), direction.x());
}

// Share of the azimuth-elevation cells inside the circular field that the first shots hit.
double CoveredShare(std::int64_t num_shots) {
  constexpr int kSide = 2 * kHalfGrid;
  const auto cell_of = [](double angle_deg) {
    return static_cast<int>(std::floor(angle_deg / kCell_deg)) + kHalfGrid;
  };
  std::vector<char> is_hit(kSide * kSide, 0);
  for (std::int64_t k = 0; k < num_shots; ++k) {
    const Eigen::Vector3d d = Mid70Direction(k);
    const int column = cell_of(std::atan2(d.y(), d.x()) / kDegree);
    const int row = cell_of(std::asin(d.z()) / kDegree);
    is_hit[static_cast<std::size_t>(row * kSide + column)] = 1;
  }
  int inside = 0;
  int hit = 0;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      const double azimuth_deg = (column - kHalfGrid + 0.5) * kCell_deg;
      const double elevation_deg = (row - kHalfGrid + 0.5) * kCell_deg;
      if (std::hypot(azimuth_deg, elevation_deg) > kMid70MaxOffAxis_rad / kDegree) continue;
      ++inside;
      hit += is_hit[static_cast<std::size_t>(row * kSide + column)];
    }
  }
  return static_cast<double>(hit) / inside;
}

// The published sum of six pointers, term by term.
Eigen::Vector3d DirectionBySum(std::int64_t k) {
  struct Term {
    double amplitude;
    double p;
    double q;
  };
  constexpr Term kTerms[] = {{0.298995, 1, 0},
                             {0.286091, 0, 1},
                             {0.020277, 2, -1},
                             {0.006169, -1, 2},
                             {0.002022, 3, -2},
                             {0.000674, -2, 3}};
  const double t_s = static_cast<double>(k + 1) * 1e-5;
  std::complex<double> w = 0.0;
  for (const Term& term : kTerms) {
    const double turns = (term.p * -4664.0 / 60.0 + term.q * 7294.0 / 60.0) * t_s;
    w -= std::polar(term.amplitude, 2.0 * std::numbers::pi * turns);
  }
  return {std::cos(std::abs(w)),
          std::sin(std::abs(w)) * std::cos(std::arg(w)),
          std::sin(std::abs(w)) * std::sin(std::arg(w))};
}

TEST(Mid70Pattern, EqualsTheSumOfItsTerms) {
  constexpr double kTolerance = 1e-9;

  for (std::int64_t k = 0; k < 3'000'000; k += 997) {
    const Eigen::Vector3d direction = Mid70Direction(k);

    ASSERT_NEAR((direction - DirectionBySum(k)).norm(), 0.0, kTolerance) << "shot " << k;
    ASSERT_NEAR(direction.norm(), 1.0, 1e-12) << "shot " << k;
  }
}

TEST(Mid70Pattern, StaysWithinTheCircularField) {
  // The vendor's ray table reaches 35.216 deg; the formula follows it within 0.0232 deg.
  constexpr double kTolerance_deg = 0.0235;

  double largest_rad = 0.0;
  for (std::int64_t k = 0; k < 400'000; ++k) {
    largest_rad = std::max(largest_rad, OffAxis_rad(Mid70Direction(k)));
  }

  EXPECT_NEAR(largest_rad / kDegree, 35.216, kTolerance_deg);
  EXPECT_LE(largest_rad, kMid70MaxOffAxis_rad);
}

TEST(Mid70Pattern, CoversTheFieldAsFastAsTheRealHead) {
  constexpr double kTolerance = 0.01;  // One percentage point.
  const std::pair<std::int64_t, double> kShares[] = {
      {10'000, 0.106}, {20'000, 0.20}, {40'000, 0.36}, {60'000, 0.49}, {100'000, 0.70}};

  for (const auto& [num_shots, share] : kShares) {
    EXPECT_NEAR(CoveredShare(num_shots), share, kTolerance) << num_shots << " shots";
  }
}

TEST(Mid70Pattern, RepeatsAfterThirtySeconds) {
  constexpr std::int64_t kPeriod = 3'000'000;

  for (std::int64_t k = 0; k < 1000; k += 7) {
    EXPECT_EQ(Mid70Direction(k), Mid70Direction(k + 5 * kPeriod));
  }
  EXPECT_GT((Mid70Direction(0) - Mid70Direction(kPeriod / 2)).norm(), 0.01);
}

}  // namespace
}  // namespace clearway::core
