// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <sys/types.h>
#include <vector>

#include "common/host/descriptor.hpp"
#include "common/host/terminal_child.hpp"

namespace clearway::test {

/// Longer than anything takes on a busy machine with sanitizers; only a failure waits for it.
inline constexpr int kTimeoutMs = 60'000;

/// Settings of the test child with these arguments and an environment of its own.
[[nodiscard]] host::ChildSettings TestChild(const std::vector<std::string>& arguments);

/// Whether the process has ended within the time, or is not there. Awaited, not polled for.
[[nodiscard]] bool HasEnded(pid_t pid, int timeout_ms = kTimeoutMs);

/// A child on a terminal, killed and reaped with the object.
class StartedChild {
 public:
  explicit StartedChild(const host::ChildSettings& settings);
  ~StartedChild();
  StartedChild(const StartedChild&) = delete;
  StartedChild& operator=(const StartedChild&) = delete;

  [[nodiscard]] const host::TerminalChild& child() const { return child_; }
  [[nodiscard]] pid_t pid() const { return child_.pid; }

  /// The next line that it writes, without its end. Throws when none comes.
  [[nodiscard]] std::string ReadLine();

  /// The number behind "word " in the next line.
  [[nodiscard]] pid_t ReadPid(const std::string& word);

  /// All that it writes from now on, until nobody holds the terminal.
  [[nodiscard]] std::string ReadToEnd();

  /// Waits for its end; the status as wait() gives it.
  int Reap();

 private:
  // Whether the terminal is still held.
  bool ReadPart();

  host::TerminalChild child_;
  host::Descriptor output_;
  std::string text_;
  bool is_reaped_ = false;
};

}  // namespace clearway::test
