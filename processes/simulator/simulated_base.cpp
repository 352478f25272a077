// SPDX-License-Identifier: BSD-3-Clause
#include "processes/simulator/simulated_base.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "common/messages/pose.hpp"

namespace clearway {
namespace {

using core::DriveMode;
using core::GateState;
namespace channels = messages::channels;

// "0.50".
std::string Fixed(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f", value);
  return text.data();
}

odometry_t ToOdometry(std::int64_t utime, const core::MeasuredOdometry& measured) {
  odometry_t message{};
  message.utime = utime;
  message.pos[0] = measured.in_odom.x_m;
  message.pos[1] = measured.in_odom.y_m;
  message.orientation[0] = std::cos(0.5 * measured.in_odom.yaw_rad);
  message.orientation[3] = std::sin(0.5 * measured.in_odom.yaw_rad);
  message.v_mps = measured.speed.v_mps;
  message.w_radps = measured.speed.w_radps;
  message.covariance[0] = -1.0;
  return message;
}

std::int8_t StateOf(core::PoseClaim claim) {
  switch (claim) {
    case core::PoseClaim::kLost:
      return pose_status_t::STATE_LOST;
    case core::PoseClaim::kUncertain:
      return pose_status_t::STATE_UNCERTAIN;
    case core::PoseClaim::kGood:
      break;
  }
  return pose_status_t::STATE_GOOD;
}

}  // namespace

SimulatedBase::SimulatedBase(const core::RobotConfig& config,
                             const core::VehicleConfig& vehicle,
                             const core::SceneConfig& scene,
                             const std::optional<core::MapWalls>& walls,
                             std::uint64_t seed,
                             process::Node& node,
                             WorldClock& clock)
    : config_(config),
      node_(node),
      clock_(clock),
      robot_(config, vehicle, scene, walls),
      pose_errors_(config.pose_errors, seed),
      odometry_errors_(config.odometry_errors, seed),
      pose_period_us_(std::llround(1e6 / config.pose_rate_hz)) {
  node_.Subscribe<drive_permit_t>(channels::kDrivePermit, [this](const auto& m) { OnPermit(m); });
  if (config_.drive == DriveMode::kRequest) {
    node_.Subscribe<drive_request_t>(channels::kDriveRequest,
                                     [this](const auto& m) { OnOrder(m); });
  }
  if (config_.drive == DriveMode::kCommand) {
    node_.Subscribe<drive_command_t>(channels::kDriveCommand,
                                     [this](const auto& m) { OnOrder(m); });
  }
  (void)odometry_errors_.Measure(robot_.StateAt(0), 0);
  node_.runtime().Every(kOdometryPeriod_us, [this] { PublishOdometry(); });
  if (config_.publish_pose) node_.runtime().Every(pose_period_us_, [this] { PublishPose(); });
}

void SimulatedBase::OnPermit(const drive_permit_t& message) {
  const bool is_taken = robot_.OnPermit({message.session,
                                         message.sequence,
                                         message.utime,
                                         message.valid_us,
                                         message.forward_mps,
                                         message.backward_mps,
                                         message.turn_left_radps,
                                         message.turn_right_radps},
                                        clock_.Now());
  if (is_taken) permit_ = message;
}

template <typename Message>
void SimulatedBase::OnOrder(const Message& message) {
  robot_.OnOrder(
      {message.session, message.sequence, message.utime, {message.v_mps, message.w_radps}},
      clock_.Now());
}

// Measurements lie on a grid of the world's time, however late a timer fires.
void SimulatedBase::PublishOdometry() {
  if (clock_.Follow()) ++clock_steps_;
  const std::int64_t now_us = clock_.Now();
  const std::int64_t time_us = now_us - now_us % kOdometryPeriod_us;
  if (time_us <= odometry_us_) return;
  odometry_us_ = time_us;
  const core::MeasuredOdometry measured =
      odometry_errors_.Measure(robot_.StateAt(time_us), time_us);
  TellContacts();
  if (measured.is_lost) {
    ++odometry_lost_;
    return;
  }
  SendLater(odometry_line_,
            measured.delay_us,
            [this, message = ToOdometry(clock_.UtimeOf(time_us), measured)] {
              node_.Publish(channels::kOdometry, message);
            });
}

void SimulatedBase::PublishPose() {
  const std::int64_t now_us = clock_.Now();
  const std::int64_t time_us = now_us - now_us % pose_period_us_;
  if (time_us <= pose_us_) return;
  pose_us_ = time_us;
  const core::MeasuredPose measured = pose_errors_.Measure(robot_.StateAt(time_us).in_map, time_us);
  if (measured.is_lost) {
    ++poses_lost_;
    return;
  }
  const std::int64_t utime = clock_.UtimeOf(time_us);
  pose_status_t status =
      messages::ToPoseStatus(utime, {config_.pose_sigma_m, config_.pose_sigma_rad});
  status.source = "simulator";
  status.state = StateOf(measured.claim);
  SendLater(pose_line_,
            measured.delay_us,
            [this,
             status = std::move(status),
             pose = messages::ToPose(utime, measured.in_map.Transform())] {
              node_.Publish(channels::kPose, pose);
              node_.Publish(channels::kPoseStatus, status);
            });
}

void SimulatedBase::SendLater(Line& line, std::int64_t delay_us, std::function<void()> send) {
  const std::int64_t now_us = clock_.Now();
  const std::int64_t due_us = std::max(now_us + delay_us, line.due_us);
  if (due_us <= now_us) {
    send();
    return;
  }
  line.due_us = due_us;
  node_.runtime().After(due_us - now_us, std::move(send));
}

void SimulatedBase::TellContacts() {
  for (; contacts_told_ < robot_.contacts().size(); ++contacts_told_) {
    if (on_contact_) on_contact_(robot_.contacts()[contacts_told_]);
  }
}

void SimulatedBase::SetCounters() {
  const core::RobotState state = robot_.StateAt(clock_.Now());
  const double nearest_m = robot_.nearest().distance_m;
  node_.SetCounter("contacts", static_cast<std::int64_t>(robot_.contacts().size()));
  node_.SetCounter("nearest_mm", std::isfinite(nearest_m) ? std::llround(1e3 * nearest_m) : -1);
  node_.SetCounter("driven_mm", std::llround(1e3 * state.driven_m));
  node_.SetCounter("permits_foreign", robot_.gate().num_foreign_permits());
  node_.SetCounter("permits_repeated", robot_.gate().num_repeated_permits());
  node_.SetCounter("numbers_absurd", robot_.gate().num_absurd());
  node_.SetCounter("odometry_lost_on_purpose", odometry_lost_);
  node_.SetCounter("poses_lost_on_purpose", poses_lost_);
  node_.SetCounter("clock_steps", clock_steps_);
  if (config_.drive == DriveMode::kRequest || config_.drive == DriveMode::kCommand) {
    node_.SetCounter("orders_foreign", robot_.gate().num_foreign_commands());
    node_.SetCounter("orders_repeated", robot_.gate().num_repeated_commands());
  }
}

process::State SimulatedBase::State() {
  const std::int64_t now_us = clock_.Now();
  const std::string motion = MotionText();
  const std::string permit = PermitText(now_us);
  process::State state{status_t::STATE_OK, true, motion + permit};
  const bool waits = config_.obey_permit && config_.drive != DriveMode::kStill &&
                     robot_.gate().PermitState(now_us) != GateState::kValid;
  if (waits) state.code = status_t::STATE_WAITING;
  if (robot_.touched()) state.code = status_t::STATE_DEGRADED;
  return state;
}

std::string SimulatedBase::MotionText() {
  const std::int64_t now_us = clock_.Now();
  const core::RobotState state = robot_.StateAt(now_us);
  if (robot_.touched()) return "touches " + robot_.NameOf(*robot_.touched()) + " and stands there";
  if (state.v_mps != 0.0) {
    const char* const way = state.v_mps > 0.0 ? "driving at " : "driving backward at ";
    return way + Fixed(std::abs(state.v_mps)) + " m/s";
  }
  if (state.w_radps != 0.0) return "turning at " + Fixed(state.w_radps) + " rad/s";
  if (robot_.has_arrived()) return "arrived at the last waypoint";
  const bool is_ordered =
      config_.drive == DriveMode::kRequest || config_.drive == DriveMode::kCommand;
  if (is_ordered && robot_.gate().CommandState(now_us) != GateState::kValid) {
    return std::string("stands: ") +
           (config_.drive == DriveMode::kRequest ? "DRIVE_REQUEST " : "DRIVE_COMMAND ") +
           core::GateText(robot_.gate().CommandState(now_us));
  }
  return "stands";
}

std::string SimulatedBase::PermitText(std::int64_t time_us) const {
  if (config_.drive == DriveMode::kStill) return {};
  if (!config_.obey_permit) return "; obeys no permit";
  const GateState state = robot_.gate().PermitState(time_us);
  if (state != GateState::kValid) {
    return std::string("; the permit ") + core::GateText(state);
  }
  std::string text = "; permit " + Fixed(permit_.forward_mps) + " m/s";
  if (!permit_.text.empty()) text += ": " + permit_.text;
  if (permit_.free_distance_m >= 0.0) text += ", " + Fixed(permit_.free_distance_m) + " m ahead";
  return text;
}

}  // namespace clearway
