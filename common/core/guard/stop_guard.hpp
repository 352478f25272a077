// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "common/core/guard/free_speed.hpp"
#include "common/core/guard/hit_memory.hpp"
#include "common/core/guard/sensor_watch.hpp"
#include "common/core/guard/stop_guard_config.hpp"
#include "common/core/guard/swept_footprint.hpp"
#include "common/core/scan/scan_assembler.hpp"
#include "common/core/vehicle.hpp"

namespace clearway::core {

/// Why a speed is permitted or not. The values are those of the wire. From kStarting on the guard
/// is closed: no motion at all.
enum class PermitReason : std::int8_t {
  kFree = 0,            ///< The vehicle's own top speed.
  kObstacle = 1,        ///< Something stands in the way.
  kUnseen = 2,          ///< No sensor looks there.
  kNoDetections = 3,    ///< DETECTIONS are missing.
  kStarting = 10,       ///< A required sensor has not been heard yet.
  kSensorSilent = 11,   ///< A required sensor has fallen silent.
  kSlicesLate = 12,     ///< The slices of a required sensor come late.
  kTwoPublishers = 13,  ///< Two publishers send slices of a required sensor.
  kNoReturns = 14,      ///< A required sensor sends slices without returns: covered lens.
  kNoOdometry = 15,     ///< The vehicle moves and ODOMETRY is missing.
};

/// The permit for one Direction.
struct DirectionPermit {
  double limit = 0.0;  ///< Highest speed [m/s], turn rate [rad/s]; 0: do not.
  PermitReason reason = PermitReason::kStarting;
  double free_way = std::numeric_limits<double>::infinity();  ///< To the nearest hit [m or rad].
  bool has_cause = false;  ///< There is a hit within reach, whether or not it limits.
  Eigen::Vector3f cause_vehicle = Eigen::Vector3f::Zero();  ///< That hit.
};

/// What the vehicle may do now.
struct Permit {
  std::array<DirectionPermit, kNumDirections> directions;
  /// The reason for all directions while closed; else that of the most important direction that is
  /// limited by an obstacle (in the order of Direction), else that of forward.
  PermitReason reason = PermitReason::kStarting;
  Direction cause_direction = Direction::kForward;  ///< The direction that `reason` is about.
  int sensor = -1;  ///< The sensor that closes the guard; -1 when none does.
  bool detections_missing = true;
  bool odometry_missing = true;  ///< Hits do not expire; top speed is assumed.

  [[nodiscard]] bool is_closed() const { return reason >= PermitReason::kStarting; }
  [[nodiscard]] const DirectionPermit& operator[](Direction d) const {
    return directions[static_cast<std::size_t>(d)];
  }
  [[nodiscard]] double forward_mps() const { return (*this)[Direction::kForward].limit; }
  [[nodiscard]] double backward_mps() const { return (*this)[Direction::kBackward].limit; }
  [[nodiscard]] double turn_left_radps() const { return (*this)[Direction::kTurnLeft].limit; }
  [[nodiscard]] double turn_right_radps() const { return (*this)[Direction::kTurnRight].limit; }
};

/// What the guard took in and left out since the start.
struct StopGuardCounts {
  std::int64_t slices = 0;
  std::int64_t unknown_sensor = 0;    ///< Slices of no configured sensor; ignored.
  std::int64_t invalid_slices = 0;    ///< IsValid(Slice) is false; ignored.
  std::int64_t returns = 0;           ///< Points that could be believed.
  std::int64_t obstacle_points = 0;   ///< Of those: within the height band.
  std::int64_t hole_points = 0;       ///< Of those: below hole_depth_m.
  std::int64_t invalid_odometry = 0;  ///< NaN, or far above the top speed; ignored.
};

/// The map-free path of the stop guard: raw slices in, permit out. Normally closed: no motion is
/// permitted until every required sensor has been heard, is fresh and has returns, and, unless the
/// vehicle is stationary, ODOMETRY is there; silence never means free.
///
/// Each return that is not on the robot itself and lies between min_height_m and max_height_m above
/// the floor (z = 0 of the calibrated extrinsic) may hinder; one deeper than hole_depth_m below the
/// floor hinders where its beam passed the floor's plane. Which motions it hinders: SweptFootprint;
/// when it counts and for how long: HitMemory; how fast is still safe: FreeSpeed().
///
/// Limits: motion is straight or a turn on the spot; for an arc both permits hold at the same time,
/// which does not cover what stands beside the corridor on the inside of a fast arc. Unseen space
/// is judged by horizontal bearing only. Obstacles are taken to stand still.
///
/// All times are of one monotonic clock. A slice costs O(points); nothing allocates after
/// construction. Thread safety: none.
class StopGuard {
 public:
  /// @pre both configurations have been validated.
  StopGuard(const StopGuardConfig& config, const VehicleConfig& vehicle);

  /// Takes a slice in the `sensor` frame; slice.sensor is the index into VehicleConfig::sensors.
  void OnSlice(const Slice& slice, std::int64_t now_us);
  /// DETECTIONS arrived, empty or not; `stamp_us` is that of their scan.
  void OnDetections(std::int64_t stamp_us, std::int64_t now_us);
  /// Measured speed (forward positive) and turn rate (left positive).
  void OnOdometry(double forward_mps, double turn_radps, std::int64_t now_us);

  /// What is permitted at this moment. To be called at permit_rate_hz from a timer, and after a
  /// slice for the quickest answer.
  [[nodiscard]] Permit PermitAt(std::int64_t now_us);

  [[nodiscard]] const StopGuardCounts& counts() const { return counts_; }
  /// @pre 0 <= sensor < number of sensors.
  [[nodiscard]] const SensorWatch& sensor_watch(int sensor) const {
    return sensors_[static_cast<std::size_t>(sensor)].watch;
  }

 private:
  struct Sensor {
    SensorWatch watch;
    bool required;
    Sectors sectors;
    Eigen::Matrix3f R_vehicle_sensor;
    Eigen::Vector3f t_vehicle_sensor;
    float min_range2_m2;
    float max_range2_m2;
  };

  void AdvanceTo(std::int64_t now_us);
  [[nodiscard]] bool TakePoint(const Sensor& sensor, const Eigen::Vector3f& point_sensor);
  [[nodiscard]] bool IsOdometryMissing(std::int64_t now_us) const;
  [[nodiscard]] bool AreDetectionsMissing(std::int64_t now_us) const;
  [[nodiscard]] bool Close(std::int64_t now_us, Permit& permit) const;
  [[nodiscard]] Sectors SeenSectors(std::int64_t now_us) const;
  void Open(std::int64_t now_us, Permit& permit);
  void Limit(Direction d, const NearestHit& hit, std::int64_t now_us, DirectionPermit& out) const;

  StopGuardConfig config_;
  VehicleConfig vehicle_;
  std::vector<Sensor> sensors_;
  SweptFootprint footprint_;
  HitMemory hits_;
  std::array<double, kNumDirections> top_speed_;
  std::int64_t time_us_ = std::numeric_limits<std::int64_t>::min();  // Latest seen.
  std::int64_t hit_clock_us_ = 0;  // Stands still while odometry is missing: hits do not expire.
  bool odometry_heard_ = false;
  std::int64_t odometry_us_ = 0;
  double forward_mps_ = 0.0;
  double turn_radps_ = 0.0;
  FreshnessWatch detections_;
  StopGuardCounts counts_;
};

}  // namespace clearway::core
