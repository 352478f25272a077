// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/scan_stamp.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>

namespace clearway::io {

namespace {

constexpr std::size_t kMicroDigits = 6;
constexpr std::size_t kMinMicrosecondDigits = 14;
constexpr std::size_t kMinNanosecondDigits = 17;
constexpr std::size_t kMaxNanosecondDigits = 19;
constexpr std::size_t kMaxSecondDigits = 12;
constexpr std::size_t kMaxFractionDigits = 18;

bool IsDigits(std::string_view text, std::size_t least, std::size_t most) {
  return text.size() >= least && text.size() <= most &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// @pre at most 18 digits, nothing else.
std::int64_t Value(std::string_view digits) {
  std::int64_t value = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return value;
}

}  // namespace

std::optional<std::int64_t> ParseScanStamp(std::string_view stem) {
  const std::string_view text = stem.substr(stem.rfind('_') + 1);
  const std::size_t point = text.find('.');
  if (point == text.npos) {
    if (!IsDigits(text, kMinMicrosecondDigits, kMaxNanosecondDigits)) return std::nullopt;
    return Value(text.size() < kMinNanosecondDigits ? text : text.substr(0, text.size() - 3));
  }
  const std::string_view seconds = text.substr(0, point);
  const std::string_view fraction = text.substr(point + 1);
  if (!IsDigits(seconds, 1, kMaxSecondDigits) || !IsDigits(fraction, 1, kMaxFractionDigits)) {
    return std::nullopt;
  }
  std::int64_t microseconds = Value(fraction.substr(0, kMicroDigits));
  for (std::size_t i = fraction.size(); i < kMicroDigits; ++i) microseconds *= 10;
  return Value(seconds) * 1'000'000 + microseconds;
}

}  // namespace clearway::io
