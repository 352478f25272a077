// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/core/guard/base_gate.hpp"
#include "common/core/simulation/drive_train.hpp"
#include "common/core/simulation/floor_plan.hpp"
#include "common/core/simulation/path_follower.hpp"
#include "common/core/simulation/robot_config.hpp"
#include "common/core/simulation/robot_state.hpp"
#include "common/core/vehicle.hpp"

namespace clearway::core {

/// The robot touched something.
struct Contact {
  std::int64_t time_us = 0;         ///< Since the world's start.
  std::int32_t object = kNoObject;  ///< Or kMapObject.
  double speed_mps = 0.0;           ///< Of the robot at the touch; 0 when the object came.
};

/// A robot in a scene: it drives as configured, within what the permit and its drives allow, and
/// stands where it would touch something. Times count from the world's start [us]. It moves in
/// steps of 1 ms on the world's clock, whenever somebody asks: same config and same messages at the
/// same times, same motion, whoever asks how often. Thread safety: none.
class Robot {
 public:
  Robot(const RobotConfig& robot,
        const VehicleConfig& vehicle,
        const SceneConfig& scene,
        const std::optional<MapWalls>& walls = std::nullopt);

  /// Drives on until `time_us`; times gone by are ignored.
  void AdvanceTo(std::int64_t time_us);

  /// The robot at `time_us`, driven on to if need be. Remembers the last 2 s; earlier times give
  /// the oldest state that it has.
  [[nodiscard]] RobotState StateAt(std::int64_t time_us);

  /// A DRIVE_PERMIT arrived at `time_us`; true when it replaces the one held.
  bool OnPermit(const BasePermit& permit, std::int64_t time_us);
  /// A DRIVE_REQUEST or DRIVE_COMMAND arrived, whichever it obeys.
  void OnOrder(const BaseCommand& order, std::int64_t time_us);

  [[nodiscard]] const BaseGate& gate() const { return gate_; }
  /// What it would drive if it were permitted, when it was last asked.
  [[nodiscard]] const BaseMotion& wish() const { return wish_; }
  /// What it was permitted of it.
  [[nodiscard]] const BaseMotion& set_point() const { return set_point_; }
  /// It stands on the last waypoint of its path.
  [[nodiscard]] bool has_arrived() const { return follower_ && follower_->has_arrived(); }

  /// All contacts so far; one that lasts counts once, until the robot was kContactEnd_m away.
  [[nodiscard]] const std::vector<Contact>& contacts() const { return contacts_; }
  /// What it touches now.
  [[nodiscard]] std::optional<std::int32_t> touched() const { return touched_; }
  /// The least distance between footprint and anything so far, looked at every 10 ms; infinity
  /// while nothing was within 5 m.
  [[nodiscard]] const FloorPlan::Neighbour& nearest() const { return nearest_; }
  [[nodiscard]] std::string NameOf(std::int32_t object) const { return floor_plan_.NameOf(object); }

  static constexpr double kContactEnd_m = 0.05;

 private:
  static constexpr std::int64_t kLook_us = 10'000;
  static constexpr std::size_t kHistory = 2048;

  [[nodiscard]] BaseMotion Wish(std::int64_t time_us);
  void Step();
  void LookAround();
  void NoteContact(std::int32_t object, double speed_mps);

  RobotConfig config_;
  FloorPlan floor_plan_;
  DriveTrain drive_train_;
  std::optional<PathFollower> follower_;
  BaseGate gate_;
  BaseMotion wish_;
  BaseMotion set_point_;
  std::int64_t steps_ = 0;  // Done; the newest state is of this many milliseconds.
  std::vector<RobotState> history_;
  std::vector<Contact> contacts_;
  std::optional<std::int32_t> touched_;
  FloorPlan::Neighbour nearest_;
};

}  // namespace clearway::core
