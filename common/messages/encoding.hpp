// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace clearway::messages {

/// Longer messages are not decoded. Far above what any bus carries.
inline constexpr std::size_t kMaxMessageBytes = std::size_t{64} << 20;

/// The bytes of a message as they travel. A string with a NUL inside ends there.
template <typename Message>
[[nodiscard]] std::vector<std::byte> Encode(const Message& message) {
  std::vector<std::byte> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  // On the wire a string ends at its first NUL; getEncodedSize() counts what lies behind it, too.
  const int written = message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max(written, 0)));
  return bytes;
}

/// A message from its bytes. Nothing when the fingerprint is another type's, a length does not fit,
/// or bytes are left over. Never throws on any input; never allocates more than a small multiple of
/// its length.
template <typename Message>
[[nodiscard]] std::optional<Message> Decode(std::span<const std::byte> bytes) {
  if (bytes.size() > kMaxMessageBytes) return std::nullopt;
  const int size = static_cast<int>(bytes.size());
  std::optional<Message> message(std::in_place);
  if (message->decode(bytes.data(), 0, size) != size) return std::nullopt;
  return message;
}

}  // namespace clearway::messages
