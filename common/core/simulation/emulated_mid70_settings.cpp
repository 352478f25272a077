// SPDX-License-Identifier: BSD-3-Clause
// Of EmulatedMid70: its address and its parameters.
#include <algorithm>

#include "common/core/simulation/emulated_mid70.hpp"

namespace clearway::core {
namespace {

using livox::Bytes;
using livox::ByteView;

constexpr std::uint16_t kSlotKey = 3;
constexpr std::uint8_t kDefaultSlot = 1;
constexpr std::uint8_t kMaxSlot = 9;
constexpr std::size_t kSetIpBytes = 13;

// As addresses stand on the network: the first byte first.
Ipv4 LoadIp(ByteView data, std::size_t offset) {
  Ipv4 ip = 0;
  for (std::size_t i = 0; i < 4; ++i) ip = ip << 8U | static_cast<Ipv4>(data[offset + i]);
  return ip;
}

void AppendIp(Bytes& bytes, Ipv4 ip) {
  for (unsigned shift = 32; shift > 0; shift -= 8) {
    bytes.push_back(static_cast<std::byte>(ip >> (shift - 8U) & 0xFFU));
  }
}

// Result, the key that is wrong, and why; all 0 when all is well.
Bytes ParameterResult(bool is_done, std::uint16_t key) {
  Bytes body = livox::PackByte(is_done ? 0 : 1);
  livox::Append(body, is_done ? std::uint16_t{0} : key);
  livox::Append(body, static_cast<std::uint8_t>(is_done ? 0 : 1));
  return body;
}

// The keys in a body: how many, then each; nothing when it is not that long.
std::optional<std::vector<std::uint16_t>> ParseKeys(ByteView data) {
  if (data.empty()) return std::nullopt;
  const auto count = static_cast<std::size_t>(data[0]);
  if (data.size() != 1 + 2 * count) return std::nullopt;
  std::vector<std::uint16_t> keys;
  for (std::size_t i = 0; i < count; ++i) {
    keys.push_back(livox::Load<std::uint16_t>(data, 1 + 2 * i));
  }
  return keys;
}

// The first key that a MID-70 does not have.
std::optional<std::uint16_t> UnknownOf(const std::vector<std::uint16_t>& keys) {
  const auto unknown =
      std::find_if(keys.begin(), keys.end(), [](std::uint16_t key) { return key != kSlotKey; });
  if (unknown == keys.end()) return std::nullopt;
  return *unknown;
}

}  // namespace

bool EmulatedMid70::SetIp(ByteView data) {
  if (data.size() != kSetIpBytes || data[0] > std::byte{1}) return false;
  const bool is_static = data[0] == std::byte{1};
  const Ipv4 ip = LoadIp(data, 1);
  if (is_static && (ip == kAnyIpv4 || ip == kBroadcastIpv4)) return false;
  memory_.has_static_ip = is_static;
  // Without a server that gives addresses, a dynamic one is the one that it has.
  if (!is_static) return true;
  memory_.ip = ip;
  memory_.mask = LoadIp(data, 5);
  memory_.gateway = LoadIp(data, 9);
  return true;
}

Bytes EmulatedMid70::AnswerGetIp() const {
  Bytes body = livox::PackByte(0);
  livox::Append(body, static_cast<std::uint8_t>(memory_.has_static_ip ? 1 : 0));
  for (const Ipv4 ip : {memory_.ip, memory_.mask, memory_.gateway}) AppendIp(body, ip);
  return body;
}

Bytes EmulatedMid70::SetParameter(ByteView data) {
  if (data.size() < 4) return ParameterResult(false, 0);
  const auto key = livox::Load<std::uint16_t>(data, 0);
  const auto length = livox::Load<std::uint16_t>(data, 2);
  const bool is_slot = key == kSlotKey && length == 1 && data.size() == 5;
  const auto slot = static_cast<std::uint8_t>(is_slot ? data[4] : std::byte{0});
  if (slot < 1 || slot > kMaxSlot) return ParameterResult(false, key);
  memory_.slot = slot;
  return ParameterResult(true, key);
}

Bytes EmulatedMid70::GetParameters(ByteView data) const {
  const std::optional<std::vector<std::uint16_t>> keys = ParseKeys(data);
  if (!keys || keys->empty()) return ParameterResult(false, 0);
  if (const auto unknown = UnknownOf(*keys)) return ParameterResult(false, *unknown);
  Bytes body = ParameterResult(true, 0);
  for (const std::uint16_t key : *keys) {
    livox::Append(body, key);
    livox::Append(body, std::uint16_t{1});
    livox::Append(body, memory_.slot);
  }
  return body;
}

Bytes EmulatedMid70::ResetParameters(ByteView data) {
  if (data.size() < 2 || data[0] > std::byte{1}) return ParameterResult(false, 0);
  const std::optional<std::vector<std::uint16_t>> keys = ParseKeys(data.subspan(1));
  if (!keys) return ParameterResult(false, 0);
  if (const auto unknown = UnknownOf(*keys)) return ParameterResult(false, *unknown);
  if (data[0] == std::byte{0} || !keys->empty()) memory_.slot = kDefaultSlot;
  return ParameterResult(true, 0);
}

}  // namespace clearway::core
