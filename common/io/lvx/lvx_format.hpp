// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/livox/commands.hpp"
#include "common/core/livox/data_packet.hpp"

namespace clearway::io {

/// The two versions of an LVX file. LVX 2 holds data of sensors that speak another protocol.
enum class LvxVersion : std::uint8_t { k1_0, k1_1 };

/// A sensor of a recording.
struct LvxDevice {
  std::string lidar_code = {};  ///< Its broadcast code, at most 16 characters.
  std::string hub_code = {};    ///< Of the hub that it hung on; empty without one.
  std::uint8_t index = 0;       ///< Packages name it by this, not by its place in the list.
  core::livox::DeviceType type = core::livox::DeviceType::kMid70;
  bool extrinsic_enabled = false;  ///< Whether a player should apply what follows.
  float roll_deg = 0.0F;           ///< Rotation as in FromRpy().
  float pitch_deg = 0.0F;
  float yaw_deg = 0.0F;
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
  friend bool operator==(const LvxDevice&, const LvxDevice&) = default;
};

/// What a file says before its first frame.
struct LvxHeader {
  LvxVersion version = LvxVersion::k1_1;
  std::uint32_t frame_duration_ms = 50;  ///< Nominal; version 1.0 does not state it.
  std::vector<LvxDevice> devices;        ///< At least one, each index once.
  friend bool operator==(const LvxHeader&, const LvxHeader&) = default;
};

namespace lvx {

inline constexpr std::uint32_t kMagic = 0xAC0EA767;
inline constexpr std::size_t kPublicHeaderBytes = 24;
inline constexpr std::size_t kPackageHeadBytes = 1 + core::livox::kDataHeaderBytes;
inline constexpr std::size_t kFloatPoints = 100;  ///< Of a package of version 1.0.
inline constexpr std::size_t kFloatPointBytes = 13;
inline constexpr std::size_t kMaxPackageBytes = 1400;

/// Bytes before the list of devices, of one device, of a frame's header.
struct Sizes {
  std::size_t file_header = 0;
  std::size_t device = 0;
  std::size_t frame_header = 0;
};
[[nodiscard]] Sizes SizesOf(LvxVersion version);

/// Bytes of a package with its head, by the data type that it states: no length is stored, packets
/// are always full. Types of other sensors (IMU, triple returns) have sizes, too. Nothing where the
/// type is none.
[[nodiscard]] std::optional<std::size_t> PackageBytes(LvxVersion version, std::uint8_t data_type);

/// The header of a file of version 1.1, up to its first frame.
/// @pre at most 255 devices; codes of at most 16 characters.
[[nodiscard]] core::livox::Bytes PackHeader(const LvxHeader& header);

/// The header and what it takes. `bytes` is the start of a file, as much of it as there is or
/// kMaxHeaderBytes. Throws ReadError with the byte; `file` is the name for messages.
struct ParsedHeader {
  LvxHeader header;
  std::size_t bytes = 0;
};
inline constexpr std::size_t kMaxHeaderBytes = 29 + 255 * 59;
[[nodiscard]] ParsedHeader ParseHeader(core::livox::ByteView bytes, const std::string& file);

}  // namespace lvx
}  // namespace clearway::io
