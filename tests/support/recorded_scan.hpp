// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "common/core/cloud.hpp"
#include "tests/support/test_data.hpp"

namespace clearway::test {

/// A scan of raw little-endian floats among the real recordings.
struct RecordedScan {
  const char* name;
  const char* path;  ///< Below the recordings: a file, or a folder whose first file counts.
  std::size_t floats_a_point;  ///< 3 (x y z) or 4 (x y z intensity).
  float floor_z_m;             ///< Height of the floor in the sensor's frame.
};

inline constexpr RecordedScan kLivoxHorizon{"livox_horizon", "livox/livox_horizon.bin", 4, -1.85F};
inline constexpr RecordedScan kIndoor28k{"indoor_28k",
                                         "indoor_people/consecutive/velodyne",
                                         3,
                                         -0.88F};
inline constexpr RecordedScan kKittiFull{"kitti_full", "kitti_full", 4, -1.73F};

inline std::filesystem::path FirstBinFile(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return path;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
    if (entry.path().extension() == ".bin") files.push_back(entry.path());
  }
  return files.empty() ? path : *std::min_element(files.begin(), files.end());
}

/// The points with the floor moved to z = 0; empty when the recording is not here. With
/// max_range_m, only those within it in the plane.
inline core::PointCloud LoadScan(const RecordedScan& scan, float max_range_m = INFINITY) {
  core::PointCloud cloud;
  const auto path = TestData(scan.path);
  if (!path) return cloud;
  std::ifstream file(FirstBinFile(*path), std::ios::binary);
  std::vector<float> values(scan.floats_a_point);
  const auto num_bytes = static_cast<std::streamsize>(values.size() * sizeof(float));
  while (file.read(reinterpret_cast<char*>(values.data()), num_bytes)) {
    if (!(std::hypot(values[0], values[1]) <= max_range_m)) continue;
    const float intensity = values.size() > 3 ? values[3] : 0.0F;
    const float scaled = intensity <= 1.0F ? 255.0F * intensity : intensity;
    cloud.Add({values[0], values[1], values[2] - scan.floor_z_m},
              static_cast<std::uint8_t>(std::clamp(scaled, 0.0F, 255.0F)));
  }
  return cloud;
}

}  // namespace clearway::test
