// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/sensor_link.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace clearway::core::livox {
namespace {

constexpr std::int64_t kFirstHeartbeat_us = 50'000;
// Until it samples, a sensor is asked more often whether it is ready.
constexpr std::int64_t kReadyHeartbeat_us = 250'000;
constexpr std::size_t kMaxHeartbeats = 64;
// A sensor sends a packet each millisecond; silence for so long is one that has stopped.
constexpr std::int64_t kDataGap_us = 100'000;
// A broadcast in a connection that is younger was under way before it.
constexpr std::int64_t kSettled_us = 1'000'000;
// Told to sample, it is told again when nothing has come for so long.
constexpr std::int64_t kNoData_us = 1'000'000;
constexpr int kMaxUnanswered = 10;
constexpr int kMaxRefusals = 3;
constexpr std::int64_t kAfterRefusal_us = 200'000;

bool SameMounting(const Extrinsic& a, const Extrinsic& b) {
  const auto near_deg = [](float x, float y) {
    return std::abs(std::remainder(double{x} - double{y}, 360.0)) < 0.1;
  };
  const auto near_mm = [](std::int32_t x, std::int32_t y) {
    return std::abs(std::int64_t{x} - y) <= 5;
  };
  return near_deg(a.roll_deg, b.roll_deg) && near_deg(a.pitch_deg, b.pitch_deg) &&
         near_deg(a.yaw_deg, b.yaw_deg) && near_mm(a.x_mm, b.x_mm) && near_mm(a.y_mm, b.y_mm) &&
         near_mm(a.z_mm, b.z_mm);
}

std::string Words(const Extrinsic& e) {
  const auto tenth = [](float value) {
    if (!std::isfinite(value)) return std::string("?");
    const double tenths = std::round(std::clamp(double{value}, -1e6, 1e6) * 10.0);
    std::string text = std::to_string(tenths / 10.0);
    return text.substr(0, text.find('.') + 2);
  };
  return "x " + std::to_string(e.x_mm) + " y " + std::to_string(e.y_mm) + " z " +
         std::to_string(e.z_mm) + " mm, roll " + tenth(e.roll_deg) + " pitch " +
         tenth(e.pitch_deg) + " yaw " + tenth(e.yaw_deg) + " deg";
}

std::string ResultText(std::uint8_t result) {
  return " (result " + std::to_string(result) + ")";
}

}  // namespace

SensorLink::SensorLink(const LinkConfig& config) : config_(config) {}

LinkState SensorLink::state() const {
  switch (phase_) {
    case Phase::kSearching:
      return LinkState::kSearching;
    case Phase::kHandshaking:
      return LinkState::kHandshaking;
    case Phase::kClosed:
      return LinkState::kClosed;
    case Phase::kConnected:
      break;
  }
  if (is_sampling_) return LinkState::kSampling;
  return SettingsPending() ? LinkState::kConfiguring : LinkState::kStarting;
}

void SensorLink::Offer(const Endpoint& sensor, Ipv4 host_ip, std::int64_t now_us) {
  host_ip_ = host_ip;
  if (phase_ != Phase::kSearching) return;
  address_ = sensor;
  BeginHandshake(now_us);
}

void SensorLink::OnBroadcast(const Endpoint& from, Ipv4 host_ip, std::int64_t now_us) {
  if (phase_ == Phase::kClosed) return;
  if (phase_ == Phase::kConnected) {
    BroadcastWhileConnected(from, now_us);
    if (phase_ == Phase::kConnected) return;
  }
  host_ip_ = host_ip;
  last_broadcast_us_ = now_us;
  if (address_ && address_->ip != from.ip) {
    Tell(LinkEvent::Kind::kMoved,
         "has moved from " + ToString(address_->ip) + " to " + ToString(from.ip));
    is_proven_ = false;
  }
  address_ = from;
  if (phase_ == Phase::kSearching) {
    BeginHandshake(now_us);
    return;
  }
  handshakes_in_row_ = 0;
  next_handshake_us_ =
      std::min(next_handshake_us_, std::max(now_us, *last_handshake_us_ + kHandshakeGap_us));
  if (now_us >= next_handshake_us_) SendHandshake(now_us);
}

