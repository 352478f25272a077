// SPDX-License-Identifier: BSD-3-Clause
#include "common/config/values.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <system_error>

namespace clearway::config::internal {
namespace {

constexpr std::size_t kLongestShown = 60;

/// Digits of a degree value that somebody wrote by hand, at most.
constexpr int kWrittenDigits = 9;

/// Digits that tell all doubles apart.
constexpr int kAllDigits = 17;

/// The rule of two units in the last place has no sense among the last few doubles before 0.
constexpr double kLeastAngleRad = 1e-300;

/// 31 years. Well beyond this a double does not tell one microsecond from the next.
constexpr double kLargestMilliseconds = 1e12;

template <typename T>
std::optional<T> ParseWhole(std::string_view text) {
  T value{};
  const char* const end = text.data() + text.size();
  const std::from_chars_result result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return value;
}

template <typename... Format>
std::string ToText(double value, Format... format) {
  // -DBL_MAX in fixed notation has 310 characters.
  std::array<char, 400> buffer{};
  char* const end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format...).ptr;
  return {buffer.data(), end};
}

bool IsControl(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x20 || byte == 0x7f;
}

bool IsWithinTwoUlp(double a, double b) {
  if (std::abs(b) < kLeastAngleRad) return a == b;
  const double infinity = std::numeric_limits<double>::infinity();
  const double low = std::nextafter(std::nextafter(b, -infinity), -infinity);
  const double high = std::nextafter(std::nextafter(b, infinity), infinity);
  return low <= a && a <= high;
}

}  // namespace

std::optional<double> ParseNumber(std::string_view text) {
  const std::optional<double> value = ParseWhole<double>(text);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return *value == 0.0 ? 0.0 : *value;
}

std::optional<int> ParseInteger(std::string_view text) {
  return ParseWhole<int>(text);
}

std::optional<std::int64_t> ParseMilliseconds(std::string_view text) {
  const std::optional<double> time_ms = ParseNumber(text);
  if (!time_ms || std::abs(*time_ms) > kLargestMilliseconds) return std::nullopt;
  const std::int64_t time_us = std::llround(*time_ms * 1000.0);
  // The quotient is the double nearest to the decimal, just as the parsed text is.
  if (static_cast<double>(time_us) / 1000.0 != *time_ms) return std::nullopt;
  return time_us;
}

std::string FormatNumber(double value) {
  const double magnitude = std::abs(value);
  const bool reads_well_as_fixed = magnitude >= 1e-5 && magnitude < 1e10;
  if (magnitude == 0.0) return "0";
  return reads_well_as_fixed ? ToText(value, std::chars_format::fixed) : ToText(value);
}

std::string FormatMilliseconds(std::int64_t time_us) {
  return FormatNumber(static_cast<double>(time_us) / 1000.0);
}

double RadFromDeg(double angle_deg) {
  return angle_deg * std::numbers::pi / 180.0;
}

std::string FormatDegrees(double angle_rad) {
  const double angle_deg = angle_rad / std::numbers::pi * 180.0;
  if (!std::isfinite(angle_deg)) return FormatNumber(angle_deg);
  for (int digits = 1; digits <= kAllDigits; ++digits) {
    const std::optional<double> rounded =
        ParseNumber(ToText(angle_deg, std::chars_format::general, digits));
    if (!rounded) continue;
    const double rounded_rad = RadFromDeg(*rounded);
    const bool is_meant = digits <= kWrittenDigits && IsWithinTwoUlp(rounded_rad, angle_rad);
    if (is_meant || rounded_rad == angle_rad) return FormatNumber(*rounded);
  }
  const double infinity = std::numeric_limits<double>::infinity();
  const double above = std::nextafter(angle_deg, infinity);
  const double below = std::nextafter(angle_deg, -infinity);
  for (const double candidate :
       {above, below, std::nextafter(above, infinity), std::nextafter(below, -infinity)}) {
    if (RadFromDeg(candidate) == angle_rad) return FormatNumber(candidate);
  }
  return FormatNumber(angle_deg);
}

double ToCanonicalRad(double angle_deg) {
  const double angle_rad = RadFromDeg(angle_deg);
  return RadFromDeg(ParseNumber(FormatDegrees(angle_rad)).value_or(angle_deg));
}

bool IsPlainText(std::string_view text) {
  return std::none_of(text.begin(), text.end(), IsControl);
}

std::string Quote(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

std::optional<std::string> Unquote(std::string_view text) {
  if (text.size() < 2 || text.front() != '"' || text.back() != '"') return std::nullopt;
  std::string plain;
  for (std::size_t i = 1; i + 1 < text.size(); ++i) {
    if (text[i] == '"') return std::nullopt;
    if (text[i] == '\\') {
      ++i;
      if (i + 1 == text.size() || (text[i] != '"' && text[i] != '\\')) return std::nullopt;
    }
    plain += text[i];
  }
  return plain;
}

std::string Shown(std::string_view text) {
  constexpr std::string_view kHexDigits = "0123456789abcdef";
  std::size_t size = std::min(text.size(), kLongestShown);
  // Not in the middle of a UTF-8 sequence.
  while (size > 0 && size < text.size() &&
         (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U)
    --size;
  std::string shown;
  for (const char c : text.substr(0, size)) {
    if (!IsControl(c)) {
      shown += c;
      continue;
    }
    const auto byte = static_cast<unsigned char>(c);
    shown += "\\x";
    shown += kHexDigits[byte >> 4U];
    shown += kHexDigits[byte & 0xFU];
  }
  return size < text.size() ? shown + "..." : shown;
}

std::string Concat(std::initializer_list<std::string_view> parts) {
  std::string text;
  for (const std::string_view part : parts) text += part;
  return text;
}

std::string_view Trim(std::string_view text) {
  constexpr std::string_view kWhiteSpace = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kWhiteSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kWhiteSpace) - first + 1);
}

}  // namespace clearway::config::internal
