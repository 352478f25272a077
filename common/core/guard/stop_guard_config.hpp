// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace clearway::core {

/// Settings of StopGuard. XML element: <stop_guard>. The vehicle's limits, braking and reaction
/// times stand in <vehicle>.
struct StopGuardConfig {
  double front_margin_m = 0.1;
  double side_margin_m = 0.05;
  double min_height_m = 0.06;
  double max_height_m = 0.6;
  double hole_depth_m = 0.15;
  int min_points = 2;
  std::int64_t hold_us = 500'000;
  std::int64_t slice_timeout_us = 100'000;
  std::int64_t max_lateness_us = 100'000;
  std::int64_t returns_window_us = 500'000;
  int min_returns = 50;
  double unseen_speed_mps = 0.1;
  std::int64_t detections_timeout_us = 500'000;
  double degraded_speed_mps = 0.3;
  std::int64_t odometry_timeout_us = 100'000;
  std::int64_t odometry_stop_us = 500'000;
  double permit_rate_hz = 50.0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    VisitCorridor(self, visitor);
    VisitWatches(self, visitor);
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    std::vector<std::string> broken;
    if (!(min_height_m < max_height_m)) {
      broken.emplace_back("min_height_m must be less than max_height_m");
    }
    if (odometry_stop_us < odometry_timeout_us) {
      broken.emplace_back("odometry_stop_ms must not be less than odometry_timeout_ms");
    }
    return broken;
  }

 private:
  template <typename Self, typename Visitor>
  static void VisitCorridor(Self& self, Visitor& visitor) {
    visitor.Number("front_margin_m",
                   self.front_margin_m,
                   0.0,
                   5.0,
                   "What is left between robot and obstacle when standing [m].");
    visitor.Number("side_margin_m",
                   self.side_margin_m,
                   0.0,
                   2.0,
                   "Added to the footprint on both sides, and all around when turning [m]. Too "
                   "much closes narrow doors.");
    visitor.Number("min_height_m",
                   self.min_height_m,
                   0.0,
                   1.0,
                   "Returns lower than this above the floor are the floor [m]. Lower sees flatter "
                   "obstacles and stops for a floor that is not flat.");
    visitor.Number("max_height_m",
                   self.max_height_m,
                   0.05,
                   20.0,
                   "Returns higher than this pass above the robot [m]: its height and a margin.");
    visitor.Number("hole_depth_m",
                   self.hole_depth_m,
                   0.0,
                   5.0,
                   "A return deeper than this below the floor shows a hole where its beam passed "
                   "the floor [m]; 0 switches that off, for floors that reflect like a mirror.");
    visitor.Integer("min_points",
                    self.min_points,
                    1,
                    4,
                    "Hits that must agree within a cell of 0.1 m and its neighbours. More ignores "
                    "noise and answers later.");
    visitor.Milliseconds("hold_ms",
                         self.hold_us,
                         50.0,
                         10000.0,
                         "How long a hit counts [ms]. Longer than the sensor's pattern takes to "
                         "come back to the same place.");
    visitor.Number("unseen_speed_mps",
                   self.unseen_speed_mps,
                   0.0,
                   2.0,
                   "Speed into space that no sensor sees [m/s]; 0 forbids it.");
  }

  template <typename Self, typename Visitor>
  static void VisitWatches(Self& self, Visitor& visitor) {
    visitor.Milliseconds("slice_timeout_ms",
                         self.slice_timeout_us,
                         5.0,
                         1000.0,
                         "A required sensor that is silent for longer means stop [ms].");
    visitor.Milliseconds("max_lateness_ms",
                         self.max_lateness_us,
                         5.0,
                         1000.0,
                         "Slices later than the quickest ones by more than this mean stop [ms].");
    visitor.Milliseconds("returns_window_ms",
                         self.returns_window_us,
                         50.0,
                         10000.0,
                         "Within this time a required sensor must have min_returns returns [ms].");
    visitor.Integer("min_returns",
                    self.min_returns,
                    1,
                    1000000,
                    "Fewer returns within returns_window_ms are taken as a covered lens: stop.");
    visitor.Milliseconds(
        "detections_timeout_ms",
        self.detections_timeout_us,
        50.0,
        10000.0,
        "DETECTIONS that are silent, or late, by more than this count as missing [ms].");
    visitor.Number("degraded_speed_mps",
                   self.degraded_speed_mps,
                   0.0,
                   20.0,
                   "Top speed while DETECTIONS are missing [m/s].");
    visitor.Milliseconds("odometry_timeout_ms",
                         self.odometry_timeout_us,
                         20.0,
                         10000.0,
                         "ODOMETRY silent for longer: top speed is assumed, hits stay [ms].");
    visitor.Milliseconds("odometry_stop_ms",
                         self.odometry_stop_us,
                         20.0,
                         10000.0,
                         "ODOMETRY silent for longer means stop, unless the vehicle is "
                         "stationary [ms].");
    visitor.Number("permit_rate_hz",
                   self.permit_rate_hz,
                   20.0,
                   200.0,
                   "Permits a second; the base stops without one for 0.1 s [1/s].");
  }
};

}  // namespace clearway::core
