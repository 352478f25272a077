// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/data_packet.hpp"

namespace clearway::core::livox {
namespace {

constexpr std::int64_t kNsPerHour = 3'600'000'000'000;
constexpr std::int64_t kUsPerHour = 3'600'000'000;

// Days since 1970-01-01 of a Gregorian date. Source: Howard Hinnant, "chrono-compatible low-level
// date algorithms", days_from_civil, for years from 2000 on.
constexpr std::int64_t DaysFromCivil(std::int64_t year, std::int64_t month, std::int64_t day) {
  year -= month <= 2 ? 1 : 0;
  const std::int64_t era = year / 400;
  const std::int64_t year_of_era = year - era * 400;
  const std::int64_t day_of_year = (153 * (month > 2 ? month - 3 : month + 9) + 2) / 5 + day - 1;
  const std::int64_t day_of_era =
      year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
  return era * 146097 + day_of_era - 719468;
}

constexpr std::int64_t DaysInMonth(std::int64_t year, std::int64_t month) {
  const std::int64_t next =
      month == 12 ? DaysFromCivil(year + 1, 1, 1) : DaysFromCivil(year, month + 1, 1);
  return next - DaysFromCivil(year, month, 1);
}

}  // namespace

std::optional<std::int64_t> GpsUtcNs(std::uint64_t timestamp) {
  const auto byte = [timestamp](unsigned i) {
    return static_cast<std::int64_t>((timestamp >> (8U * i)) & 0xFFU);
  };
  const std::int64_t year = 2000 + byte(0);
  const std::int64_t month = byte(1);
  const std::int64_t day = byte(2);
  const std::int64_t hour = byte(3);
  const auto us = static_cast<std::int64_t>(timestamp >> 32U);
  if (month < 1 || month > 12 || day < 1 || day > DaysInMonth(year, month)) return std::nullopt;
  if (hour > 23 || us >= kUsPerHour) return std::nullopt;
  return (DaysFromCivil(year, month, day) * 24 + hour) * kNsPerHour + us * 1000;
}

std::uint64_t ToGpsTimestamp(std::int64_t utc_ns) {
  const std::int64_t hours = utc_ns / kNsPerHour;
  const std::int64_t days = hours / 24;
  std::int64_t year = 2000;
  while (DaysFromCivil(year + 1, 1, 1) <= days) ++year;
  std::int64_t month = 1;
  while (month < 12 && DaysFromCivil(year, month + 1, 1) <= days) ++month;
  const std::int64_t day = days - DaysFromCivil(year, month, 1) + 1;
  const auto us = static_cast<std::uint64_t>(utc_ns % kNsPerHour / 1000);
  return static_cast<std::uint64_t>(year - 2000) | static_cast<std::uint64_t>(month) << 8U |
         static_cast<std::uint64_t>(day) << 16U | static_cast<std::uint64_t>(hours % 24) << 24U |
         us << 32U;
}

}  // namespace clearway::core::livox
