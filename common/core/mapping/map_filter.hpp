// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "common/core/cloud.hpp"
#include "common/core/mapping/distance_field.hpp"
#include "common/core/mapping/map_tiles.hpp"
#include "common/core/mapping/occupancy_grid.hpp"

namespace clearway::core {

/// A static map with what the filter looks up in it; made once for each version.
struct StaticMap {
  StaticMap(const MapVersion& map_version, OccupancyGrid map_grid)
      : version(map_version), grid(std::move(map_grid)), distance(grid) {}

  MapVersion version;
  OccupancyGrid grid;
  DistanceField distance;
};

/// Settings of MapFilter. XML element: <map_filter>.
struct MapFilterConfig {
  bool enabled = false;
  double tolerance_m = 0.10;
  double z_min_m = 0.05;
  double z_max_m = 2.0;
  double near_zone_m = 0.5;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Flag("enabled",
                 self.enabled,
                 "Takes out the points that the static map explains. Needs a map server and POSE.");
    visitor.Number("tolerance_m",
                   self.tolerance_m,
                   0.0,
                   1.0,
                   "A point this near to an occupied cell, from middle of cell to middle of cell, "
                   "is explained by it [m]. Wider forgives a worse pose and hides what stands "
                   "close to a wall.");
    visitor.Number("z_min_m",
                   self.z_min_m,
                   -1.0,
                   10.0,
                   "Lower points are always kept [m above the floor]: the map does not know what "
                   "lies on the floor along a wall.");
    visitor.Number("z_max_m",
                   self.z_max_m,
                   -1.0,
                   10.0,
                   "Higher points are always kept [m above the floor]: the map does not tell how "
                   "high a thing is.");
    visitor.Number("near_zone_m",
                   self.near_zone_m,
                   0.0,
                   20.0,
                   "Nothing this near to the footprint is ever taken out [m], so that a wrong pose "
                   "cannot hide what the robot is about to touch.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    if (z_min_m < z_max_m) return {};
    return {"z_min_m must be less than z_max_m"};
  }
};

/// What the filter says about a point.
enum class MapVerdict : std::uint8_t {
  kExplained,    ///< An occupied cell is within the tolerance: to be taken out.
  kUnexplained,  ///< In a known cell, and none is.
  kUnknown,      ///< In an unknown cell: kept, whatever is near.
  kOffMap,       ///< Kept.
  kOutOfBand,    ///< Below z_min_m or above z_max_m: kept.
  kNear,         ///< In the near zone: kept.
  kInvalid,      ///< Not finite: kept.
};
inline constexpr std::size_t kNumMapVerdicts = 7;

/// Tells which points of a scan a static occupancy map explains: those with an occupied cell within
/// the tolerance, inside a height band and outside the near zone of the robot.
/// Source: the published method's map filtration; tolerance and the treatment of unknown space
/// differ on purpose: see the preprocessor's README.
/// Stateless after construction.
class MapFilter {
 public:
  /// `footprint_vehicle`: convex, counter-clockwise [m]; without corners there is no near zone.
  /// @pre config has been validated.
  MapFilter(const MapFilterConfig& config, std::vector<Eigen::Vector2d> footprint_vehicle);

  /// One verdict a point, the first reason that holds: invalid, out of the band, near, off the map,
  /// unknown. The near zone is measured in the vehicle's plane, heights along its z axis; the cell
  /// is looked up with the whole pose, tilt included. A tolerance of 255 cells or more counts as
  /// just less. With a pose that is not finite all points are off the map.
  /// O(n), a constant for each point.
  [[nodiscard]] std::vector<MapVerdict> Judge(const PointCloud& cloud_vehicle,
                                              const Eigen::Isometry3d& T_map_vehicle,
                                              const StaticMap& map) const;

 private:
  [[nodiscard]] bool IsNear(const Eigen::Vector2d& point_vehicle) const;

  MapFilterConfig config_;
  std::vector<Eigen::Vector2d> footprint_vehicle_;
  Eigen::AlignedBox2d near_box_;  // Holds the near zone; empty without a footprint.
};

}  // namespace clearway::core
