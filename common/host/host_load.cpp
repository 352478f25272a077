// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/host_load.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fcntl.h>

#include "common/host/proc_file.hpp"

namespace clearway::host {
namespace {

// A number behind blanks, with something behind it: else it may be cut.
std::optional<std::uint64_t> TakeNumber(std::string_view& rest) {
  const std::size_t begin = rest.find_first_not_of(' ');
  if (begin == std::string_view::npos) return std::nullopt;
  std::uint64_t number = 0;
  const char* const end = rest.data() + rest.size();
  const auto result = std::from_chars(rest.data() + begin, end, number);
  if (result.ec != std::errc() || result.ptr == end) return std::nullopt;
  rest.remove_prefix(static_cast<std::size_t>(result.ptr - rest.data()));
  return number;
}

std::optional<std::int64_t> BytesOf(std::string_view text, std::string_view name) {
  std::size_t begin = text.starts_with(name) ? 0 : std::string_view::npos;
  for (std::size_t end = 0; begin == std::string_view::npos;) {
    end = text.find('\n', end);
    if (end == std::string_view::npos) return std::nullopt;
    ++end;
    if (text.substr(end).starts_with(name)) begin = end;
  }
  std::string_view rest = text.substr(begin + name.size());
  const auto kilobytes = TakeNumber(rest);
  if (!kilobytes || !rest.starts_with(" kB")) return std::nullopt;
  return static_cast<std::int64_t>(*kilobytes * 1024U);
}

}  // namespace

std::optional<CpuTimes> ParseCpuTimes(std::string_view text) {
  constexpr std::string_view kName = "cpu ";
  if (!text.starts_with(kName)) return std::nullopt;
  std::string_view rest = text.substr(kName.size());
  // user nice system idle iowait irq softirq steal; guests are in user and nice.
  std::array<std::uint64_t, 8> times{};
  CpuTimes sum;
  for (std::uint64_t& time : times) {
    const auto number = TakeNumber(rest);
    if (!number) return std::nullopt;
    time = *number;
    sum.total += time;
  }
  sum.busy = sum.total - times[3] - times[4];
  return sum;
}

std::optional<HostMemory> ParseMemInfo(std::string_view text) {
  const auto total = BytesOf(text, "MemTotal:");
  const auto available = BytesOf(text, "MemAvailable:");
  const auto swap_total = BytesOf(text, "SwapTotal:");
  const auto swap_free = BytesOf(text, "SwapFree:");
  if (!total || !available || !swap_total || !swap_free) return std::nullopt;
  return HostMemory{*total, *available, *swap_total, *swap_free};
}

HostLoad::Reading HostLoad::Sample() {
  std::array<char, 4096> buffer;
  Reading reading;
  const auto times = ParseCpuTimes(ReadProcFile(AT_FDCWD, "/proc/stat", buffer));
  if (times && last_ && times->total > last_->total) {
    // The kernel lets its times of waiting run backwards now and then.
    const auto busy = static_cast<double>(static_cast<std::int64_t>(times->busy - last_->busy));
    const auto total = static_cast<double>(times->total - last_->total);
    last_load_ = static_cast<float>(std::clamp(busy / total, 0.0, 1.0));
  }
  reading.cpu_load = last_load_;
  if (times) last_ = times;
  const auto memory = ParseMemInfo(ReadProcFile(AT_FDCWD, "/proc/meminfo", buffer));
  reading.memory = memory.value_or(HostMemory{});
  return reading;
}

}  // namespace clearway::host
