// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>

#include "common/core/cloud.hpp"
#include "common/core/preprocessing/preprocessor.hpp"

namespace clearway::test {

/// Limits of the two buses: within a host, and between hosts.
inline constexpr std::size_t kLocalLimit = 58000;
inline constexpr std::size_t kRemoteLimit = 1400;

/// A cloud in which every array has values of its own.
inline core::PointCloud RandomCloud(std::size_t size, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> metres(-50.0F, 50.0F);
  core::PointCloud cloud;
  for (std::size_t i = 0; i < size; ++i) {
    cloud.Add({metres(random), metres(random), metres(random)},
              static_cast<std::uint8_t>(random() % 256),
              static_cast<std::uint8_t>(random() % 256),
              static_cast<std::int32_t>(random() % 100'000));
  }
  return cloud;
}

/// A preprocessed scan whose fields all differ, with `points` obstacle points.
inline core::PreprocessedScan SomePreprocessedScan(std::size_t points) {
  core::PreprocessedScan scan;
  scan.scan_id = 42;
  scan.utime_start = 1'700'000'000'000'000;
  scan.utime = scan.utime_start + 100'000;
  scan.obstacles_vehicle = RandomCloud(points, 7);
  for (std::size_t i = 0; i < points; ++i) {
    scan.flags.push_back(i % 3 == 0 ? core::kFlagBelowFloor : std::uint8_t{0});
  }
  scan.deskew = core::DeskewState::kDeskewed;
  scan.counts.in = 10'000;
  scan.counts.zero = 300;
  scan.counts.kept = 9'000;
  scan.counts.voxels = 5'000;
  scan.counts.floor = 3'000;
  scan.counts.above = 1'900;
  scan.counts.below = 100;
  scan.complete = false;
  scan.missing_slices = 2;
  return scan;
}

}  // namespace clearway::test
