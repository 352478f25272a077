// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/commands.hpp"

#include <algorithm>

namespace clearway::core::livox {
namespace {

constexpr std::size_t kCodeBytes = 16;
constexpr std::size_t kBroadcastBytes = kCodeBytes + 3;
constexpr std::size_t kOldHandshakeBytes = 8;
constexpr std::size_t kHandshakeBytes = 10;
constexpr std::size_t kExtrinsicBytes = 24;

void Append(Bytes& bytes, const Extrinsic& extrinsic) {
  for (const float angle : {extrinsic.roll_deg, extrinsic.pitch_deg, extrinsic.yaw_deg}) {
    livox::Append(bytes, angle);
  }
  for (const std::int32_t length : {extrinsic.x_mm, extrinsic.y_mm, extrinsic.z_mm}) {
    livox::Append(bytes, length);
  }
}

bool IsCodeCharacter(char c) {
  return c > ' ' && c <= '~';
}

}  // namespace

const char* CommandName(CommandCode code) {
  switch (code) {
    case CommandCode::kBroadcast:
      return "broadcast";
    case CommandCode::kHandshake:
      return "handshake";
    case CommandCode::kDeviceInfo:
      return "device information";
    case CommandCode::kHeartbeat:
      return "heartbeat";
    case CommandCode::kSampling:
      return "start or stop sampling";
    case CommandCode::kCoordinates:
      return "coordinate system";
    case CommandCode::kDisconnect:
      return "disconnect";
    case CommandCode::kAbnormalStatus:
      return "abnormal status";
    case CommandCode::kSetIp:
      return "set address";
    case CommandCode::kGetIp:
      return "get address";
    case CommandCode::kReboot:
      return "reboot";
    case CommandCode::kSetParameter:
      return "set parameter";
    case CommandCode::kGetParameter:
      return "get parameter";
    case CommandCode::kResetParameters:
      return "reset parameters";
    case CommandCode::kMode:
      return "mode";
    case CommandCode::kSetExtrinsic:
      return "set extrinsic";
    case CommandCode::kGetExtrinsic:
      return "get extrinsic";
    case CommandCode::kSetReturnMode:
      return "set return mode";
    case CommandCode::kGetReturnMode:
      return "get return mode";
    case CommandCode::kSetUtcTime:
      return "set time";
  }
  return "unknown command";
}

Bytes PackCommand(FrameType type, std::uint16_t sequence, CommandCode code, ByteView data) {
  return PackFrame({.type = type,
                    .sequence = sequence,
                    .command_set = SetOf(code),
                    .command_id = IdOf(code),
                    .data = data});
}

const char* DeviceName(DeviceType type) {
  switch (type) {
    case DeviceType::kHub:
      return "Livox Hub";
    case DeviceType::kMid40:
      return "MID-40 or MID-100";
    case DeviceType::kTele15:
      return "Tele-15";
    case DeviceType::kHorizon:
      return "Horizon";
    case DeviceType::kMid70:
      return "MID-70";
    case DeviceType::kAvia:
      return "Avia";
  }
  return "unknown device";
}

std::optional<Broadcast> ParseBroadcast(ByteView data) {
  if (data.size() != kBroadcastBytes) return std::nullopt;
  Broadcast body;
  for (std::size_t i = 0; i < kCodeBytes; ++i) {
    const char c = static_cast<char>(data[i]);
    if (c == '\0') break;
    if (!IsCodeCharacter(c)) return std::nullopt;
    body.broadcast_code += c;
  }
  const std::size_t length = body.broadcast_code.size();
  if (length == 0 || length > Broadcast::kMaxCodeLength) return std::nullopt;
  body.type = static_cast<DeviceType>(data[kCodeBytes]);
  return body;
}

Bytes PackBody(const Broadcast& body) {
  Bytes bytes(kBroadcastBytes);
  const std::size_t length = std::min(body.broadcast_code.size(), Broadcast::kMaxCodeLength);
  std::transform(body.broadcast_code.begin(),
                 body.broadcast_code.begin() + static_cast<std::ptrdiff_t>(length),
                 bytes.begin(),
                 [](char c) { return static_cast<std::byte>(c); });
  bytes[kCodeBytes] = static_cast<std::byte>(body.type);
  return bytes;
}

std::optional<Handshake> ParseHandshake(ByteView data) {
  if (data.size() != kHandshakeBytes && data.size() != kOldHandshakeBytes) return std::nullopt;
  Handshake body;
  // The address stands as it does in memory of the network: the first byte first.
  for (std::size_t i = 0; i < 4; ++i) {
    body.host_ip = body.host_ip << 8U | static_cast<Ipv4>(data[i]);
  }
  body.data_port = Load<std::uint16_t>(data, 4);
  body.command_port = Load<std::uint16_t>(data, 6);
  if (data.size() == kHandshakeBytes) body.imu_port = Load<std::uint16_t>(data, 8);
  return body;
}

Bytes PackBody(const Handshake& body) {
  Bytes bytes;
  for (unsigned shift = 24;; shift -= 8) {
    livox::Append(bytes, static_cast<std::uint8_t>(body.host_ip >> shift & 0xFFU));
    if (shift == 0) break;
  }
  livox::Append(bytes, body.data_port);
  livox::Append(bytes, body.command_port);
  livox::Append(bytes, body.imu_port);
  return bytes;
}

const char* WorkStateName(WorkState state) {
  switch (state) {
    case WorkState::kInit:
      return "starting up";
    case WorkState::kNormal:
      return "normal";
    case WorkState::kPowerSaving:
      return "saving power";
    case WorkState::kStandby:
      return "standing by";
    case WorkState::kError:
      return "in error";
    case WorkState::kUnknown:
      break;
  }
  return "unknown";
}

std::optional<HeartbeatAck> ParseHeartbeatAck(ByteView data) {
  if (data.size() != 7) return std::nullopt;
  const auto state = std::min(Load<std::uint8_t>(data, 1), std::uint8_t{5});
  return HeartbeatAck{.result = Load<std::uint8_t>(data, 0),
                      .state = static_cast<WorkState>(state),
                      .features = Load<std::uint8_t>(data, 2),
                      .progress = Load<std::uint32_t>(data, 3)};
}

Bytes PackBody(const HeartbeatAck& body) {
  Bytes bytes;
  livox::Append(bytes, body.result);
  livox::Append(bytes, static_cast<std::uint8_t>(body.state));
  livox::Append(bytes, body.features);
  livox::Append(bytes, body.progress);
  return bytes;
}

std::optional<DeviceInfoAck> ParseDeviceInfoAck(ByteView data) {
  if (data.size() != 5) return std::nullopt;
  DeviceInfoAck body{.result = Load<std::uint8_t>(data, 0)};
  for (std::size_t i = 0; i < 4; ++i) body.firmware[i] = Load<std::uint8_t>(data, 1 + i);
  return body;
}

Bytes PackBody(const DeviceInfoAck& body) {
  Bytes bytes = PackByte(body.result);
  for (const std::uint8_t part : body.firmware) livox::Append(bytes, part);
  return bytes;
}

std::string FirmwareText(const std::array<std::uint8_t, 4>& firmware) {
  std::string text;
  for (const std::uint8_t part : firmware) {
    if (!text.empty()) text += '.';
    text += std::to_string(part);
  }
  return text;
}

std::optional<Extrinsic> ParseExtrinsic(ByteView data) {
  if (data.size() != kExtrinsicBytes) return std::nullopt;
  return Extrinsic{.roll_deg = Load<float>(data, 0),
                   .pitch_deg = Load<float>(data, 4),
                   .yaw_deg = Load<float>(data, 8),
                   .x_mm = Load<std::int32_t>(data, 12),
                   .y_mm = Load<std::int32_t>(data, 16),
                   .z_mm = Load<std::int32_t>(data, 20)};
}

Bytes PackBody(const Extrinsic& body) {
  Bytes bytes;
  Append(bytes, body);
  return bytes;
}

std::optional<ExtrinsicAck> ParseExtrinsicAck(ByteView data) {
  if (data.size() != 1 + kExtrinsicBytes) return std::nullopt;
  return ExtrinsicAck{.result = Load<std::uint8_t>(data, 0),
                      .extrinsic = *ParseExtrinsic(data.subspan(1))};
}

Bytes PackBody(const ExtrinsicAck& body) {
  Bytes bytes = PackByte(body.result);
  Append(bytes, body.extrinsic);
  return bytes;
}

std::optional<std::uint8_t> ParseByte(ByteView data) {
  if (data.size() != 1) return std::nullopt;
  return Load<std::uint8_t>(data, 0);
}

Bytes PackByte(std::uint8_t value) {
  return Bytes{static_cast<std::byte>(value)};
}

}  // namespace clearway::core::livox
