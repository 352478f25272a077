// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <clearway/detections_t.hpp>
#include <clearway/obstacle_points_t.hpp>

#include "common/core/perception/detection/detection.hpp"

namespace clearway::messages {

/// `below_floor` tells how many of the detection's points lie below the floor.
[[nodiscard]] detection_t ToLcm(const core::Detection& detection,
                                std::int32_t id,
                                std::int32_t below_floor);

/// What a detection_t says about its obstacle's place and shape. A negative number of points is
/// read as 0.
[[nodiscard]] core::Detection FromLcm(const detection_t& message);

/// The slices of DETECTIONS for one scan, at least one. Stamps and states are those of `source`,
/// the header of the scan's points. A slice holds as many detections as fit in max_message_bytes,
/// but at least one. Session, sequence, points_in and processing_us are left to the caller.
[[nodiscard]] std::vector<detections_t> ToDetections(const obstacle_points_t& source,
                                                     std::span<const detection_t> detections,
                                                     std::size_t max_message_bytes);

}  // namespace clearway::messages