// A connected sensor is silent here. One that is not has been restarted, or has lost us; unless its
// points go on, and then it is only talkative.
void SensorLink::BroadcastWhileConnected(const Endpoint& from, std::int64_t now_us) {
  if (from.ip != address_->ip) {
    if (!IsAlive(now_us)) {
      Reconnect(LinkEvent::Kind::kRestarted, "announces itself from another address", now_us);
    } else if (twin_ != from.ip) {
      twin_ = from.ip;
      Tell(LinkEvent::Kind::kTold,
           "another sensor with the same broadcast code is at " + ToString(from.ip) +
               "; it is not used");
    }
    return;
  }
  if (is_sampling_ && last_data_us_ && now_us - *last_data_us_ < kDataGap_us) {
    if (!suspected_us_) suspected_us_ = now_us;
  } else if (now_us - connected_us_ >= kSettled_us) {
    Reconnect(LinkEvent::Kind::kRestarted, "was restarted, or has lost this host", now_us);
  }
}

bool SensorLink::IsAlive(std::int64_t now_us) const {
  if (is_sampling_) return last_data_us_ && now_us - *last_data_us_ < kDataGap_us;
  return now_us - last_ack_us_ < HeartbeatInterval() + kDataGap_us;
}

void SensorLink::JudgeSuspicion(std::int64_t now_us) {
  if (!suspected_us_ || now_us < *suspected_us_ + kDataGap_us) return;
  // What was under way when it announced itself may come a little later.
  const bool goes_on = last_data_us_ && *last_data_us_ > *suspected_us_ + kDataGap_us / 2;
  suspected_us_.reset();
  if (goes_on) {
    ++counts_.broadcasts_while_connected;
  } else {
    Reconnect(LinkEvent::Kind::kRestarted, "was restarted, or has lost this host", now_us);
  }
}

void SensorLink::BeginHandshake(std::int64_t now_us) {
  phase_ = Phase::kHandshaking;
  handshake_sequence_ = NextSequence();
  handshakes_in_row_ = 0;
  unanswered_handshakes_ = 0;
  handshake_refusal_.reset();
  handshaking_since_us_ = now_us;
  next_handshake_us_ =
      last_handshake_us_ ? std::max(now_us, *last_handshake_us_ + kHandshakeGap_us) : now_us;
  if (now_us >= next_handshake_us_) SendHandshake(now_us);
}

void SensorLink::SendHandshake(std::int64_t now_us) {
  // The vendor's SDK marks its handshake as an acknowledgement and sends it to where the broadcast
  // came from; the protocol's description says a command, to the sensor's port. Each in turn.
  const bool as_described = unanswered_handshakes_ % 2 == 0;
  const Bytes body = PackBody(Handshake{.host_ip = host_ip_,
                                        .data_port = config_.data_port,
                                        .command_port = config_.command_port,
                                        .imu_port = config_.imu_port});
  Send(as_described ? FrameType::kCommand : FrameType::kAck,
       handshake_sequence_,
       CommandCode::kHandshake,
       body,
       as_described ? CommandAddress() : *address_);
  ++counts_.handshakes;
  ++unanswered_handshakes_;
  const std::int64_t delay_us = config_.answer_timeout_us << std::min(handshakes_in_row_, 10);
  ++handshakes_in_row_;
  last_handshake_us_ = now_us;
  next_handshake_us_ = now_us + std::clamp(delay_us, kHandshakeGap_us, kLongestBackOff_us);
}

void SensorLink::OnHandshakeAck(const ControlFrame& frame, std::int64_t now_us) {
  const std::optional<std::uint8_t> result = ParseByte(frame.data);
  if (phase_ != Phase::kHandshaking || frame.sequence != handshake_sequence_ || !result) {
    ++counts_.odd_frames;
    return;
  }
  if (*result == 0) {
    Connected(now_us);
    return;
  }
  ++counts_.refusals;
  if (handshake_refusal_ != *result) {
    Tell(LinkEvent::Kind::kRefused, "refuses the handshake" + ResultText(*result));
  }
  handshake_refusal_ = *result;
}

void SensorLink::Connected(std::int64_t now_us) {
  phase_ = Phase::kConnected;
  is_proven_ = true;
  ++counts_.connections;
  connected_us_ = last_ack_us_ = work_state_since_us_ = now_us;
  settings_again_us_ = now_us + kSettingAgain_us;
  next_heartbeat_us_ = now_us + kFirstHeartbeat_us;
  heartbeats_.clear();
  heartbeat_refusal_.reset();
  work_state_ = WorkState::kUnknown;
  is_sampling_ = false;
  last_data_us_.reset();
  suspected_us_.reset();
  twin_.reset();
  steps_ = {};
  steps_[kInfoStep].code = CommandCode::kDeviceInfo;
  steps_[kCoordinatesStep] = {.code = CommandCode::kCoordinates,
                              .body = PackByte(static_cast<std::uint8_t>(config_.coordinates))};
  steps_[kReturnModeStep] = {.code = CommandCode::kSetReturnMode,
                             .body = PackByte(static_cast<std::uint8_t>(config_.return_mode))};
  steps_[kExtrinsicStep].code = CommandCode::kGetExtrinsic;
  if (config_.write_extrinsic) {
    steps_[kExtrinsicStep] = {.code = CommandCode::kSetExtrinsic,
                              .body = PackBody(config_.extrinsic)};
  }
  steps_[kModeStep] = {.code = CommandCode::kMode, .body = PackByte(1)};
  steps_[kSamplingStep] = {.code = CommandCode::kSampling, .body = PackByte(1)};
  for (Step& step : steps_) step.sequence = NextSequence();
  Tell(LinkEvent::Kind::kConnected, "connected at " + ToString(address_->ip));
  AdvanceConnection(now_us);
}

