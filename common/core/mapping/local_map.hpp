// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/core/cloud.hpp"
#include "common/core/mapping/occupancy_grid.hpp"

namespace clearway::core {

/// Settings of LocalMapBuilder. XML element: <local_map>.
struct LocalMapConfig {
  bool enabled = true;
  double resolution_m = 0.05;
  double radius_m = 12.0;
  double z_min_m = 0.05;
  double z_max_m = 2.0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Flag("enabled",
                 self.enabled,
                 "Publishes LOCAL_MAP for each scan that has a pose. Costs a ray to each cell that "
                 "was hit.");
    visitor.Number("resolution_m",
                   self.resolution_m,
                   0.01,
                   1.0,
                   "Side of a cell [m]; that of the map that is to be built from it.");
    visitor.Number("radius_m",
                   self.radius_m,
                   0.5,
                   60.0,
                   "What is farther from the vehicle, along either axis of map, is left out [m].");
    visitor.Number("z_min_m",
                   self.z_min_m,
                   -1.0,
                   10.0,
                   "Lower points do not make a cell occupied [m above the floor].");
    visitor.Number("z_max_m",
                   self.z_max_m,
                   -1.0,
                   10.0,
                   "Higher points neither occupy a cell nor clear those before it [m above the "
                   "floor].");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    std::vector<std::string> broken;
    if (!(z_min_m < z_max_m)) broken.emplace_back("z_min_m must be less than z_max_m");
    if (radius_m / resolution_m > 2000.0) {
      broken.emplace_back("radius_m must be at most 2000 cells of resolution_m");
    }
    return broken;
  }
};

/// What one scan saw of its surroundings: cells free, occupied, or not seen (unknown).
struct LocalMap {
  /// Axis-parallel in `map`; the origin is a whole number of cells from map's, so that the local
  /// maps of a drive lie on one grid. The vehicle's cell and on each of its sides the radius, made
  /// up to whole cells. 0 x 0 when nothing was seen.
  OccupancyGrid grid;
  std::vector<Eigen::Vector2d> sensor_origins_map;  ///< Of each sensor [m].
};

/// Draws the local map of a scan. A cell is occupied when an obstacle point of the height band is
/// in it; free when a ray from the sensor to a point of the scan crosses it at a height within or
/// below the band, or the floor was seen in it, and nothing occupies it. Rays run in the plane
/// (Amanatides and Woo 1987), one from a sensor to the middle of each cell that was hit.
/// Points above the band tell nothing, since their rays may have passed over what stands in the
/// band; nor do obstacle points more than 5 cm below the floor, where there may be a hole. A ray to
/// a point beyond the radius frees the cells up to the grid's border.
/// Stateless after construction; same input, same result; the order of points does not matter.
class LocalMapBuilder {
 public:
  /// @pre config has been validated.
  explicit LocalMapBuilder(const LocalMapConfig& config) : config_(config) {}

  struct Scan {
    const PointCloud& obstacles_vehicle;  ///< Off the floor (below-floor points do not count).
    const PointCloud& floor_vehicle;      ///< On the floor.
    std::span<const Eigen::Vector3d> sensor_origins_vehicle;  ///< At least one.
    const Eigen::Isometry3d& T_map_vehicle;
  };

  /// Rays start at the sensor that is nearest in the plane to the point, since voxels do not tell
  /// who saw them. Points that are not finite are left out; a sensor that is not, or lies more than
  /// 10^9 cells away, has no rays; with such a pose nothing is seen.
  /// O(sensors * (points + cells) + cells crossed).
  [[nodiscard]] LocalMap Build(const Scan& scan) const;

 private:
  LocalMapConfig config_;
};

}  // namespace clearway::core
