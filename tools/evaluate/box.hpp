// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace clearway::evaluate {

/// An object that a person (or a simulator) marked. The frame F is stated by whoever holds it.
struct Box {
  Eigen::Isometry3d T_F_box = Eigen::Isometry3d::Identity();  ///< Origin: the middle of the box.
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  ///< Along the box's own x (yaw), y and z.
  std::string kind;                                  ///< As the labels call it: "Car".
  std::int64_t points = 0;                           ///< Returns inside, as the labels count them.
};

/// The same box in frame G.
[[nodiscard]] Box Moved(const Eigen::Isometry3d& T_G_F, Box box);

/// Whether the point lies in the box after each face was moved outwards by `margin_m`. Faces belong
/// to the box.
[[nodiscard]] bool Contains(const Box& box, const Eigen::Vector3d& point, double margin_m);

/// The box seen from above: a convex polygon, counter-clockwise, not closed [m].
[[nodiscard]] std::vector<Eigen::Vector2f> Footprint(const Box& box);

/// From the frame's origin to the nearest point of the footprint, horizontally [m]; 0 when the
/// origin lies in it.
[[nodiscard]] double NearestDistance(const Box& box);

/// Direction of the box's own x axis, seen from above [rad].
[[nodiscard]] double Yaw(const Box& box);

/// The angle between two directions of a rectangle's sides, which come back after a quarter turn:
/// 0 .. pi/4 [rad].
[[nodiscard]] double QuarterTurnDifference(double a_rad, double b_rad);

}  // namespace clearway::evaluate