void SensorLink::Reconnect(LinkEvent::Kind why, std::string text, std::int64_t now_us) {
  ++(why == LinkEvent::Kind::kLost ? counts_.losses : counts_.restarts);
  const bool is_short = now_us - connected_us_ < kShortConnection_us;
  // A sensor that announces itself has nobody else.
  short_connections_ = is_short && why == LinkEvent::Kind::kLost ? short_connections_ + 1 : 0;
  is_sampling_ = false;
  Tell(why, std::move(text));
  BeginHandshake(now_us);
}

void SensorLink::Advance(std::int64_t now_us) {
  if (phase_ == Phase::kHandshaking && now_us >= next_handshake_us_) SendHandshake(now_us);
  if (phase_ == Phase::kConnected) AdvanceConnection(now_us);
}

void SensorLink::AdvanceConnection(std::int64_t now_us) {
  if (now_us - last_ack_us_ >= config_.lost_after_us) {
    Reconnect(LinkEvent::Kind::kLost, "answers no heartbeat any more", now_us);
    return;
  }
  JudgeSuspicion(now_us);
  if (phase_ != Phase::kConnected) return;
  if (now_us >= next_heartbeat_us_) SendHeartbeat(now_us);
  AskAgain(now_us);
  const std::optional<std::size_t> current = CurrentStep();
  if (!current || now_us < steps_[*current].next_us) return;
  Step& step = steps_[*current];
  if (step.unanswered < kMaxUnanswered || *current >= kNumSettings) {
    SendStep(step, now_us);
    return;
  }
  step.outcome = Outcome::kGivenUp;
  Tell(LinkEvent::Kind::kTold, std::string("does not answer: ") + CommandName(step.code));
  AdvanceConnection(now_us);  // On to the next one; there are not many.
}

// What was given up, and a sensor that has agreed to sample and sends nothing.
void SensorLink::AskAgain(std::int64_t now_us) {
  if (now_us >= settings_again_us_) {
    settings_again_us_ = now_us + kSettingAgain_us;
    for (std::size_t i = 0; i < kNumSettings; ++i) {
      if (steps_[i].outcome != Outcome::kGivenUp) continue;
      steps_[i].outcome = Outcome::kPending;
      // One more try each time: an old complaint must not delay anything.
      steps_[i].unanswered = kMaxUnanswered - 1;
      steps_[i].refusals = kMaxRefusals - 1;
      steps_[i].next_us = now_us;
    }
  }
  Step& sampling = steps_[kSamplingStep];
  if (is_sampling_ && sampling.outcome == Outcome::kDone && now_us >= sampling.next_us &&
      now_us - std::max(sampling_since_us_, last_data_us_.value_or(0)) >= kNoData_us) {
    sampling.outcome = Outcome::kPending;
  }
}

bool SensorLink::SettingsPending() const {
  return std::any_of(steps_.begin(), steps_.begin() + kNumSettings, [](const Step& step) {
    return step.outcome == Outcome::kPending;
  });
}

std::optional<std::size_t> SensorLink::CurrentStep() const {
  for (std::size_t i = 0; i < kNumSettings; ++i) {
    if (steps_[i].outcome == Outcome::kPending) return i;
  }
  const bool stands_by =
      work_state_ == WorkState::kStandby || work_state_ == WorkState::kPowerSaving;
  if (stands_by) return kModeStep;
  const bool is_ready = work_state_ == WorkState::kNormal;
  if (is_ready && steps_[kSamplingStep].outcome == Outcome::kPending) return kSamplingStep;
  return std::nullopt;
}

void SensorLink::SendStep(Step& step, std::int64_t now_us) {
  if (step.unanswered > 0) ++counts_.repeats;
  ++step.unanswered;
  step.next_us = now_us + config_.answer_timeout_us;
  Send(FrameType::kCommand, step.sequence, step.code, step.body, CommandAddress());
}

