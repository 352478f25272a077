// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "common/core/endpoint.hpp"
#include "common/core/livox/control_frame.hpp"

namespace clearway::core::livox {

/// Set and id of a command in one number: 0x0106 is set 1, id 6.
enum class CommandCode : std::uint16_t {
  kBroadcast = 0x0000,
  kHandshake = 0x0001,
  kDeviceInfo = 0x0002,
  kHeartbeat = 0x0003,
  kSampling = 0x0004,
  kCoordinates = 0x0005,
  kDisconnect = 0x0006,
  kAbnormalStatus = 0x0007,
  kSetIp = 0x0008,
  kGetIp = 0x0009,
  kReboot = 0x000A,
  kSetParameter = 0x000B,
  kGetParameter = 0x000C,
  kResetParameters = 0x000D,
  kMode = 0x0100,
  kSetExtrinsic = 0x0101,
  kGetExtrinsic = 0x0102,
  kSetReturnMode = 0x0106,
  kGetReturnMode = 0x0107,
  kSetUtcTime = 0x010A,
};
[[nodiscard]] inline CommandCode CodeOf(const ControlFrame& frame) {
  return static_cast<CommandCode>(frame.command_set << 8U | frame.command_id);
}
[[nodiscard]] inline std::uint8_t SetOf(CommandCode code) {
  return static_cast<std::uint8_t>(static_cast<std::uint16_t>(code) >> 8U);
}
[[nodiscard]] inline std::uint8_t IdOf(CommandCode code) {
  return static_cast<std::uint8_t>(static_cast<std::uint16_t>(code) & 0xFFU);
}
/// In words: "handshake", "set return mode", ...
[[nodiscard]] const char* CommandName(CommandCode code);

/// The bytes of a frame with this command.
[[nodiscard]] Bytes PackCommand(FrameType type,
                                std::uint16_t sequence,
                                CommandCode code,
                                ByteView data);

/// What kind of sensor announces itself.
enum class DeviceType : std::uint8_t {
  kHub = 0,
  kMid40 = 1,  ///< And MID-100.
  kTele15 = 2,
  kHorizon = 3,
  kMid70 = 6,
  kAvia = 7
};
/// "MID-70", ...; "unknown device" for other values.
[[nodiscard]] const char* DeviceName(DeviceType type);

/// Body of kBroadcast: a sensor that nobody is connected to says who it is, about once a second.
struct Broadcast {
  static constexpr std::size_t kMaxCodeLength = 15;
  std::string broadcast_code;  ///< Printable, without blanks, at most kMaxCodeLength characters.
  DeviceType type = DeviceType::kMid70;
};
/// Nothing unless the body has exactly its length and a code as described.
[[nodiscard]] std::optional<Broadcast> ParseBroadcast(ByteView data);
[[nodiscard]] Bytes PackBody(const Broadcast& body);

/// Body of the command kHandshake: where the host wants to be answered.
struct Handshake {
  Ipv4 host_ip = kAnyIpv4;
  std::uint16_t data_port = 0;
  std::uint16_t command_port = 0;
  std::uint16_t imu_port = 0;  ///< 0 in the old form without it.
};
/// 10 bytes, or the old form of 8.
[[nodiscard]] std::optional<Handshake> ParseHandshake(ByteView data);
[[nodiscard]] Bytes PackBody(const Handshake& body);

/// What a sensor is doing.
enum class WorkState : std::uint8_t {
  kInit = 0,
  kNormal = 1,
  kPowerSaving = 2,
  kStandby = 3,
  kError = 4,
  kUnknown = 5
};
[[nodiscard]] const char* WorkStateName(WorkState state);

/// Body of the acknowledgement of kHeartbeat.
struct HeartbeatAck {
  std::uint8_t result = 0;
  WorkState state = WorkState::kUnknown;
  std::uint8_t features = 0;   ///< Bit 0: rain and fog suppression.
  std::uint32_t progress = 0;  ///< Status code; while initialising: 0..100 %.
};
[[nodiscard]] std::optional<HeartbeatAck> ParseHeartbeatAck(ByteView data);
[[nodiscard]] Bytes PackBody(const HeartbeatAck& body);

/// Body of the acknowledgement of kDeviceInfo.
struct DeviceInfoAck {
  std::uint8_t result = 0;
  std::array<std::uint8_t, 4> firmware{};
};
[[nodiscard]] std::optional<DeviceInfoAck> ParseDeviceInfoAck(ByteView data);
[[nodiscard]] Bytes PackBody(const DeviceInfoAck& body);
/// "10.3.0.1"
[[nodiscard]] std::string FirmwareText(const std::array<std::uint8_t, 4>& firmware);

/// Where the sensor believes to be mounted, as it keeps it: body of kSetExtrinsic, and, after the
/// result, of the acknowledgement of kGetExtrinsic. Rotation as in FromRpy().
struct Extrinsic {
  float roll_deg = 0.0F;
  float pitch_deg = 0.0F;
  float yaw_deg = 0.0F;
  std::int32_t x_mm = 0;
  std::int32_t y_mm = 0;
  std::int32_t z_mm = 0;
  friend bool operator==(const Extrinsic&, const Extrinsic&) = default;
};
[[nodiscard]] std::optional<Extrinsic> ParseExtrinsic(ByteView data);
[[nodiscard]] Bytes PackBody(const Extrinsic& body);

struct ExtrinsicAck {
  std::uint8_t result = 0;
  Extrinsic extrinsic;
};
[[nodiscard]] std::optional<ExtrinsicAck> ParseExtrinsicAck(ByteView data);
[[nodiscard]] Bytes PackBody(const ExtrinsicAck& body);

/// Which echoes of a shot are sent.
enum class ReturnMode : std::uint8_t { kFirst = 0, kStrongest = 1, kDual = 2 };

/// The one byte that several commands and acknowledgements consist of: a result, a mode, a switch.
[[nodiscard]] std::optional<std::uint8_t> ParseByte(ByteView data);
[[nodiscard]] Bytes PackByte(std::uint8_t value);

}  // namespace clearway::core::livox
