// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/process_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <memory>
#include <stdexcept>
#include <string>
#include <unistd.h>

#include <dirent.h>

#include "common/host/proc_file.hpp"

namespace clearway::host {
namespace {

// 52 fields of 20 digits and a name of 64 bytes at most.
using StatBuffer = std::array<char, 2048>;

// Numbers that blanks separate. A number counts only with the blank behind it: else it may be cut.
class Fields {
 public:
  explicit Fields(std::string_view text) : rest_(text) {}

  std::string_view Next() {
    const std::size_t begin = rest_.find_first_not_of(' ');
    const std::size_t end =
        begin == std::string_view::npos ? begin : rest_.find_first_of(" \n", begin);
    if (end == std::string_view::npos) {
      is_whole_ = false;
      return {};
    }
    const std::string_view word = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return word;
  }

  template <typename Number>
  Number NextNumber() {
    const std::string_view word = Next();
    Number number{};
    const char* const end = word.data() + word.size();
    const auto result = std::from_chars(word.data(), end, number);
    if (word.empty() || result.ec != std::errc() || result.ptr != end) is_whole_ = false;
    return number;
  }

  void Skip(int count) {
    for (int i = 0; i < count; ++i) Next();
  }

  [[nodiscard]] bool is_whole() const { return is_whole_; }

 private:
  std::string_view rest_;
  bool is_whole_ = true;
};

std::int64_t PageBytes() {
  static const std::int64_t bytes = sysconf(_SC_PAGESIZE);
  return bytes;
}

std::optional<ProcessEntry> ReadStat(int proc_fd, const char* pid) {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "%.20s/stat", pid);
  StatBuffer buffer;
  return ParseStat(ReadProcFile(proc_fd, name.data(), buffer));
}

}  // namespace

double SecondsOf(std::uint64_t ticks) {
  static const auto per_s = static_cast<double>(sysconf(_SC_CLK_TCK));
  return static_cast<double>(ticks) / per_s;
}

std::optional<ProcessEntry> ParseStat(std::string_view text) {
  // The name may hold blanks and brackets; behind it are only numbers.
  const std::size_t name_begin = text.find(" (");
  const std::size_t name_end = text.rfind(')');
  if (name_begin == std::string_view::npos || name_end == std::string_view::npos ||
      name_end < name_begin) {
    return std::nullopt;
  }
  ProcessEntry entry;
  Fields first(text.substr(0, name_begin + 1));
  entry.pid = first.NextNumber<pid_t>();
  Fields fields(text.substr(name_end + 1));
  const std::string_view state = fields.Next();
  entry.ppid = fields.NextNumber<pid_t>();
  entry.pgrp = fields.NextNumber<pid_t>();
  entry.session = fields.NextNumber<pid_t>();
  fields.Skip(7);  // tty_nr to cmajflt
  entry.cpu_ticks = fields.NextNumber<std::uint64_t>();
  entry.cpu_ticks += fields.NextNumber<std::uint64_t>();
  fields.Skip(6);  // cutime to itrealvalue
  entry.start_ticks = fields.NextNumber<std::uint64_t>();
  entry.vsize_bytes = static_cast<std::int64_t>(fields.NextNumber<std::uint64_t>());
  const auto pages = fields.NextNumber<std::int32_t>();
  entry.rss_bytes = pages * PageBytes();
  if (!first.is_whole() || !fields.is_whole() || state.size() != 1) return std::nullopt;
  entry.state = state[0];
  return entry;
}

std::optional<ProcessEntry> ReadProcess(pid_t pid) {
  const std::string name = "/proc/" + std::to_string(pid) + "/stat";
  StatBuffer buffer;
  return ParseStat(ReadProcFile(AT_FDCWD, name.c_str(), buffer));
}

bool HasVariable(pid_t pid, std::string_view variable) {
  constexpr std::size_t kMaxBytes = 8U << 20U;  // The kernel takes 6 MB at most.
  const auto text = ReadProcFile("/proc/" + std::to_string(pid) + "/environ", kMaxBytes);
  if (!text || variable.empty()) return false;
  for (std::string_view rest = *text; !rest.empty();) {
    const std::size_t size = std::min(rest.find('\0'), rest.size());
    if (rest.substr(0, size) == variable) return true;
    rest.remove_prefix(std::min(size + 1, rest.size()));
  }
  return false;
}

ProcessTable ProcessTable::Read() {
  const std::unique_ptr<DIR, int (*)(DIR*)> proc(opendir("/proc"), closedir);
  if (!proc) throw std::runtime_error(WithReason("cannot read /proc"));
  std::vector<ProcessEntry> entries;
  while (const dirent* const name = readdir(proc.get())) {
    if (name->d_name[0] < '0' || name->d_name[0] > '9') continue;
    if (const auto entry = ReadStat(dirfd(proc.get()), name->d_name)) entries.push_back(*entry);
  }
  return ProcessTable(std::move(entries));
}

ProcessTable::ProcessTable(std::vector<ProcessEntry> entries) : entries_(std::move(entries)) {
  std::sort(
      entries_.begin(), entries_.end(), [](const auto& a, const auto& b) { return a.pid < b.pid; });
  const auto same_pid = [](const auto& a, const auto& b) { return a.pid == b.pid; };
  entries_.erase(std::unique(entries_.begin(), entries_.end(), same_pid), entries_.end());
  by_parent_.reserve(entries_.size());
  for (std::size_t i = 0; i < entries_.size(); ++i) by_parent_.emplace_back(entries_[i].ppid, i);
  std::sort(by_parent_.begin(), by_parent_.end());
}

const ProcessEntry* ProcessTable::Find(pid_t pid) const {
  const auto found =
      std::lower_bound(entries_.begin(), entries_.end(), pid, [](const auto& entry, pid_t wanted) {
        return entry.pid < wanted;
      });
  return found != entries_.end() && found->pid == pid ? &*found : nullptr;
}

std::vector<ProcessEntry> ProcessTable::Descendants(pid_t pid) const {
  std::vector<ProcessEntry> found;
  std::vector<pid_t> parents{pid};
  while (!parents.empty()) {
    const pid_t parent = parents.back();
    parents.pop_back();
    for (auto child =
             std::lower_bound(by_parent_.begin(), by_parent_.end(), std::pair(parent, 0UL));
         child != by_parent_.end() && child->first == parent;
         ++child) {
      const ProcessEntry& entry = entries_[child->second];
      // Each has one parent, so that a circle, which pids used again within the pass could make,
      // comes back here.
      if (entry.pid == pid) continue;
      found.push_back(entry);
      parents.push_back(entry.pid);
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.pid < b.pid; });
  return found;
}

}  // namespace clearway::host
