// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "processes/procman_sheriff/screen_line.hpp"
#include "processes/procman_sheriff/screen_model.hpp"
#include "processes/procman_sheriff/screen_text.hpp"

namespace clearway::screen {

/// The terminal of stdin and stdout, as a whole, until the end of this object. Neither reading nor
/// drawing ever waits for the terminal, however slow or stuck it is. One at a time.
class Terminal {
 public:
  /// Throws std::runtime_error, with what to do about it, where stdin or stdout is no terminal or
  /// TERM names none that is known.
  Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  /// Puts everything back as it was.
  ~Terminal();

  /// To be watched for keys.
  [[nodiscard]] int input() const { return 0; }

  /// All keys that were pressed so far.
  [[nodiscard]] std::vector<KeyPress> ReadKeys();
  /// After ReadKeys(): nobody is there any more.
  [[nodiscard]] bool is_gone() const { return is_gone_; }

  /// After SIGWINCH.
  void TakeSize();
  [[nodiscard]] ScreenSize size() const { return size_; }

  /// Draws what changed. @pre IsReady()
  void Draw(const std::vector<Line>& lines);
  /// Forgets what the terminal is thought to show: the next Draw() draws all.
  void Redraw();
  /// Hands on what is left of the last drawing; whether all of it has gone.
  [[nodiscard]] bool IsReady();

 private:
  struct Modes;
  struct Curses;

  void Collect();

  bool is_gone_ = false;
  int idle_reads_ = 0;
  ScreenSize size_;
  int output_ = -1;      // The terminal, opened anew so that it can be written to without waiting.
  std::string pending_;  // Not taken by it yet.
  std::unique_ptr<Modes> modes_;
  std::unique_ptr<Curses> curses_;
};

}  // namespace clearway::screen
