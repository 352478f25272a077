// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/lvx/lvx_format.hpp"

#include <algorithm>
#include <cassert>
#include <set>
#include <string_view>

#include "common/io/read_error.hpp"

namespace clearway::io::lvx {
namespace {

using core::livox::Append;
using core::livox::Bytes;
using core::livox::ByteView;
using core::livox::Load;

constexpr std::string_view kSignature{"livox_tech\0\0\0\0\0\0", 16};
constexpr std::size_t kVersionByte = 16;
constexpr std::size_t kMagicByte = 20;
constexpr std::size_t kCodeBytes = 16;

std::string TextAt(ByteView bytes, std::size_t offset, std::size_t length) {
  std::string text;
  for (std::size_t i = 0; i < length && bytes[offset + i] != std::byte{0}; ++i) {
    text += static_cast<char>(bytes[offset + i]);
  }
  return text;
}

void AppendCode(Bytes& bytes, const std::string& code) {
  assert(code.size() <= kCodeBytes);
  for (const char c : code) Append(bytes, c);
  bytes.resize(bytes.size() + kCodeBytes - code.size());
}

std::string Hex(std::uint32_t value) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text = "0x";
  for (unsigned shift = 32; shift > 0; shift -= 4) text += kDigits[(value >> (shift - 4)) & 0xFU];
  return text;
}

void RequireBytes(ByteView bytes, std::size_t count, const std::string& file) {
  if (bytes.size() >= count) return;
  throw ErrorAtByte(
      file,
      bytes.size(),
      "the file ends inside its header, which has " + std::to_string(count) + " bytes so far");
}

LvxVersion ParseVersion(ByteView bytes, const std::string& file) {
  std::string signature;
  for (std::size_t i = 0; i < kSignature.size(); ++i) signature += static_cast<char>(bytes[i]);
  if (signature != kSignature) {
    throw ErrorAtByte(
        file, 0, "begins with " + Quoted(signature) + "; an LVX file begins with \"livox_tech\"");
  }
  const auto major = Load<std::uint8_t>(bytes, kVersionByte);
  const auto minor = Load<std::uint8_t>(bytes, kVersionByte + 1);
  if (major != 1 || minor > 1) {
    throw ErrorAtByte(file,
                      kVersionByte,
                      "LVX version " + std::to_string(major) + "." + std::to_string(minor) +
                          "; 1.0 and 1.1 are read");
  }
  const auto magic = Load<std::uint32_t>(bytes, kMagicByte);
  if (magic != kMagic) {
    throw ErrorAtByte(file, kMagicByte, "magic number " + Hex(magic) + "; expected " + Hex(kMagic));
  }
  return minor == 0 ? LvxVersion::k1_0 : LvxVersion::k1_1;
}

LvxDevice DeviceAt(ByteView bytes, std::size_t offset, LvxVersion version) {
  LvxDevice device{.lidar_code = TextAt(bytes, offset, kCodeBytes),
                   .hub_code = TextAt(bytes, offset + kCodeBytes, kCodeBytes)};
  offset += 2 * kCodeBytes;
  device.index = Load<std::uint8_t>(bytes, offset++);
  device.type = static_cast<core::livox::DeviceType>(bytes[offset++]);
  if (version == LvxVersion::k1_1) device.extrinsic_enabled = bytes[offset++] != std::byte{0};
  for (float* value : {&device.roll_deg,
                       &device.pitch_deg,
                       &device.yaw_deg,
                       &device.x_m,
                       &device.y_m,
                       &device.z_m}) {
    *value = Load<float>(bytes, offset);
    offset += sizeof(float);
  }
  return device;
}

}  // namespace

Sizes SizesOf(LvxVersion version) {
  if (version == LvxVersion::k1_0) return {.file_header = 25, .device = 58, .frame_header = 32};
  return {.file_header = 29, .device = 59, .frame_header = 24};
}

std::optional<std::size_t> PackageBytes(LvxVersion version, std::uint8_t data_type) {
  constexpr std::array<std::size_t, 3> kForeignBytes{24, 30 * 42, 30 * 22};  // Types 6, 7, 8.
  if (data_type >= 6 + kForeignBytes.size()) return std::nullopt;
  if (version == LvxVersion::k1_0) return kPackageHeadBytes + kFloatPoints * kFloatPointBytes;
  if (const auto layout = core::livox::LayoutOf(data_type)) {
    return kPackageHeadBytes + layout->shots_in_packet * layout->shot_bytes;
  }
  return kPackageHeadBytes + kForeignBytes[data_type - 6U];
}

Bytes PackHeader(const LvxHeader& header) {
  assert(header.devices.size() <= 255);
  Bytes bytes;
  for (const char c : kSignature) Append(bytes, c);
  for (const int part : {1, 1, 0, 0}) Append(bytes, static_cast<std::uint8_t>(part));
  Append(bytes, kMagic);
  Append(bytes, header.frame_duration_ms);
  Append(bytes, static_cast<std::uint8_t>(header.devices.size()));
  for (const LvxDevice& device : header.devices) {
    AppendCode(bytes, device.lidar_code);
    AppendCode(bytes, device.hub_code);
    Append(bytes, device.index);
    Append(bytes, static_cast<std::uint8_t>(device.type));
    Append(bytes, static_cast<std::uint8_t>(device.extrinsic_enabled ? 1 : 0));
    for (const float value :
         {device.roll_deg, device.pitch_deg, device.yaw_deg, device.x_m, device.y_m, device.z_m}) {
      Append(bytes, value);
    }
  }
  return bytes;
}

ParsedHeader ParseHeader(ByteView bytes, const std::string& file) {
  RequireBytes(bytes, kPublicHeaderBytes, file);
  ParsedHeader parsed;
  parsed.header.version = ParseVersion(bytes, file);
  const Sizes sizes = SizesOf(parsed.header.version);
  RequireBytes(bytes, sizes.file_header, file);
  if (parsed.header.version == LvxVersion::k1_1) {
    parsed.header.frame_duration_ms = Load<std::uint32_t>(bytes, kPublicHeaderBytes);
  }
  const auto count = Load<std::uint8_t>(bytes, sizes.file_header - 1);
  if (count == 0) throw ErrorAtByte(file, sizes.file_header - 1, "lists no device");
  parsed.bytes = sizes.file_header + count * sizes.device;
  RequireBytes(bytes, parsed.bytes, file);
  std::set<std::uint8_t> indices;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t offset = sizes.file_header + i * sizes.device;
    parsed.header.devices.push_back(DeviceAt(bytes, offset, parsed.header.version));
    const std::uint8_t index = parsed.header.devices.back().index;
    if (!indices.insert(index).second) {
      throw ErrorAtByte(
          file, offset + 2 * kCodeBytes, "lists two devices with index " + std::to_string(index));
    }
  }
  return parsed;
}

}  // namespace clearway::io::lvx
