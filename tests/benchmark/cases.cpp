// SPDX-License-Identifier: BSD-3-Clause
#include "tests/benchmark/cases.hpp"

#include <numbers>
#include <utility>

#include "tests/support/make_room.hpp"
#include "tests/support/recorded_scan.hpp"

namespace clearway::bench {
namespace {

constexpr float kMaxRange_m = 60.0F;

// A hall seen all around: 1,000,000 points of which some 400,000 cells remain.
core::PointCloud MakeHall() {
  return test::MakeRoom({.num_points = 1'000'000,
                         .size_m = {80.0, 60.0, 12.0},
                         .num_boxes = 200,
                         .half_field_rad = std::numbers::pi});
}

// A few returns at 303 m: with a leaf of 0.05 m the cells of the bounding box no longer fit 32
// bits.
core::PointCloud MakeFarReturns() {
  core::PointCloud cloud = test::MakeRoom({});
  for (const float sign : {-1.0F, 1.0F}) {
    cloud.Add({sign * 303.0F, 0.0F, 1.0F});
    cloud.Add({0.0F, sign * 303.0F, 1.0F});
    cloud.Add({0.0F, 0.0F, sign * 303.0F});
  }
  return cloud;
}

// A dense block: each cell a point, all cells within reach of some 250 others.
core::PointCloud MakeDense() {
  test::Random random(2);
  core::PointCloud cloud = test::MakeRoom({});
  for (int i = 0; i < 40'000; ++i) {
    cloud.Add(Eigen::Vector3d(
                  random.Uniform(2.0, 3.0), random.Uniform(-0.5, 0.5), random.Uniform(0.1, 1.1))
                  .cast<float>());
  }
  return cloud;
}

// All obstacle points on one line.
core::PointCloud MakeLine() {
  core::PointCloud cloud = test::MakeRoom({.num_boxes = 0});
  for (int i = 0; i < 20'000; ++i) {
    cloud.Add({1.0F + 0.001F * static_cast<float>(i), 0.0F, 1.0F});
  }
  return cloud;
}

// Half of all returns at the very same place.
core::PointCloud MakeDuplicates() {
  core::PointCloud cloud = test::MakeRoom({});
  for (int i = 0; i < 10'000; ++i) cloud.Add({2.0F, 0.5F, 0.5F});
  return cloud;
}

}  // namespace

std::vector<Case> MakeCases(bool with_slow) {
  std::vector<Case> cases;
  cases.push_back({"mid70_10k", test::MakeRoom({})});
  for (const auto& scan : {test::kLivoxHorizon, test::kIndoor28k, test::kKittiFull}) {
    core::PointCloud cloud = test::LoadScan(scan, kMaxRange_m);
    if (!cloud.empty()) cases.push_back({scan.name, std::move(cloud)});
  }
  cases.push_back({"adversarial_far_returns", MakeFarReturns()});
  cases.push_back({"adversarial_line", MakeLine()});
  cases.push_back({"adversarial_duplicates", MakeDuplicates()});
  if (with_slow) {
    cases.push_back({"adversarial_dense", MakeDense(), 3});
    cases.push_back({"generated_1m", MakeHall(), 1});
  }
  return cases;
}

}  // namespace clearway::bench
