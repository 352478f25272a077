// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>

namespace clearway::screen {

/// The last lines of what a command wrote, fit to be shown: whatever bytes came in, a line holds
/// printable characters only (text_cells.hpp). Sequences that steer a terminal (colours, titles,
/// cursor) are left out; a carriage return begins the line anew, as progress bars need it; tabs
/// become blanks. Sequences and characters may be cut anywhere between two Add().
class OutputLines {
 public:
  struct Line {
    std::string text;
    bool is_mark = false;  ///< Not written by the command.
  };
  static constexpr std::size_t kMaxLines = 2000;
  static constexpr std::size_t kMaxBytes = 262'144;
  /// Longer lines go on in a line of their own.
  static constexpr int kMaxCells = 400;

  void Add(std::string_view bytes);

  /// A line between what was and what will be written.
  void AddMark(std::string_view text);

  /// Lines keep their numbers when older ones are dropped: those in [first(), end()) are there. The
  /// last may not have ended yet.
  [[nodiscard]] std::int64_t first() const { return first_; }
  [[nodiscard]] std::int64_t end() const {
    return first_ + static_cast<std::int64_t>(lines_.size());
  }
  [[nodiscard]] const Line& At(std::int64_t number) const {
    return lines_.at(static_cast<std::size_t>(number - first_));
  }

 private:
  enum class State {
    kText,
    kEscape,    // After ESC.
    kSequence,  // After ESC [.
    kString,    // After ESC ], ESC P and the like: until BEL, ESC \ or the end of the line.
  };

  void Take(char32_t code);
  void TakeText(char32_t code);
  void TakeEscape(char32_t code);
  void TakeSequence(char32_t code);
  void Append(char32_t code);
  void EraseLast();
  Line& OpenLine();
  void EndLine();
  void DropOld();

  std::deque<Line> lines_;
  std::int64_t first_ = 0;
  std::size_t bytes_ = 0;  // In lines_.
  State state_ = State::kText;
  std::string partial_;  // The begin of a character.
  bool is_open_ = false;
  bool returns_ = false;  // A carriage return came: the next character begins the line anew.
  int column_ = 0;
};

/// What all commands wrote. Ids come from outside: of more than kMaxCommands those that were silent
/// for longest are forgotten.
class OutputStore {
 public:
  static constexpr std::size_t kMaxCommands = 256;

  [[nodiscard]] OutputLines& Of(const std::string& command);
  /// Null: it has written nothing.
  [[nodiscard]] const OutputLines* Find(const std::string& command) const;

 private:
  struct Entry {
    OutputLines lines;
    std::int64_t used = 0;
  };
  std::map<std::string, Entry> entries_;
  std::int64_t uses_ = 0;
};

}  // namespace clearway::screen
