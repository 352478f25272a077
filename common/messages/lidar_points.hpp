// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include <clearway/lidar_points_t.hpp>

#include "common/core/scan/scan_assembler.hpp"

namespace clearway::messages {

/// Bytes of LIDAR_POINTS for each point, and those of everything else with a name of usual length.
inline constexpr std::size_t kLidarBytesPerPoint = 3 * sizeof(float) + 2 + sizeof(std::int32_t);
inline constexpr std::size_t kLidarHeaderBytes = 256;

/// `sensor` is the index of message.sensor in the configuration, -1 when it is not there. Values
/// are taken as they are: core::IsValid() judges them.
[[nodiscard]] core::Slice FromLcm(const lidar_points_t& message, int sensor);

/// Session and sequence are left to the node that publishes it. The slice's own time window is its
/// share of the scan's.
[[nodiscard]] lidar_points_t ToLcm(const core::Slice& slice, const std::string& sensor);

}  // namespace clearway::messages