std::int64_t SensorLink::HeartbeatInterval() const {
  return is_sampling_ ? config_.heartbeat_us : std::min(config_.heartbeat_us, kReadyHeartbeat_us);
}

void SensorLink::SendHeartbeat(std::int64_t now_us) {
  heartbeats_.push_back(NextSequence());
  if (heartbeats_.size() > kMaxHeartbeats) heartbeats_.pop_front();
  Send(FrameType::kCommand, heartbeats_.back(), CommandCode::kHeartbeat, {}, CommandAddress());
  next_heartbeat_us_ = now_us + HeartbeatInterval();
}

std::optional<std::int64_t> SensorLink::NextDue() const {
  if (phase_ == Phase::kHandshaking) return next_handshake_us_;
  if (phase_ != Phase::kConnected) return std::nullopt;
  std::int64_t due_us = std::min(next_heartbeat_us_, last_ack_us_ + config_.lost_after_us);
  due_us = std::min(due_us, settings_again_us_);
  if (suspected_us_) due_us = std::min(due_us, *suspected_us_ + kDataGap_us);
  if (const std::optional<std::size_t> current = CurrentStep()) {
    due_us = std::min(due_us, steps_[*current].next_us);
  } else if (is_sampling_) {
    const std::int64_t data_us = std::max(sampling_since_us_, last_data_us_.value_or(0));
    due_us = std::min(due_us, std::max(steps_[kSamplingStep].next_us, data_us + kNoData_us));
  }
  return due_us;
}

void SensorLink::OnFrame(const ControlFrame& frame, std::int64_t now_us) {
  if (phase_ == Phase::kClosed || phase_ == Phase::kSearching) return;
  const CommandCode code = CodeOf(frame);
  if (frame.type == FrameType::kMessage) {
    if (code == CommandCode::kAbnormalStatus && frame.data.size() == sizeof(std::uint32_t)) {
      status_code_ = Load<std::uint32_t>(frame.data, 0);
    } else {
      ++counts_.odd_frames;
    }
    return;
  }
  if (frame.type == FrameType::kAck && code == CommandCode::kHandshake) {
    OnHandshakeAck(frame, now_us);
    return;
  }
  if (frame.type != FrameType::kAck || phase_ != Phase::kConnected) {
    ++counts_.odd_frames;
    return;
  }
  if (code == CommandCode::kHeartbeat) {
    OnHeartbeatAck(frame, now_us);
    return;
  }
  const auto step = std::find_if(steps_.begin(), steps_.end(), [&](const Step& each) {
    return each.code == code && each.sequence == frame.sequence && each.unanswered > 0;
  });
  if (step == steps_.end()) {
    ++counts_.odd_frames;
    return;
  }
  OnStepAck(*step, frame, now_us);
}

void SensorLink::OnHeartbeatAck(const ControlFrame& frame, std::int64_t now_us) {
  const std::optional<HeartbeatAck> ack = ParseHeartbeatAck(frame.data);
  const auto asked = std::find(heartbeats_.begin(), heartbeats_.end(), frame.sequence);
  if (!ack || asked == heartbeats_.end()) {
    ++counts_.odd_frames;
    return;
  }
  heartbeats_.erase(heartbeats_.begin(), asked + 1);
  if (ack->result != 0) {
    ++counts_.refusals;
    if (heartbeat_refusal_ != ack->result) {
      Tell(LinkEvent::Kind::kRefused, "refuses heartbeats" + ResultText(ack->result));
    }
    heartbeat_refusal_ = ack->result;
    return;
  }
  heartbeat_refusal_.reset();
  last_ack_us_ = now_us;
  if (ack->state == WorkState::kInit) {
    init_progress_ = ack->progress;
  } else {
    status_code_ = ack->progress;
  }
  if (ack->state != work_state_) OnWorkState(ack->state, now_us);
}

void SensorLink::OnWorkState(WorkState state, std::int64_t now_us) {
  if (work_state_ != WorkState::kUnknown) {
    Tell(LinkEvent::Kind::kTold,
         std::string("was ") + WorkStateName(work_state_) + ", is " + WorkStateName(state));
  }
  work_state_ = state;
  work_state_since_us_ = now_us;
  if (state == WorkState::kNormal) {
    // What it refused while it was not ready is worth another question.
    for (std::size_t i = 0; i < kNumSettings; ++i) {
      if (steps_[i].outcome != Outcome::kGivenUp) continue;
      steps_[i] = {.code = steps_[i].code, .body = steps_[i].body, .sequence = NextSequence()};
    }
  } else {
    is_sampling_ = false;
  }
  for (const StepIndex index : {kModeStep, kSamplingStep}) {
    steps_[index] = {
        .code = steps_[index].code, .body = steps_[index].body, .sequence = NextSequence()};
  }
  AdvanceConnection(now_us);
}

