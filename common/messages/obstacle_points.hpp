// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <clearway/floor_t.hpp>
#include <clearway/obstacle_points_t.hpp>
#include <clearway/removed_points_t.hpp>

#include "common/core/preprocessing/preprocessor.hpp"

namespace clearway::messages {

/// The slices of OBSTACLE_POINTS for one scan, at least one, each within max_message_bytes.
/// Session and sequence are left to the node that publishes them.
[[nodiscard]] std::vector<obstacle_points_t> ToObstaclePoints(const core::PreprocessedScan& scan,
                                                              std::int64_t processing_us,
                                                              std::size_t max_message_bytes);

/// The slices of REMOVED_POINTS for one scan, at least one.
[[nodiscard]] std::vector<removed_points_t> ToRemovedPoints(const core::PreprocessedScan& scan,
                                                            std::size_t max_message_bytes);

/// The FLOOR message of one scan.
[[nodiscard]] floor_t ToFloor(const core::PreprocessedScan& scan);

/// A slice for a ScanAssembler with one source; the points' flags travel as tags.
[[nodiscard]] core::Slice FromLcm(const obstacle_points_t& message);

}  // namespace clearway::messages
