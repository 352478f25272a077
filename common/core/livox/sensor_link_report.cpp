// SPDX-License-Identifier: BSD-3-Clause
// Of SensorLink: how the sensor is, in the user's words.
#include <algorithm>
#include <string>

#include "common/core/livox/sensor_link.hpp"

namespace clearway::core::livox {
namespace {

constexpr int kWorthTelling = 3;  // Handshakes without an answer.
constexpr std::int64_t kNoData_us = 1'000'000;
constexpr std::int64_t kLongStart_us = 30'000'000;
constexpr std::int64_t kHeard_us = 3'000'000;  // A broadcast comes each second.
constexpr int kStolen = 2;                     // Connections in a row that did not last.

std::string Join(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences) text += (text.empty() ? "" : "; ") + sentence;
  return text;
}

}  // namespace

const char* LinkStateName(LinkState state) {
  switch (state) {
    case LinkState::kSearching:
      return "searching";
    case LinkState::kHandshaking:
      return "handshaking";
    case LinkState::kConfiguring:
      return "configuring";
    case LinkState::kStarting:
      return "starting";
    case LinkState::kSampling:
      return "sampling";
    case LinkState::kClosed:
      return "closed";
  }
  return "unknown";
}

LinkReport SensorLink::Report(std::int64_t now_us) const {
  switch (state()) {
    case LinkState::kSearching:
      return {.state = LinkState::kSearching, .health = Health::kWaiting, .text = {}};
    case LinkState::kClosed:
      return {.state = LinkState::kClosed, .health = Health::kWaiting, .text = "closed"};
    case LinkState::kHandshaking:
      return ReportHandshake(now_us);
    case LinkState::kConfiguring:
    case LinkState::kStarting:
      return ReportSetUp(now_us);
    case LinkState::kSampling:
      break;
  }
  return ReportSampling(now_us);
}

LinkReport SensorLink::ReportHandshake(std::int64_t now_us) const {
  LinkReport report{.state = LinkState::kHandshaking, .health = Health::kWaiting, .text = {}};
  const std::string where = ToString(address_->ip);
  const bool is_heard = last_broadcast_us_ && now_us - *last_broadcast_us_ < kHeard_us;
  if (handshake_refusal_) {
    report.health = Health::kFault;
    report.text = where + " refuses the handshake (result " + std::to_string(*handshake_refusal_) +
                  "): is another program or host connected to it?";
  } else if (short_connections_ >= kStolen) {
    report.health = Health::kFault;
    report.text = "connections to " + where + " do not last: another program or host takes it";
  } else if (unanswered_handshakes_ >= kWorthTelling && is_heard) {
    report.health = Health::kFault;
    report.text = where +
                  " announces itself, but its answers do not come: does a firewall stop UDP " +
                  "to port " + std::to_string(config_.command_port) + "?";
  } else if (unanswered_handshakes_ >= kWorthTelling) {
    report.health = Health::kFault;
    report.text = where + " answers no handshake for " +
                  std::to_string((now_us - handshaking_since_us_) / 1'000'000) +
                  " s: is it switched on and plugged in, does a firewall stop UDP to port " +
                  std::to_string(config_.command_port) + "?";
  } else {
    report.text = "asks " + where + " for a connection";
  }
  return report;
}

LinkReport SensorLink::ReportSetUp(std::int64_t now_us) const {
  LinkReport report{.state = state(), .health = Health::kWaiting, .text = {}};
  const std::int64_t waiting_us = now_us - work_state_since_us_;
  if (heartbeat_refusal_) {
    report.health = Health::kFault;
    report.text = "refuses heartbeats: another program or host has taken it";
  } else if (work_state_ == WorkState::kError) {
    report.health = Health::kFault;
    const std::string complaints = Join(Complaints(status()));
    report.text = "is in error" + (complaints.empty() ? "" : ": " + complaints);
  } else if (work_state_ == WorkState::kInit) {
    report.text =
        "starts up, " + std::to_string(std::min<std::uint32_t>(init_progress_, 100)) + " %";
    if (waiting_us > kLongStart_us) {
      report.health = Health::kFault;
      report.text += " for " + std::to_string(waiting_us / 1'000'000) +
                     " s: switch it off and on, check its supply";
    }
  } else if (work_state_ == WorkState::kStandby || work_state_ == WorkState::kPowerSaving) {
    report.text = std::string("is ") + WorkStateName(work_state_) + "; told to work normally";
  } else if (SettingsPending()) {
    report.text = "is being set up";
  } else {
    report.text = "is told to sample";
  }
  return report;
}

LinkReport SensorLink::ReportSampling(std::int64_t now_us) const {
  LinkReport report{.state = LinkState::kSampling, .health = Health::kOk, .text = {}};
  std::vector<std::string> sentences = Complaints(status());
  const Severity worst = WorstOf(status());
  if (!sentences.empty()) report.health = Health::kDegraded;
  if (twin_) {
    report.health = Health::kDegraded;
    sentences.push_back("another sensor with the same broadcast code is at " + ToString(*twin_));
  }
  if (short_connections_ >= kStolen && now_us - connected_us_ < kShortConnection_us) {
    report.health = Health::kDegraded;
    sentences.emplace_back("its connections do not last: another program or host takes it");
  }
  const std::string given_up = GivenUpText();
  if (!given_up.empty()) {
    report.health = Health::kDegraded;
    sentences.push_back(given_up);
  }
  const std::int64_t since_us = now_us - std::max(sampling_since_us_, last_data_us_.value_or(0));
  if (since_us >= kNoData_us) {
    report.health = worst >= Severity::kError || last_data_us_ ? Health::kFault : Health::kWaiting;
    if (since_us >= 3 * kNoData_us) report.health = Health::kFault;
    sentences.insert(sentences.begin(),
                     "answers, but sends no points for " + std::to_string(since_us / 1'000'000) +
                         " s: does a firewall stop UDP to port " +
                         std::to_string(config_.data_port) + "?");
  }
  report.text = sentences.empty() ? "samples" : Join(sentences);
  return report;
}

std::string SensorLink::GivenUpText() const {
  std::string text;
  for (std::size_t i = 0; i < kNumSettings; ++i) {
    if (steps_[i].outcome != Outcome::kGivenUp) continue;
    text += text.empty() ? "takes no: " : ", ";
    text += CommandName(steps_[i].code);
  }
  return text;
}

}  // namespace clearway::core::livox
