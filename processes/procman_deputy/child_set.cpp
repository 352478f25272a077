// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_deputy/child_set.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <unistd.h>

#include "common/core/procman/exec_string.hpp"
#include "common/host/program_path.hpp"
#include "common/host/reaping.hpp"
#include "common/host/signalling.hpp"
#include "common/host/spare_descriptors.hpp"
#include "common/host/terminal_child.hpp"
#include "common/process/log.hpp"

namespace clearway {
namespace {

using core::procman::CommandSpec;
using core::procman::ExecLine;
using core::procman::StartOutcome;

// Of one command before others and the bus have their turn.
constexpr std::size_t kOutputAtOnceBytes = 65536;
// What a command wrote last, when it has ended: at most what a terminal holds, by far.
constexpr std::size_t kLastOutputBytes = 4U << 20;
// Remains get SIGKILL; how often it is looked whether they are gone, and how long.
constexpr std::int64_t kLookAgainUs = 5'000;
constexpr std::int64_t kRemainsTimeUs = 2'000'000;
// So often in a row nothing must be found of an earlier life, or of a command that had children:
// one look may miss what hops from process to process.
constexpr int kCleanLooks = 5;
// LCM's bound.
constexpr std::size_t kLongestChannel = 63;

std::optional<std::string> VariableOf(const std::string& name) {
  const char* const value = std::getenv(name.c_str());
  return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

const std::string* SettingOf(const ExecLine& line, std::string_view name) {
  const std::string* value = nullptr;
  for (const auto& [key, text] : line.environment) {
    if (key == name) value = &text;
  }
  return value;
}

StartOutcome NotStarted(std::string problem, bool is_refused) {
  StartOutcome outcome;
  outcome.problem = std::move(problem);
  outcome.is_refused = is_refused;
  return outcome;
}

// A whole number of seconds of [1, 86400]; nothing when it is none.
std::optional<std::int64_t> SecondsOf(const std::string& text) {
  std::int64_t seconds = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  const bool is_whole = error == std::errc() && end == text.data() + text.size();
  return is_whole && seconds >= 1 && seconds <= 86400 ? std::optional(seconds) : std::nullopt;
}

// Nothing where /proc cannot be read for now, say for want of memory: no reason to end everything.
std::optional<host::ProcessTable> ReadTable() {
  try {
    return host::ProcessTable::Read();
  } catch (const std::runtime_error& error) {
    process::LogError(error.what());
    return std::nullopt;
  }
}

bool IsChannel(const std::string& text) {
  return !text.empty() && text.size() <= kLongestChannel &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c <= '~'; });
}

bool IsEnded(const host::ProcessEntry& process) {
  return process.state == 'Z' || process.state == 'X';
}

}  // namespace

std::string SearchPath() {
  const auto own = std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
  return own + ':' + VariableOf("PATH").value_or("/usr/local/bin:/usr/bin:/bin");
}

ChildSet::ChildSet(process::LiveRuntime& runtime,
                   std::optional<core::procman::AllowList> allowed,
                   std::string deputy_mark)
    : runtime_(runtime),
      allowed_(std::move(allowed)),
      deputy_mark_(std::move(deputy_mark)),
      path_(SearchPath()) {
  host::BecomeSubreaper();
}

ChildSet::~ChildSet() {
  for (auto& [pid, child] : children_) {
    runtime_.UnwatchDescriptor(child.output.get());
    Signal(pid, SIGKILL);
  }
}

StartOutcome ChildSet::Start(const CommandSpec& spec) {
  core::procman::ParsedExecLine parsed = core::procman::ParseExecLine(spec.exec, VariableOf);
  if (!parsed.line) return NotStarted(std::move(parsed.problem), true);
  if (allowed_) {
    std::string why = allowed_->WhyRefused(*parsed.line);
    if (!why.empty()) return NotStarted(why + ": see <allow> in its deputy.xml", true);
  }
  return StartLine(*parsed.line, spec);
}

