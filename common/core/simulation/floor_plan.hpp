// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/core/mapping/distance_field.hpp"
#include "common/core/simulation/flat_shape.hpp"
#include "common/core/simulation/robot_state.hpp"
#include "common/core/simulation/world.hpp"

namespace clearway::core {

/// The body that may touch something: a footprint in the vehicle frame, from clearance_m above the
/// floor up to height_m. What is not higher than clearance_m is driven over; what hangs above
/// height_m is passed under; a hole is touched by the footprint where it is deeper than
/// clearance_m. Ramps are walls: the robot has one level only.
struct RobotBody {
  std::vector<Eigen::Vector2d> footprint;  ///< Convex, counter-clockwise.
  double clearance_m = 0.03;
  double height_m = 0.6;
};

/// What stands around a robot, as seen from above. Thread safety: none.
class FloorPlan {
 public:
  /// Something near, or touched.
  struct Neighbour {
    double distance_m = std::numeric_limits<double>::infinity();  ///< 0: touched.
    std::int32_t object = kNoObject;                              ///< Or kMapObject.
  };

  FloorPlan(const SceneConfig& scene, const std::optional<MapWalls>& walls, const RobotBody& body);

  /// Takes the scene to a moment after its start. O(objects), and nothing in a scene where nothing
  /// ever moves, appears or vanishes.
  void MoveTo(std::int64_t time_us);

  /// The first object that a robot at `pose` touches; nothing when it touches none.
  [[nodiscard]] std::optional<std::int32_t> Touched(const PlanarPose& pose) const;

  /// What is nearest to a robot at `pose`, if nearer than `within_m`; ties go to the first.
  [[nodiscard]] Neighbour Nearest(const PlanarPose& pose, double within_m) const;

  /// The object's name in the scene.
  [[nodiscard]] std::string NameOf(std::int32_t object) const;

 private:
  [[nodiscard]] FlatShape FootprintAt(const PlanarPose& pose) const;
  void ImproveByWalls(const FlatShape& footprint, Neighbour& best) const;

  SceneConfig scene_;
  std::optional<MapWalls> walls_;
  std::optional<DistanceField> field_;
  RobotBody body_;
  std::vector<std::string> names_;
  bool does_change_;
  std::optional<std::int64_t> time_us_;
  std::vector<FlatShape> shapes_;
};

}  // namespace clearway::core
