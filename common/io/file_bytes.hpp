// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>

namespace clearway::io {

/// The largest file that is read as a whole [bytes]; a robot's computer has 4 GB of memory.
inline constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 31U;

/// The whole content of a regular file. Throws ReadError when there is none, when the system does
/// not let it be read, when it is larger than kMaxFileBytes, or when it is empty.
[[nodiscard]] std::string ReadFileBytes(const std::filesystem::path& path);

/// A little-endian number at `bytes`, which need not be aligned.
/// @pre sizeof(T) bytes can be read.
template <typename T>
[[nodiscard]] T LoadLittleEndian(const char* bytes) {
  static_assert(std::endian::native == std::endian::little, "a big-endian host needs a swap here");
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

}  // namespace clearway::io