StartOutcome ChildSet::StartLine(const ExecLine& line, const CommandSpec& spec) {
  StartOutcome outcome;
  if (const std::string* const channel = SettingOf(line, kStatusChannelVariable)) {
    if (!IsChannel(*channel)) {
      return NotStarted(std::string(kStatusChannelVariable) +
                            ": expected the name of a channel, 1 to 63 letters, digits and signs",
                        true);
    }
    outcome.status_channel = *channel;
  }
  if (const std::string* const seconds = SettingOf(line, kRestartUnhealthyVariable)) {
    const auto parsed = SecondsOf(*seconds);
    if (!parsed) {
      return NotStarted(std::string(kRestartUnhealthyVariable) + "=\"" + *seconds +
                            "\": expected whole seconds in [1, 86400]",
                        true);
    }
    outcome.restart_unhealthy_us = *parsed * 1'000'000;
  }
  const auto program = host::FindProgram(line.arguments.front(), path_);
  if (!program)
    return NotStarted(
        "no program \"" + line.arguments.front() + "\" beside the deputy, nor in its PATH", false);
  if (!host::HasDescriptorsToSpare())
    return NotStarted("too few file descriptors are left (ulimit -n)", false);
  try {
    const host::TerminalChild started =
        host::StartOnTerminal({.program = *program,
                               .arguments = line.arguments,
                               .environment = EnvironmentOf(line, spec.id),
                               .working_folder = {}});
    Child& child = children_[started.pid];
    child.command_id = spec.id;
    child.start_ticks = started.start_ticks;
    child.output.Reset(started.output_fd);
    WatchOutput(started.pid, child);
    outcome.pid = started.pid;
  } catch (const std::exception& error) {
    return NotStarted(error.what(), false);
  }
  return outcome;
}

void ChildSet::WatchOutput(pid_t pid, const Child& child) {
  runtime_.WatchDescriptor(child.output.get(),
                           [this, pid] { ReadOutput(pid, kOutputAtOnceBytes); });
}

std::vector<std::string> ChildSet::EnvironmentOf(const ExecLine& line,
                                                 const std::string& command_id) const {
  std::map<std::string, std::string> variables;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) continue;
    variables[std::string(text.substr(0, equals))] = text.substr(equals + 1);
  }
  // systemd's own business with this process, not with its children.
  for (const char* name : {"NOTIFY_SOCKET", "LISTEN_FDS", "LISTEN_PID", "WATCHDOG_USEC"}) {
    variables.erase(name);
  }
  variables["PATH"] = path_;
  for (const auto& [name, value] : line.environment) variables[name] = value;
  variables[kDeputyVariable] = deputy_mark_;
  variables[kCommandVariable] = command_id;
  std::vector<std::string> environment;
  environment.reserve(variables.size());
  for (const auto& [name, value] : variables) environment.push_back(name + '=' + value);
  return environment;
}

void ChildSet::ReadOutput(pid_t pid, std::size_t max_bytes) {
  const auto found = children_.find(pid);
  if (found == children_.end()) return;
  host::Descriptor& output = found->second.output;
  std::array<char, 16384> buffer{};
  for (std::size_t sum = 0; sum < max_bytes;) {
    const host::OutputPart part = host::ReadOutput(output.get(), buffer);
    if (part.size > 0 && listener_ != nullptr) listener_->OnOutput(pid, {buffer.data(), part.size});
    sum += part.size;
    if (part.is_over) {
      // Kept open all the same: to close it hangs up, and SIGHUP would kill a command that only
      // sends its output elsewhere. Sample() looks whether it holds its terminal again.
      runtime_.UnwatchDescriptor(output.get());
    }
    if (part.size == 0) break;
  }
}

void ChildSet::Signal(std::int32_t pid, int signal) {
  const auto found = children_.find(pid);
  if (found == children_.end()) return;
  Child& child = found->second;
  // The command itself is told first; that does not wait for a look at all processes.
  if (!child.wait_status) host::SendSignal(pid, child.start_ticks, signal);
  const auto table = ReadTable();
  if (!table) return;
  for (const host::ProcessEntry& member : MembersOf(pid, child, *table)) {
    if (member.pid != pid) host::SendSignal(member.pid, member.start_ticks, signal);
  }
}

