// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace clearway::core::livox {

using Bytes = std::vector<std::byte>;
using ByteView = std::span<const std::byte>;

namespace internal {
template <typename T>
using BitsOf = std::conditional_t<
    sizeof(T) == 1,
    std::uint8_t,
    std::conditional_t<sizeof(T) == 2,
                       std::uint16_t,
                       std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;
}  // namespace internal

/// The little-endian number at `offset`, on a machine of any byte order.
/// @pre offset + sizeof(T) <= bytes.size().
template <typename T>
requires std::is_arithmetic_v<T>
[[nodiscard]] T Load(ByteView bytes, std::size_t offset) {
  using Bits = internal::BitsOf<T>;
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    value |= static_cast<std::uint64_t>(bytes[offset + i]) << (8U * i);
  }
  return std::bit_cast<T>(static_cast<Bits>(value));
}

/// Puts a number there, the lowest byte first. @pre offset + sizeof(T) <= bytes.size().
template <typename T>
requires std::is_arithmetic_v<T>
void Store(std::span<std::byte> bytes, std::size_t offset, T value) {
  const auto bits = static_cast<std::uint64_t>(std::bit_cast<internal::BitsOf<T>>(value));
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes[offset + i] = static_cast<std::byte>((bits >> (8U * i)) & 0xFFU);
  }
}

/// Appends a number, the lowest byte first.
template <typename T>
requires std::is_arithmetic_v<T>
void Append(Bytes& bytes, T value) {
  bytes.resize(bytes.size() + sizeof(T));
  Store(std::span(bytes), bytes.size() - sizeof(T), value);
}

}  // namespace clearway::core::livox