void SensorLink::OnStepAck(Step& step, const ControlFrame& frame, std::int64_t now_us) {
  if (frame.data.empty()) {
    ++counts_.odd_frames;
    return;
  }
  step.unanswered = 0;
  const std::uint8_t result = Load<std::uint8_t>(frame.data, 0);
  if (result != 0) {
    RefuseStep(step, result, now_us);
  } else {
    step.outcome = Outcome::kDone;
    step.refusals = 0;
    // A mode takes its time, and a sensor that sends nothing is not told all the time.
    step.next_us = now_us + kNoData_us;
    TakeAnswer(step, frame, now_us);
  }
  AdvanceConnection(now_us);
}

void SensorLink::RefuseStep(Step& step, std::uint8_t result, std::int64_t now_us) {
  ++counts_.refusals;
  if (step.refusals == 0 || step.result != result) {
    Tell(LinkEvent::Kind::kRefused,
         std::string("refuses: ") + CommandName(step.code) + ResultText(result));
  }
  step.result = result;
  ++step.refusals;
  step.next_us = now_us + kAfterRefusal_us;
  if (&step >= &steps_[kNumSettings]) {
    step.next_us = now_us + kNoData_us;  // Without these there are no points: they are asked on.
  } else if (step.refusals >= kMaxRefusals) {
    step.outcome = Outcome::kGivenUp;
  }
}

void SensorLink::TakeAnswer(const Step& step, const ControlFrame& frame, std::int64_t now_us) {
  if (step.code == CommandCode::kDeviceInfo) {
    const std::optional<DeviceInfoAck> info = ParseDeviceInfoAck(frame.data);
    if (!info) {
      ++counts_.odd_frames;
      return;
    }
    firmware_ = info->firmware;
    Tell(LinkEvent::Kind::kTold, "has firmware " + FirmwareText(info->firmware));
  } else if (step.code == CommandCode::kGetExtrinsic) {
    TakeExtrinsic(frame);
  } else if (step.code == CommandCode::kSetExtrinsic) {
    stored_extrinsic_ = config_.extrinsic;
  } else if (step.code == CommandCode::kSampling && !is_sampling_) {
    is_sampling_ = true;
    sampling_since_us_ = now_us;
    Tell(LinkEvent::Kind::kSampling, "samples");
  }
}

void SensorLink::TakeExtrinsic(const ControlFrame& frame) {
  const std::optional<ExtrinsicAck> ack = ParseExtrinsicAck(frame.data);
  if (!ack) {
    ++counts_.odd_frames;
    return;
  }
  const bool is_news = stored_extrinsic_ != ack->extrinsic;
  stored_extrinsic_ = ack->extrinsic;
  // All zero: nobody has told it.
  if (!is_news || ack->extrinsic == Extrinsic{} ||
      SameMounting(ack->extrinsic, config_.extrinsic)) {
    return;
  }
  Tell(LinkEvent::Kind::kTold,
       "believes to be mounted at " + Words(ack->extrinsic) + "; the configuration says " +
           Words(config_.extrinsic) + ", which is used (write_extrinsic=\"true\" tells it)");
}

void SensorLink::Close() {
  if (phase_ == Phase::kClosed) return;
  const bool is_spoken_to = phase_ == Phase::kConnected || unanswered_handshakes_ > 0;
  if (is_spoken_to && phase_ != Phase::kSearching) {
    Send(
        FrameType::kCommand, NextSequence(), CommandCode::kSampling, PackByte(0), CommandAddress());
    Send(FrameType::kCommand, NextSequence(), CommandCode::kDisconnect, {}, CommandAddress());
  }
  phase_ = Phase::kClosed;
  is_proven_ = false;
}

void SensorLink::Send(FrameType type,
                      std::uint16_t sequence,
                      CommandCode code,
                      ByteView body,
                      Endpoint to) {
  outgoing_.push_back({to, PackCommand(type, sequence, code, body)});
}

void SensorLink::Tell(LinkEvent::Kind kind, std::string text) {
  events_.push_back({kind, std::move(text)});
}

std::uint16_t SensorLink::NextSequence() {
  if (++last_sequence_ == 0) ++last_sequence_;
  return last_sequence_;
}

}  // namespace clearway::core::livox
