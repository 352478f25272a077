// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <initializer_list>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/livox/data_packet.hpp"
#include "common/core/livox/little_endian.hpp"

namespace clearway::test {

using core::livox::Bytes;
using core::livox::ByteView;

/// "aa 01 0F" and "AA010F" alike.
inline Bytes FromHex(std::string_view text) {
  std::string digits;
  std::copy_if(text.begin(), text.end(), std::back_inserter(digits), [](unsigned char c) {
    return std::isxdigit(c) != 0;
  });
  if (digits.size() % 2 != 0) throw std::invalid_argument("odd number of hex digits");
  Bytes bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    bytes.push_back(static_cast<std::byte>(std::stoul(digits.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

inline Bytes FromText(std::string_view text) {
  Bytes bytes;
  for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
  return bytes;
}

inline std::uint32_t Random(std::mt19937& random, std::uint32_t below) {
  return static_cast<std::uint32_t>(random() % below);
}

inline Bytes RandomBytes(std::mt19937& random, std::size_t count) {
  Bytes bytes(count);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(Random(random, 256));
  return bytes;
}

/// Points within 200 m, a tenth of them without a return.
inline std::vector<core::livox::WirePoint> RandomPoints(std::mt19937& random, std::size_t count) {
  const auto coordinate = [&random] {
    return static_cast<std::int32_t>(Random(random, 400'001)) - 200'000;
  };
  std::vector<core::livox::WirePoint> points(count);
  for (core::livox::WirePoint& point : points) {
    if (Random(random, 10) == 0) continue;
    point = {.x_mm = coordinate(),
             .y_mm = coordinate(),
             .z_mm = coordinate(),
             .reflectivity = static_cast<std::uint8_t>(Random(random, 256)),
             .tag = static_cast<std::uint8_t>(Random(random, 256))};
  }
  return points;
}

}  // namespace clearway::test
