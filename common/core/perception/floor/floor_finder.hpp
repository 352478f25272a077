// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/cloud.hpp"
#include "common/core/geometry/plane.hpp"
#include "common/core/perception/backend.hpp"

namespace clearway::core {

/// Settings of the floor. XML element: <preprocessor><floor>.
struct FloorConfig {
  double distance_threshold_m = 0.05;
  double below_margin_m = 0.1;
  double max_tilt_rad = 0.2617993877991494;  // 15 deg
  int max_hypotheses = 200;
  double max_height_offset_m = 0.25;
  int min_inliers = 50;
  std::int64_t hold_us = 1'000'000;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("distance_threshold_m",
                   self.distance_threshold_m,
                   0.005,
                   0.5,
                   "A point within this distance of the plane is floor [m]. Smaller keeps lower "
                   "obstacles and leaves more of an uneven floor.");
    visitor.Number(
        "below_margin_m",
        self.below_margin_m,
        0.005,
        2.0,
        "A point deeper below the plane than this is kept and marked: a hole or a step "
        "down [m]. Not less than distance_threshold_m. Smaller finds shallower steps and "
        "lets a sensor's noise through.");
    visitor.Degrees(
        "max_tilt_deg",
        self.max_tilt_rad,
        0.0,
        45.0,
        "Largest angle between the floor's normal and the vehicle's z axis [deg]. 0 admits "
        "level planes only. Larger follows ramps and looks at more points.");
    visitor.Integer("max_hypotheses",
                    self.max_hypotheses,
                    1,
                    100000,
                    "Most planes that RANSAC tries in a scan.");
    visitor.Number("max_height_offset_m",
                   self.max_height_offset_m,
                   0.0,
                   10.0,
                   "A plane that passes the vehicle's origin higher or lower than this is not the "
                   "floor [m]: a table top, a platform.");
    visitor.Integer("min_inliers",
                    self.min_inliers,
                    3,
                    1000000,
                    "A plane with fewer points is not accepted as the floor.");
    visitor.Milliseconds("hold_ms",
                         self.hold_us,
                         0.0,
                         60000.0,
                         "How long the last good plane stands in when no floor is found [ms]; then "
                         "the plane z = 0 of the vehicle frame does, and the status says so.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    if (below_margin_m >= distance_threshold_m) return {};
    return {"below_margin_m must not be less than distance_threshold_m."};
  }
};

/// One plane found in one scan.
struct FloorFit {
  Plane plane_vehicle;             ///< Normal upwards (z > 0).
  std::size_t num_inliers = 0;     ///< Candidate points within distance_threshold_m of the plane.
  std::size_t num_candidates = 0;  ///< Points that were looked at.
  double rms_m = 0.0;              ///< Root mean square distance of the inliers [m].
  double tilt_rad = 0.0;           ///< Angle between normal and +z.
};

/// Finds the floor in a single scan: the plane with most points near it among those that meet the
/// prior, which is that the vehicle stands on the floor (z = 0 of the vehicle frame), give or take
/// max_height_offset_m and max_tilt_rad. A table top or a wall is not an answer.
/// Thread safety: none; an instance may keep buffers between calls.
class FloorFinder {
 public:
  virtual ~FloorFinder() = default;

  /// The floor among the points of a scan in the vehicle frame, or nothing where no plane meets
  /// max_tilt_rad, max_height_offset_m and min_inliers. Points that are not finite or beyond
  /// kMaxCoordinate_m are ignored.
  /// Same input, same output.
  [[nodiscard]] virtual std::optional<FloorFit> Find(const PointCloud& cloud_vehicle) = 0;
};

[[nodiscard]] std::unique_ptr<FloorFinder> MakeFloorFinder(Backend backend,
                                                           const FloorConfig& config);

}  // namespace clearway::core
