// SPDX-License-Identifier: BSD-3-Clause
#include "processes/pose_source/pose_source_process.hpp"

#include "common/messages/odometry.hpp"
#include "common/messages/pose.hpp"

namespace clearway {
namespace {

using messages::channels::kLidarPoints;
using messages::channels::kOdometry;
using messages::channels::kPose;
using messages::channels::kPoseStatus;

constexpr std::int64_t kMissingUs = 500'000;
// A stamp that goes back by more than this is a source that started anew [us].
constexpr std::int64_t kRestartUs = 1'000'000;

// Later stamps are none, and differences of two such ones fit.
constexpr std::int64_t kMaxUtime = std::int64_t{1} << 60;

// When the last shot of a slice was fired [us since the epoch]. Nothing when the slice breaks a
// rule of the type.
std::optional<std::int64_t> EndOf(const lidar_points_t& slice) {
  const bool is_sound = slice.slice_index >= 0 && slice.slice_index < slice.slice_count &&
                        slice.scan_utime >= 0 && slice.scan_utime <= slice.scan_end_utime &&
                        slice.scan_end_utime <= kMaxUtime;
  if (!is_sound) return std::nullopt;
  const std::int64_t remaining = slice.slice_count - slice.slice_index - 1;
  return slice.scan_end_utime -
         (slice.scan_end_utime - slice.scan_utime) / slice.slice_count * remaining;
}

}  // namespace

PoseSourceProcess::PoseSourceProcess(const core::PoseSourceConfig& config, process::Node& node)
    : config_(config), node_(node), dead_reckoning_(config) {
  if (config_.mode == core::PoseSourceMode::kFixed) {
    node_.Subscribe<lidar_points_t>(kLidarPoints, [this](const auto& m) { OnLidarPoints(m); });
  } else {
    node_.Subscribe<odometry_t>(kOdometry, [this](const auto& m) { OnOdometry(m); });
  }
  node_.BeforeStatus([this] { Refresh(); });
  Refresh();
}

// The pose of a vehicle that stands still holds at any time; it is stated for the times at which
// somebody measures, so that recordings, which have a time of their own, have it too.
void PoseSourceProcess::OnLidarPoints(const lidar_points_t& message) {
  const std::optional<std::int64_t> utime = EndOf(message);
  if (!utime) {
    node_.CountInvalid();
    return;
  }
  const bool is_news = !last_utime_ || *utime > *last_utime_ || *last_utime_ - *utime > kRestartUs;
  if (is_news) Publish(*utime, config_.Start());
}

void PoseSourceProcess::OnOdometry(const odometry_t& message) {
  using core::SequenceVerdict;
  const std::int64_t session_before = odometry_senders_.session();
  const SequenceVerdict verdict =
      odometry_senders_.Observe(message.session, message.sequence, node_.runtime().MonotonicUs());
  if (verdict == SequenceVerdict::kForeign) return;
  // A base that started anew counts from another place, whether its clock went back or not.
  if (verdict == SequenceVerdict::kRestart && message.session != session_before) {
    odometry_.Clear();
    dead_reckoning_.OdometryRestarted();
  }
  const Eigen::Isometry3d T_odom_vehicle = messages::T_odom_vehicle(message);
  using Outcome = core::PoseBuffer::Outcome;
  const Outcome outcome = odometry_.Add(message.utime, T_odom_vehicle);
  if (outcome == Outcome::kInvalid) node_.CountInvalid();
  if (outcome == Outcome::kRestarted) dead_reckoning_.OdometryRestarted();
  if (outcome != Outcome::kAdded && outcome != Outcome::kRestarted) return;
  Publish(message.utime, dead_reckoning_.Update(T_odom_vehicle));
}

void PoseSourceProcess::Publish(std::int64_t utime, const Eigen::Isometry3d& T_map_vehicle) {
  last_utime_ = utime;
  ++poses_;
  node_.Publish(kPose, messages::ToPose(utime, T_map_vehicle));
  pose_status_t status = messages::ToPoseStatus(
      utime,
      config_.mode == core::PoseSourceMode::kFixed
          ? core::PoseUncertainty{config_.position_sigma_m, config_.yaw_sigma_rad}
          : dead_reckoning_.uncertainty());
  status.source = config_.mode == core::PoseSourceMode::kFixed ? "fixed" : "dead_reckoning";
  node_.Publish(kPoseStatus, std::move(status));
  if (poses_ == 1) Refresh();
}

void PoseSourceProcess::Refresh() {
  node_.SetCounter("poses", poses_);
  const bool is_fixed = config_.mode == core::PoseSourceMode::kFixed;
  const std::string input = is_fixed ? "LIDAR_POINTS" : "ODOMETRY";
  const std::int64_t age_us = node_.InputAgeUs();
  if (age_us < 0) {
    node_.SetState({status_t::STATE_WAITING, true, "no " + input + " yet"});
  } else if (age_us > kMissingUs) {
    node_.SetState({status_t::STATE_WAITING, true, input + " stopped"});
  } else {
    node_.SetState({status_t::STATE_OK, true, is_fixed ? "fixed pose" : "dead reckoning"});
  }
}

}  // namespace clearway
