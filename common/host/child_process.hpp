// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <csignal>
#include <filesystem>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace clearway::host {

/// What a process has used so far.
struct ResourceUse {
  double cpu_s = 0.0;
  double pss_mb = 0.0;  ///< Proportional share of its memory [1e6 bytes].
};

/// Of a process; nothing when it is gone or another user's.
[[nodiscard]] std::optional<ResourceUse> UseOf(pid_t pid);

/// The last lines of a file, each indented and with its line end; empty where there is no file.
[[nodiscard]] std::string LastLinesOf(const std::filesystem::path& file);

/// A program that was started here, in a process group of its own: what is typed at the terminal
/// (Ctrl-C) is for its parent alone. It dies with the thread that started it.
class ChildProcess {
 public:
  /// Starts a program, found by PATH when it has no slash; its stderr goes to the file. Throws
  /// std::runtime_error when it cannot be started. `parent_death_signal` is what it gets when the
  /// thread that started it ends.
  ChildProcess(std::string name,
               const std::vector<std::string>& command,
               const std::filesystem::path& stderr_file,
               int parent_death_signal = SIGKILL);

  /// Kills it when it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] pid_t pid() const { return pid_; }

  /// Exit status, 128 + signal when one killed it; nothing while it runs.
  [[nodiscard]] std::optional<int> ExitStatus();

  void Signal(int signal) const;

  /// Waits for its end, for at most `timeout_ms`; then SIGKILL.
  int WaitOrKill(int timeout_ms);

  /// Nothing once it has ended.
  [[nodiscard]] std::optional<ResourceUse> Use() const;

  /// The last lines that it wrote to stderr.
  [[nodiscard]] std::string LastWords() const { return LastLinesOf(stderr_file_); }

 private:
  std::string name_;
  std::filesystem::path stderr_file_;
  pid_t pid_ = -1;
  std::optional<int> exit_status_;
};

}  // namespace clearway::host
