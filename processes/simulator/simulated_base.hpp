// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "common/core/simulation/measured_motion.hpp"
#include "common/core/simulation/robot.hpp"
#include "common/process/node.hpp"
#include "processes/simulator/world_clock.hpp"

namespace clearway {

/// The robot as the graph knows it: DRIVE_PERMIT and DRIVE_REQUEST or DRIVE_COMMAND come in,
/// ODOMETRY, POSE and POSE_STATUS go out.
class SimulatedBase {
 public:
  /// All references must outlive it.
  SimulatedBase(const core::RobotConfig& config,
                const core::VehicleConfig& vehicle,
                const core::SceneConfig& scene,
                const std::optional<core::MapWalls>& walls,
                std::uint64_t seed,
                process::Node& node,
                WorldClock& clock);

  /// The robot at a moment of the world.
  [[nodiscard]] core::RobotState StateAt(std::int64_t time_us) { return robot_.StateAt(time_us); }

  /// Counters of the status.
  void SetCounters();
  /// What it does and why, for the status.
  [[nodiscard]] process::State State();

  /// Called when the robot touches something that it did not touch before.
  void OnContact(std::function<void(const core::Contact&)> handler) {
    on_contact_ = std::move(handler);
  }

 private:
  static constexpr std::int64_t kOdometryPeriod_us = 20'000;  // ODOMETRY comes at 50 Hz.

  /// Messages that leave late leave in order.
  struct Line {
    std::int64_t due_us = 0;
  };

  void OnPermit(const drive_permit_t& message);
  template <typename Message>
  void OnOrder(const Message& message);
  void PublishOdometry();
  void PublishPose();
  void SendLater(Line& line, std::int64_t delay_us, std::function<void()> send);
  void TellContacts();
  [[nodiscard]] std::string MotionText();
  [[nodiscard]] std::string PermitText(std::int64_t time_us) const;

  core::RobotConfig config_;
  process::Node& node_;
  WorldClock& clock_;
  core::Robot robot_;
  core::PoseErrors pose_errors_;
  core::OdometryErrors odometry_errors_;
  std::int64_t pose_period_us_;
  drive_permit_t permit_{};  // The last one that was accepted.
  Line odometry_line_;
  Line pose_line_;
  std::int64_t odometry_us_ = 0;  // Of the last measurement.
  std::int64_t pose_us_ = 0;
  std::int64_t odometry_lost_ = 0;
  std::int64_t poses_lost_ = 0;
  std::int64_t clock_steps_ = 0;
  std::size_t contacts_told_ = 0;
  std::function<void(const core::Contact&)> on_contact_;
};

}  // namespace clearway
