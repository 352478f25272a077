// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <termios.h>

namespace clearway::teleop {

/// A terminal that hands on each key at once and does not show it, for as long as this object
/// lives. Ctrl-C and Ctrl-\ stay signals; Ctrl-Z is a key, since a program that is stopped cannot
/// ask for standstill.
class TerminalMode {
 public:
  /// Throws std::runtime_error when `fd` is no terminal.
  explicit TerminalMode(int fd);
  ~TerminalMode();
  TerminalMode(const TerminalMode&) = delete;
  TerminalMode& operator=(const TerminalMode&) = delete;

 private:
  int fd_;
  termios before_{};
};

/// Characters in a line of the terminal; 80 where it does not say.
[[nodiscard]] int TerminalWidth(int fd);

}  // namespace clearway::teleop
