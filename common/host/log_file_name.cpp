// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/log_file_name.hpp"

#include <cstdint>

namespace clearway::host {
namespace {

constexpr std::size_t kMaxBytes = 200;
constexpr std::size_t kKeptBytes = 160;
constexpr const char* kDigits = "0123456789ABCDEF";

__extension__ using Uint128 = unsigned __int128;

// Source: FNV-1a of 128 bits, draft-eastlake-fnv, section 5.
std::string HashOf(std::string_view text) {
  constexpr Uint128 kPrime = (Uint128{1} << 88U) + 0x13B;
  Uint128 hash = (Uint128{0x6C62272E07BB0142} << 64U) + 0x62B821756295C58D;
  for (const char c : text) hash = (hash ^ static_cast<std::uint8_t>(c)) * kPrime;
  std::string digits;
  for (int shift = 124; shift >= 0; shift -= 4) digits += kDigits[(hash >> shift) & 15U];
  return digits;
}

bool IsKept(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

}  // namespace

std::string FileNameOf(std::string_view command_id) {
  std::string name;
  for (const char c : command_id) {
    if (IsKept(c) || (c == '.' && !name.empty())) {
      name += c;
      continue;
    }
    const auto byte = static_cast<std::uint8_t>(c);
    name += {'%', kDigits[byte >> 4U], kDigits[byte & 15U]};
  }
  // Neither a lone % nor %- is the code of a byte.
  if (name.empty()) name = "%";
  if (name.size() > kMaxBytes) name = name.substr(0, kKeptBytes) + "%-" + HashOf(command_id);
  return name + ".log";
}

}  // namespace clearway::host
