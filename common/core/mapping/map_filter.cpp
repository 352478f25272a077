// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/mapping/map_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace clearway::core {
namespace {

// A tolerance that is a whole number of cells must reach that many cells, although neither it nor
// the resolution is exact in binary. Relative, of squares.
constexpr double kRounding = 1e-9;

// From the vehicle's frame to cells of a grid.
class ToCells {
 public:
  ToCells(const GridGeometry& geometry, const Eigen::Isometry3d& T_map_vehicle)
      : width_(geometry.width), height_(geometry.height) {
    const double cosine = std::cos(geometry.origin_yaw_rad) / geometry.resolution_m;
    const double sine = std::sin(geometry.origin_yaw_rad) / geometry.resolution_m;
    Eigen::Matrix2d cells_map;
    cells_map << cosine, sine, -sine, cosine;
    turn_ = cells_map * T_map_vehicle.linear().topRows<2>();
    shift_ = cells_map * (T_map_vehicle.translation().head<2>() -
                          Eigen::Vector2d(geometry.origin_x_m, geometry.origin_y_m));
  }

  [[nodiscard]] std::optional<CellIndex> CellAt(double x_m, double y_m, double z_m) const {
    const double u = turn_(0, 0) * x_m + turn_(0, 1) * y_m + turn_(0, 2) * z_m + shift_.x();
    const double v = turn_(1, 0) * x_m + turn_(1, 1) * y_m + turn_(1, 2) * z_m + shift_.y();
    // A comparison with NaN is false.
    if (!(u >= 0.0 && u < width_ && v >= 0.0 && v < height_)) return std::nullopt;
    return CellIndex{static_cast<int>(u), static_cast<int>(v)};
  }

 private:
  double width_;
  double height_;
  Eigen::Matrix<double, 2, 3> turn_;
  Eigen::Vector2d shift_;
};

// The greatest squared distance in cells that is within the tolerance. Less than kFar, which says
// nothing of how far.
int MaxSquaredCells(double tolerance_m, double resolution_m) {
  const double cells = tolerance_m / resolution_m;
  return static_cast<int>(std::min(std::floor(cells * cells * (1.0 + kRounding)),
                                   static_cast<double>(DistanceField::kFar - 1)));
}

double SquaredDistance(const Eigen::Vector2d& point,
                       const Eigen::Vector2d& from,
                       const Eigen::Vector2d& to) {
  const Eigen::Vector2d along = to - from;
  const double squared_length = along.squaredNorm();
  const double share =
      squared_length > 0.0 ? std::clamp((point - from).dot(along) / squared_length, 0.0, 1.0) : 0.0;
  return (point - from - share * along).squaredNorm();
}

}  // namespace

MapFilter::MapFilter(const MapFilterConfig& config, std::vector<Eigen::Vector2d> footprint_vehicle)
    : config_(config), footprint_vehicle_(std::move(footprint_vehicle)) {
  for (const Eigen::Vector2d& corner : footprint_vehicle_) near_box_.extend(corner);
  if (near_box_.isEmpty()) return;
  near_box_.min().array() -= config_.near_zone_m;
  near_box_.max().array() += config_.near_zone_m;
}

std::vector<MapVerdict> MapFilter::Judge(const PointCloud& cloud_vehicle,
                                         const Eigen::Isometry3d& T_map_vehicle,
                                         const StaticMap& map) const {
  const ToCells to_cells(map.grid.geometry, T_map_vehicle);
  const int max_squared_cells =
      MaxSquaredCells(config_.tolerance_m, map.grid.geometry.resolution_m);
  const auto judge = [&](double x_m, double y_m, double z_m) {
    if (!std::isfinite(x_m) || !std::isfinite(y_m) || !std::isfinite(z_m)) {
      return MapVerdict::kInvalid;
    }
    if (z_m < config_.z_min_m || z_m > config_.z_max_m) return MapVerdict::kOutOfBand;
    if (IsNear({x_m, y_m})) return MapVerdict::kNear;
    const std::optional<CellIndex> cell = to_cells.CellAt(x_m, y_m, z_m);
    if (!cell) return MapVerdict::kOffMap;
    if (map.grid.At(*cell) == OccupancyGrid::kUnknown) return MapVerdict::kUnknown;
    return map.distance.SquaredCells(*cell) <= max_squared_cells ? MapVerdict::kExplained
                                                                 : MapVerdict::kUnexplained;
  };
  std::vector<MapVerdict> verdicts(cloud_vehicle.size());
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    verdicts[i] = judge(cloud_vehicle.x[i], cloud_vehicle.y[i], cloud_vehicle.z[i]);
  }
  return verdicts;
}

bool MapFilter::IsNear(const Eigen::Vector2d& point_vehicle) const {
  if (!near_box_.contains(point_vehicle)) return false;
  bool is_inside = footprint_vehicle_.size() >= 3;
  double least_squared = std::numeric_limits<double>::infinity();
  Eigen::Vector2d from = footprint_vehicle_.back();
  for (const Eigen::Vector2d& to : footprint_vehicle_) {
    const Eigen::Vector2d along = to - from;
    const Eigen::Vector2d offset = point_vehicle - from;
    if (along.x() * offset.y() - along.y() * offset.x() < 0.0) is_inside = false;
    least_squared = std::min(least_squared, SquaredDistance(point_vehicle, from, to));
    from = to;
  }
  return is_inside || least_squared <= config_.near_zone_m * config_.near_zone_m;
}

}  // namespace clearway::core