// Not those of a deputy that runs under this one and may have a command of the same id.
bool ChildSet::HasMarks(pid_t pid, const Child& child) const {
  return host::HasVariable(pid, std::string(kCommandVariable) + '=' + child.command_id) &&
         host::HasVariable(pid, std::string(kDeputyVariable) + '=' + deputy_mark_);
}

// All that came from a command: its session, what was seen as its own before, orphans that carry
// its mark, and what descends from any of them.
std::vector<host::ProcessEntry> ChildSet::MembersOf(pid_t pid,
                                                    Child& child,
                                                    const host::ProcessTable& table) const {
  std::map<pid_t, host::ProcessEntry> members;
  // Once an ended command is reaped its pid is free.
  const host::ProcessEntry* const leader = table.Find(pid);
  const bool is_pid_reused = leader != nullptr && leader->start_ticks != child.start_ticks;
  for (const host::ProcessEntry& process : table.entries()) {
    const bool is_own = (!is_pid_reused && (process.pid == pid || process.session == pid)) ||
                        child.members.contains({process.pid, process.start_ticks}) ||
                        (process.ppid == getpid() && !children_.contains(process.pid) &&
                         !IsEnded(process) && HasMarks(process.pid, child));
    if (!is_own) continue;
    members.emplace(process.pid, process);
    for (const host::ProcessEntry& descendant : table.Descendants(process.pid)) {
      members.emplace(descendant.pid, descendant);
    }
  }
  std::vector<host::ProcessEntry> found;
  child.had_children = child.had_children || members.size() > 1;
  child.members.clear();
  for (const auto& [member_pid, process] : members) {
    child.members.emplace(member_pid, process.start_ticks);
    found.push_back(process);
  }
  return found;
}

void ChildSet::Reap() {
  for (const host::Exit& exit : host::ReapAll()) {
    const auto found = children_.find(exit.pid);
    if (found == children_.end()) continue;
    found->second.wait_status = exit.status;
    found->second.ended_us = runtime_.MonotonicUs();
  }
  FinishEnded();
}

// Orphans that fled both their session and their environment.
std::vector<host::ProcessEntry> ChildSet::UnclaimedOrphans(const host::ProcessTable& table) const {
  std::vector<host::ProcessEntry> orphans;
  for (const host::ProcessEntry& process : table.entries()) {
    if (process.ppid != getpid() || IsEnded(process) || children_.contains(process.pid)) continue;
    const bool is_known = std::any_of(children_.begin(), children_.end(), [&](const auto& entry) {
      return process.session == entry.first ||
             entry.second.members.contains({process.pid, process.start_ticks}) ||
             HasMarks(process.pid, entry.second);
    });
    if (!is_known) orphans.push_back(process);
  }
  return orphans;
}

// True while something of the ended command is left.
bool ChildSet::KillRemains(pid_t pid, Child& child, const host::ProcessTable& table) {
  std::vector<host::ProcessEntry> remains = MembersOf(pid, child, table);
  for (const host::ProcessEntry& orphan : UnclaimedOrphans(table)) {
    remains.push_back(orphan);
    for (const host::ProcessEntry& each : table.Descendants(orphan.pid)) remains.push_back(each);
  }
  bool is_left = false;
  for (const host::ProcessEntry& process : remains) {
    if (process.pid == pid || IsEnded(process)) continue;
    is_left = host::SendSignal(process.pid, process.start_ticks, SIGKILL) || is_left;
  }
  return is_left;
}

void ChildSet::FinishEnded() {
  if (std::none_of(children_.begin(), children_.end(), [](const auto& entry) {
        return entry.second.wait_status.has_value();
      })) {
    return;
  }
  bool is_left = false;
  std::vector<std::pair<pid_t, int>> gone;
  const auto table = ReadTable();
  for (auto& [pid, child] : children_) {
    if (!child.wait_status) continue;
    const bool remains = !table || KillRemains(pid, child, *table);
    child.clean_looks = remains ? 0 : child.clean_looks + 1;
    const bool is_gone = child.clean_looks >= (child.had_children ? kCleanLooks : 1);
    if (!is_gone && runtime_.MonotonicUs() - child.ended_us < kRemainsTimeUs) {
      is_left = true;
      continue;
    }
    if (remains) process::LogError(child.command_id + ": what it started does not end");
    gone.emplace_back(pid, *child.wait_status);
  }
  if (is_left && !finish_is_due_) {
    finish_is_due_ = true;
    runtime_.After(kLookAgainUs, [this] {
      finish_is_due_ = false;
      Reap();
    });
  }
  for (const auto& [pid, status] : gone) {
    ReadOutput(pid, kLastOutputBytes);
    runtime_.UnwatchDescriptor(children_.at(pid).output.get());
    children_.erase(pid);
    if (listener_ != nullptr) listener_->OnExit(pid, status);
  }
}

