// SPDX-License-Identifier: BSD-3-Clause
// Of LivoxDriverProcess: its status.
#include <algorithm>

#include "processes/livox_driver/livox_driver_process.hpp"

namespace clearway {
namespace {

using core::livox::Health;
using core::livox::LinkReport;
using core::livox::LinkState;

constexpr std::int64_t kSilence_us = 3'000'000;

std::int8_t StateOf(Health worst, bool has_points) {
  switch (worst) {
    case Health::kOk:
      return status_t::STATE_OK;
    case Health::kWaiting:
      return status_t::STATE_WAITING;
    case Health::kDegraded:
      return status_t::STATE_DEGRADED;
    case Health::kFault:
      break;
  }
  return has_points ? status_t::STATE_DEGRADED : status_t::STATE_FAULT;
}

}  // namespace

// Why a sensor has not been found yet.
std::string LivoxDriverProcess::SearchText(const Lidar& lidar) const {
  if (!lidar.subnet_problem.empty()) return lidar.subnet_problem;
  if (NowUs() - started_us_ < kSilence_us) return "looks for it";
  const core::livox::LidarConfig& config = lidar.config;
  const std::string wanted =
      config.broadcast_code.empty() ? "a MID-70" : "\"" + config.broadcast_code + "\"";
  if (!config.ip.empty() && !core::ParseIpv4(config.ip)) return "no address";
  const std::string unknown = UnknownText();
  if (!unknown.empty()) {
    return wanted + " is not heard, but " + unknown + ": set livox_driver.lidar.broadcast_code";
  }
  return "no broadcast of " + wanted + " heard on UDP port " +
         std::to_string(config_.broadcast_port) +
         ": check its power and cable, that this host has an address in its subnet, and the "
         "firewall; set livox_driver.lidar.ip where broadcasts do not arrive";
}

// Those who are heard and not in the configuration.
std::string LivoxDriverProcess::UnknownText() const {
  std::string text;
  for (const auto& [code, heard] : heard_) {
    const bool is_used =
        std::any_of(lidars_.begin(), lidars_.end(), [&, ip = heard.ip](const auto& lidar) {
          const auto address = lidar->link.address();
          return address && address->ip == ip;
        });
    if (is_used || IsClaimed(code, heard) || NowUs() - heard.last_us > kSilence_us) continue;
    text += (text.empty() ? "" : ", ") + std::string(core::livox::DeviceName(heard.type)) + " " +
            code + " at " + core::ToString(heard.ip);
  }
  return text;
}

void LivoxDriverProcess::Refresh() {
  Health worst = Health::kOk;
  bool has_points = false;
  std::string text;
  for (const auto& lidar : lidars_) {
    LinkReport report = lidar->link.Report(NowUs());
    if (report.state == LinkState::kSearching) {
      report.text = SearchText(*lidar);
      if (!lidar->subnet_problem.empty()) report.health = Health::kFault;
    }
    if (report.state == LinkState::kSampling && report.health == Health::kOk) {
      report.text += ", " + lidar->output.TimeText();
    }
    has_points = has_points || report.health == Health::kOk || report.health == Health::kDegraded;
    worst = std::max(worst, report.health);
    text += (text.empty() ? "" : "; ") + lidar->config.sensor + ": " + report.text;

    lidar->output.SetCounters();
    const core::livox::LinkCounts& counts = lidar->link.counts();
    const auto set = [&](const char* name, std::int64_t value) {
      node_.SetCounter(lidar->config.sensor + '_' + name, value);
    };
    set("link_state", static_cast<std::int64_t>(report.state));
    set("connections", counts.connections);
    set("connections_lost", counts.losses + counts.restarts);
    set("handshakes", counts.handshakes);
    set("commands_repeated", counts.repeats);
    set("commands_refused", counts.refusals);
  }
  const std::string unknown = UnknownText();
  if (!unknown.empty()) text += "; not used: " + unknown;
  std::int64_t broken = 0;
  for (std::size_t i = 1; i < frame_defects_.size(); ++i) broken += frame_defects_[i];
  node_.SetCounter("broken_frames", broken);
  node_.SetCounter("foreign_frames", foreign_frames_);
  node_.SetCounter("foreign_packets", foreign_packets_);
  node_.SetCounter("kernel_drops", data_socket_->counts().dropped_by_kernel);
  node_.SetCounter("truncated", data_socket_->counts().truncated);
  node_.SetCounter("data_buffer_bytes", data_socket_->receive_buffer_bytes());
  node_.SetCounter("command_send_failures", command_socket_->counts().send_failures);
  node_.SetState({StateOf(worst, has_points), true, text});
}

}  // namespace clearway
