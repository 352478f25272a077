// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace clearway::core {

/// Time between two shots of a MID-70: 100 000 shots/s [us].
inline constexpr std::int64_t kMid70ShotPeriod_us = 10;

/// No shot leaves further from the sensor's x axis [rad]: 35.216 deg, the largest angle in the
/// vendor's ray table. Mid70Direction() reaches 35.193 deg.
inline constexpr double kMid70MaxOffAxis_rad = 0.61464;

/// Unit vector of shot `shot` in the sensor frame (x forward, y left, z up). Shot k leaves
/// (k + 1) * 10 us after the pattern's start; the pattern repeats after 30 s. Any shot may be
/// asked for, in any order. O(1).
/// Two prisms that turn at -4664 and +7294 rpm bend the beam: the sum of six turning pointers,
/// fitted to 4 s of the vendor's own ray table (RMS error 0.016 deg, largest 0.023 deg). Whether a
/// real head turns the same way or is its mirror image is not known.
/// @pre shot >= 0.
[[nodiscard]] Eigen::Vector3d Mid70Direction(std::int64_t shot);

}  // namespace clearway::core