Machine::HostUse ChildSet::Sample() {
  const host::HostLoad::Reading reading = host_load_.Sample();
  const std::int64_t now_us = runtime_.MonotonicUs();
  const double elapsed_s = sampled_us_ < 0 ? 0.0 : static_cast<double>(now_us - sampled_us_) * 1e-6;
  if (const auto table = children_.empty() ? std::nullopt : ReadTable()) {
    for (auto& [pid, child] : children_) MeasureChild(pid, child, *table, elapsed_s);
  }
  for (const auto& [pid, child] : children_) WatchOutput(pid, child);
  sampled_us_ = now_us;
  return {.cpu_load = reading.cpu_load,
          .memory_total_bytes = reading.memory.total_bytes,
          .memory_free_bytes = reading.memory.free_bytes,
          .swap_total_bytes = reading.memory.swap_total_bytes,
          .swap_free_bytes = reading.memory.swap_free_bytes};
}

void ChildSet::MeasureChild(pid_t pid,
                            Child& child,
                            const host::ProcessTable& table,
                            double elapsed_s) {
  Use use;
  std::uint64_t ticks = 0;
  for (const host::ProcessEntry& member : MembersOf(pid, child, table)) {
    ticks += member.cpu_ticks;
    use.vsize_bytes += member.vsize_bytes;
    use.rss_bytes += member.rss_bytes;
  }
  // Members that ended since take their time with them.
  const double used_s = ticks > child.cpu_ticks ? host::SecondsOf(ticks - child.cpu_ticks) : 0.0;
  const auto processors = static_cast<double>(sysconf(_SC_NPROCESSORS_ONLN));
  if (elapsed_s > 0.0) {
    use.cpu_usage = static_cast<float>(std::min(used_s / elapsed_s / processors, 1.0));
  }
  child.cpu_ticks = ticks;
  child.use = use;
}

Machine::Use ChildSet::UseOf(std::int32_t pid) const {
  const auto found = children_.find(pid);
  return found == children_.end() ? Use{} : found->second.use;
}

std::int32_t ChildSet::CommandPidOf(std::int32_t pid) const {
  // A chain of parents ends at this process or at init; the bound is for one that changes
  // meanwhile.
  for (int steps = 0; steps < 64 && pid > 1; ++steps) {
    if (children_.contains(pid)) return pid;
    const auto process = host::ReadProcess(pid);
    if (!process) return 0;
    if (children_.contains(process->session)) return process->session;
    pid = process->ppid;
  }
  return 0;
}

int ChildSet::KillLeftovers() {
  const std::string mark = std::string(kDeputyVariable) + '=' + deputy_mark_;
  const std::int64_t until_us = runtime_.MonotonicUs() + kRemainsTimeUs;
  std::set<std::pair<pid_t, std::uint64_t>> killed;
  // They may be having children while it is looked, and hold what new ones will want.
  for (int clean_looks = 0; clean_looks < kCleanLooks && runtime_.MonotonicUs() < until_us;) {
    ++clean_looks;
    const host::ProcessTable table = host::ProcessTable::Read();
    for (const host::ProcessEntry& process : table.entries()) {
      if (process.pid == getpid() || IsEnded(process)) continue;
      if (!host::HasVariable(process.pid, mark)) continue;
      if (!host::SendSignal(process.pid, process.start_ticks, SIGKILL)) continue;
      killed.emplace(process.pid, process.start_ticks);
      clean_looks = 0;
    }
    usleep(kLookAgainUs);
  }
  return static_cast<int>(killed.size());
}

}  // namespace clearway
