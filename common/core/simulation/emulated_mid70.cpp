// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/emulated_mid70.hpp"

#include <algorithm>
#include <utility>

namespace clearway::core {
namespace {

using livox::Bytes;
using livox::ByteView;
using livox::CommandCode;
using livox::ControlFrame;
using livox::FrameType;
using livox::WorkState;

constexpr std::int64_t kAbnormalPeriod_us = 100'000;
constexpr std::int64_t kUsPerMs = 1000;

}  // namespace

EmulatedMid70::EmulatedMid70(const EmulatedMid70Config& config,
                             const EmulatedMid70Memory& memory,
                             std::int64_t now_us)
    : config_(config), memory_(memory) {
  PowerCycle(now_us);
}

void EmulatedMid70::PowerCycle(std::int64_t now_us) {
  ++counts_.starts;
  ip_ = memory_.ip;
  started_us_ = now_us;
  measures_from_us_ = now_us + config_.start_up_us;
  mode_ = WorkState::kNormal;
  coordinates_ = livox::Coordinates::kCartesian;
  connection_.reset();
  reboot_us_.reset();
  next_broadcast_us_ = now_us + config_.boot_us;
  sequence_ = 0;
  utc_.reset();
}

void EmulatedMid70::ChangeAddress(Ipv4 ip, std::int64_t now_us) {
  memory_.ip = ip;
  ip_ = ip;
  Disconnect(now_us);
}

void EmulatedMid70::Disconnect(std::int64_t now_us) {
  connection_.reset();
  next_broadcast_us_ = std::max(now_us, started_us_ + config_.boot_us);
}

bool EmulatedMid70::HasError() const {
  using livox::Severity;
  return status_.temperature == Severity::kError || status_.voltage == Severity::kError ||
         status_.motor == Severity::kError || status_.firmware_abnormal;
}

WorkState EmulatedMid70::StateAt(std::int64_t now_us) const {
  if (HasError()) return WorkState::kError;
  if (mode_ != WorkState::kNormal) return mode_;
  return now_us < measures_from_us_ ? WorkState::kInit : WorkState::kNormal;
}

std::optional<EmulatedMid70::Sampling> EmulatedMid70::sampling(std::int64_t now_us) const {
  if (!connection_ || !connection_->is_sampling || StateAt(now_us) != WorkState::kNormal) {
    return std::nullopt;
  }
  const bool is_dual = memory_.return_mode == livox::ReturnMode::kDual;
  const bool is_spherical = coordinates_ == livox::Coordinates::kSpherical;
  livox::DataType type = livox::DataType::kExtendedCartesian;
  if (is_dual) {
    type = is_spherical ? livox::DataType::kDualSpherical : livox::DataType::kDualCartesian;
  } else if (is_spherical) {
    type = livox::DataType::kExtendedSpherical;
  }
  return Sampling{connection_->data, type};
}

std::optional<Endpoint> EmulatedMid70::host() const {
  if (!connection_) return std::nullopt;
  return connection_->commands;
}

std::vector<EmulatedMid70::Outgoing> EmulatedMid70::Advance(std::int64_t now_us) {
  if (reboot_us_ && now_us >= *reboot_us_) PowerCycle(now_us);
  if (connection_ && now_us - connection_->heard_us >= config_.host_timeout_us) {
    ++counts_.host_timeouts;
    Disconnect(now_us);
  }
  std::vector<Outgoing> outgoing;
  if (!connection_) {
    if (now_us < next_broadcast_us_) return outgoing;
    next_broadcast_us_ = now_us + config_.broadcast_period_us;
    const livox::Broadcast body{config_.broadcast_code, livox::DeviceType::kMid70};
    outgoing.push_back(
        Message(config_.announce_to, CommandCode::kBroadcast, livox::PackBody(body)));
    return outgoing;
  }
  if (status_.system != livox::Severity::kOk && now_us >= next_abnormal_us_) {
    next_abnormal_us_ = now_us + kAbnormalPeriod_us;
    Bytes body;
    livox::Append(body, status_code());
    outgoing.push_back(Message(connection_->commands, CommandCode::kAbnormalStatus, body));
  }
  return outgoing;
}

EmulatedMid70::Outgoing EmulatedMid70::Message(const Endpoint& to,
                                               CommandCode code,
                                               ByteView body) {
  return {to, livox::PackCommand(FrameType::kMessage, sequence_++, code, body), code};
}

std::vector<EmulatedMid70::Outgoing> EmulatedMid70::Receive(const Endpoint& from,
                                                            ByteView datagram,
                                                            std::int64_t now_us) {
  const livox::ParsedFrame parsed = livox::ParseFrame(datagram);
  ++counts_.broken[static_cast<std::size_t>(parsed.defect)];
  // It has no network before its first broadcast.
  if (!parsed.frame || now_us < started_us_ + config_.boot_us) return {};
  const ControlFrame& frame = *parsed.frame;
  const CommandCode code = livox::CodeOf(frame);
  if (code == CommandCode::kHandshake && frame.type != FrameType::kMessage) {
    return Greet(from, frame, now_us);
  }
  if (frame.type != FrameType::kCommand) {
    ++counts_.unasked;
    return {};
  }
  if (!connection_ || connection_->commands.ip != from.ip) {
    ++counts_.foreign;
    return {};
  }
  const Endpoint to = connection_->commands;
  const Bytes body = Answer(frame, now_us);
  ++(body.front() == std::byte{0} ? counts_.done : counts_.refused);
  std::vector<Outgoing> outgoing;
  outgoing.push_back({to, livox::PackCommand(FrameType::kAck, frame.sequence, code, body), code});
  return outgoing;
}

std::vector<EmulatedMid70::Outgoing> EmulatedMid70::Greet(const Endpoint& from,
                                                          const ControlFrame& frame,
                                                          std::int64_t now_us) {
  const std::optional<livox::Handshake> handshake = livox::ParseHandshake(frame.data);
  const bool is_done = handshake && Shake(from, *handshake, now_us);
  ++(is_done ? counts_.done : counts_.refused);
  // Who cannot even say where to be answered is answered where it spoke from.
  const bool has_port = handshake && handshake->command_port != 0;
  const Endpoint to{from.ip, has_port ? handshake->command_port : from.port};
  std::vector<Outgoing> outgoing;
  outgoing.push_back({to,
                      livox::PackCommand(FrameType::kAck,
                                         frame.sequence,
                                         CommandCode::kHandshake,
                                         livox::PackByte(is_done ? 0 : 1)),
                      CommandCode::kHandshake});
  return outgoing;
}

bool EmulatedMid70::Shake(const Endpoint& from,
                          const livox::Handshake& handshake,
                          std::int64_t now_us) {
  if (handshake.host_ip == kAnyIpv4 || handshake.host_ip == kBroadcastIpv4) return false;
  if (handshake.command_port == 0 || handshake.data_port == 0) return false;
  const Endpoint commands{from.ip, handshake.command_port};
  const bool is_takeover = connection_ && connection_->commands != commands;
  if (is_takeover && connection_->commands.ip != from.ip && !config_.lets_others_take_over) {
    return false;
  }
  if (is_takeover) ++counts_.takeovers;
  ++counts_.handshakes;
  connection_ = Connection{.commands = commands,
                           .data = {handshake.host_ip, handshake.data_port},
                           .heard_us = now_us,
                           .is_sampling = false};
  return true;
}

Bytes EmulatedMid70::Answer(const ControlFrame& frame, std::int64_t now_us) {
  Bytes body = frame.command_set == 0 ? AnswerGeneral(frame, now_us) : AnswerLidar(frame, now_us);
  if (body.empty()) body = livox::PackByte(1);  // Nothing that it knows, or nothing it can obey.
  return body;
}

Bytes EmulatedMid70::AnswerGeneral(const ControlFrame& frame, std::int64_t now_us) {
  const auto result = [](bool is_done) { return livox::PackByte(is_done ? 0 : 1); };
  switch (livox::CodeOf(frame)) {
    case CommandCode::kDeviceInfo:
      return livox::PackBody(livox::DeviceInfoAck{0, config_.firmware});
    case CommandCode::kHeartbeat:
      return AnswerHeartbeat(now_us);
    case CommandCode::kSampling:
      return result(SetSampling(frame.data));
    case CommandCode::kCoordinates: {
      const std::optional<std::uint8_t> value = livox::ParseByte(frame.data);
      if (!value || *value > 1) return {};
      coordinates_ = static_cast<livox::Coordinates>(*value);
      return result(true);
    }
    case CommandCode::kDisconnect:
      Disconnect(now_us);
      return result(true);
    case CommandCode::kSetIp:
      return result(SetIp(frame.data));
    case CommandCode::kGetIp:
      return AnswerGetIp();
    case CommandCode::kReboot:
      if (frame.data.size() != 2) return {};
      reboot_us_ = now_us + livox::Load<std::uint16_t>(frame.data, 0) * kUsPerMs;
      return result(true);
    case CommandCode::kSetParameter:
      return SetParameter(frame.data);
    case CommandCode::kGetParameter:
      return GetParameters(frame.data);
    case CommandCode::kResetParameters:
      return ResetParameters(frame.data);
    default:
      return {};
  }
}

Bytes EmulatedMid70::AnswerLidar(const ControlFrame& frame, std::int64_t now_us) {
  const auto result = [](bool is_done) { return livox::PackByte(is_done ? 0 : 1); };
  switch (livox::CodeOf(frame)) {
    case CommandCode::kMode:
      return result(SetMode(frame.data, now_us));
    case CommandCode::kSetExtrinsic: {
      const std::optional<livox::Extrinsic> extrinsic = livox::ParseExtrinsic(frame.data);
      if (extrinsic) memory_.extrinsic = *extrinsic;
      return result(extrinsic.has_value());
    }
    case CommandCode::kGetExtrinsic:
      return livox::PackBody(livox::ExtrinsicAck{0, memory_.extrinsic});
    case CommandCode::kSetReturnMode: {
      const std::optional<std::uint8_t> value = livox::ParseByte(frame.data);
      if (!value || *value > 2) return {};
      memory_.return_mode = static_cast<livox::ReturnMode>(*value);
      return result(true);
    }
    case CommandCode::kGetReturnMode: {
      Bytes body = livox::PackByte(0);
      livox::Append(body, static_cast<std::uint8_t>(memory_.return_mode));
      return body;
    }
    case CommandCode::kSetUtcTime:
      return result(SetUtc(frame.data, now_us));
    default:
      return {};
  }
}

Bytes EmulatedMid70::AnswerHeartbeat(std::int64_t now_us) {
  connection_->heard_us = now_us;
  livox::HeartbeatAck ack;
  ack.state = StateAt(now_us);
  ack.progress = status_code();
  if (ack.state == WorkState::kInit && config_.start_up_us > 0) {
    const std::int64_t left_us = measures_from_us_ - now_us;
    const std::int64_t done_us = std::max<std::int64_t>(config_.start_up_us - left_us, 0);
    ack.progress = static_cast<std::uint32_t>(done_us * 100 / config_.start_up_us);
  }
  return livox::PackBody(ack);
}

bool EmulatedMid70::SetSampling(ByteView data) {
  const std::optional<std::uint8_t> value = livox::ParseByte(data);
  if (!value || *value > 1) return false;
  connection_->is_sampling = *value == 1;
  return true;
}

bool EmulatedMid70::SetMode(ByteView data, std::int64_t now_us) {
  const std::optional<std::uint8_t> value = livox::ParseByte(data);
  if (!value || *value < 1 || *value > 3) return false;
  const auto mode = static_cast<WorkState>(*value);  // 1 normal, 2 power saving, 3 standby.
  if (mode == WorkState::kNormal && mode_ != WorkState::kNormal) {
    measures_from_us_ = now_us + config_.start_up_us;
  }
  mode_ = mode;
  return true;
}

bool EmulatedMid70::SetUtc(ByteView data, std::int64_t now_us) {
  if (data.size() != 8) return false;
  // The body is laid out as a GPS stamp.
  const std::optional<std::int64_t> utc_ns = livox::GpsUtcNs(livox::Load<std::uint64_t>(data, 0));
  if (!utc_ns) return false;
  utc_ = UtcTime{*utc_ns, now_us};
  return true;
}

}  // namespace clearway::core
