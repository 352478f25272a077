// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace clearway::host {

/// Time of all processors since the host's start [ticks].
struct CpuTimes {
  std::uint64_t busy = 0;
  std::uint64_t total = 0;
};

struct HostMemory {
  std::int64_t total_bytes = 0;
  std::int64_t free_bytes = 0;  ///< What programs can have: with the caches that would make room.
  std::int64_t swap_total_bytes = 0;
  std::int64_t swap_free_bytes = 0;
};

/// The first line of /proc/stat. Waiting for a disk is not busy. Nothing when it is not whole.
[[nodiscard]] std::optional<CpuTimes> ParseCpuTimes(std::string_view text);

/// /proc/meminfo. Nothing when one of the four is missing.
[[nodiscard]] std::optional<HostMemory> ParseMemInfo(std::string_view text);

/// How busy the host is.
class HostLoad {
 public:
  struct Reading {
    float cpu_load = -1.0F;  ///< Share of all processors since the last sample, 0 to 1; -1: none.
    HostMemory memory;       ///< All 0 when it cannot be read.
  };

  /// Two samples within one tick (10 ms) of all processors give the same load.
  [[nodiscard]] Reading Sample();

 private:
  std::optional<CpuTimes> last_;
  float last_load_ = -1.0F;
};

}  // namespace clearway::host
