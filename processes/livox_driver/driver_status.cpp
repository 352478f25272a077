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

// Of a sensor that has not been found yet: why.
LinkReport LivoxDriverProcess::SearchReport(std::size_t index) const {
  const Lidar& lidar = *lidars_[index];
  const auto report = [](Health health, std::string text) {
    return LinkReport{LinkState::kSearching, health, std::move(text)};
  };
  if (!lidar.address_problem.empty()) return report(Health::kFault, lidar.address_problem);
  const std::string problem = heard_.ProblemOf(index, NowUs());
  if (!problem.empty()) return report(Health::kFault, problem);
  if (NowUs() - started_us_ < kSilence_us) return report(Health::kWaiting, "looks for it");
  const std::string& code = lidar.config.broadcast_code;
  const std::string wanted = code.empty() ? "a MID-70" : "\"" + code + "\"";
  const std::string unknown = heard_.UnknownText(NowUs());
  if (!unknown.empty()) {
    return report(
        Health::kWaiting,
        wanted + " is not heard, but " + unknown + ": is livox_driver.lidar.broadcast_code right?");
  }
  return report(
      Health::kWaiting,
      "no broadcast of " + wanted + " heard on UDP port " + std::to_string(config_.broadcast_port) +
          ": check its power and cable, that this host has an address in its subnet, and the "
          "firewall; set livox_driver.lidar.ip where broadcasts do not arrive");
}

LinkReport LivoxDriverProcess::ReportOf(std::size_t index) const {
  const Lidar& lidar = *lidars_[index];
  LinkReport report = lidar.link.Report(NowUs());
  if (report.state == LinkState::kSearching) return SearchReport(index);
  if (report.state == LinkState::kHandshaking && !lidar.address_problem.empty()) {
    return {report.state, Health::kFault, lidar.address_problem};
  }
  if (report.state == LinkState::kHandshaking && !command_socket_->send_error().empty()) {
    return {report.state,
            Health::kFault,
            "cannot send to " + core::ToString(lidar.link.address()->ip) + ": " +
                command_socket_->send_error()};
  }
  if (report.state == LinkState::kSampling && report.health == Health::kOk) {
    report.text += ", " + lidar.output.TimeText();
  }
  return report;
}

void LivoxDriverProcess::Refresh() {
  Health worst = Health::kOk;
  bool has_points = false;
  std::string text;
  for (std::size_t i = 0; i < lidars_.size(); ++i) {
    const LinkReport report = ReportOf(i);
    has_points = has_points || report.health == Health::kOk || report.health == Health::kDegraded;
    worst = std::max(worst, report.health);
    text += (text.empty() ? "" : "; ") + lidars_[i]->config.sensor + ": " + report.text;
  }
  const std::string unknown = heard_.UnknownText(NowUs());
  if (!unknown.empty()) text += "; not used: " + unknown;
  SetCounters();
  node_.SetState({StateOf(worst, has_points), true, text});
}

void LivoxDriverProcess::SetCounters() {
  for (const auto& lidar : lidars_) {
    lidar->output.SetCounters();
    const core::livox::LinkCounts& counts = lidar->link.counts();
    const auto set = [&](const char* name, std::int64_t value) {
      node_.SetCounter(lidar->config.sensor + '_' + name, value);
    };
    set("link_state", static_cast<std::int64_t>(lidar->link.state()));
    set("connections", counts.connections);
    set("connections_lost", counts.losses + counts.restarts);
    set("handshakes", counts.handshakes);
    set("commands_repeated", counts.repeats);
    set("commands_refused", counts.refusals);
    if (const auto firmware = lidar->link.firmware()) {
      // 10.3.0.1 is 10003000001.
      std::int64_t number = 0;
      for (const std::uint8_t part : *firmware) number = number * 1000 + part;
      set("firmware", number);
    }
  }
  std::int64_t broken = 0;
  for (std::size_t i = 1; i < frame_defects_.size(); ++i) broken += frame_defects_[i];
  node_.SetCounter("broken_frames", broken);
  node_.SetCounter("foreign_frames", foreign_frames_);
  node_.SetCounter("foreign_packets", foreign_packets_);
  node_.SetCounter("kernel_drops", data_socket_->counts().dropped_by_kernel);
  node_.SetCounter("truncated", data_socket_->counts().truncated);
  node_.SetCounter("data_buffer_bytes", data_socket_->receive_buffer_bytes());
  node_.SetCounter("command_send_failures", command_socket_->counts().send_failures);
}

}  // namespace clearway
