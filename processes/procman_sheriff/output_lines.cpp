// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/output_lines.hpp"

#include <algorithm>

#include "processes/procman_sheriff/text_cells.hpp"

namespace clearway::screen {
namespace {

constexpr char32_t kBell = 0x07;
constexpr char32_t kEsc = 0x1B;
constexpr char32_t kC1Sequence = 0x9B;
constexpr char32_t kC1StringEnd = 0x9C;
constexpr int kTabCells = 8;

// Begins a string that a terminal does not show: DCS, SOS, OSC, PM, APC.
bool BeginsString(char32_t code) {
  return code == 'P' || code == 'X' || code == ']' || code == '^' || code == '_';
}

}  // namespace

void OutputLines::Add(std::string_view bytes) {
  const std::string joined = partial_ + std::string(bytes);
  partial_.clear();
  std::string_view rest = joined;
  while (!rest.empty()) {
    const Utf8Step step = FirstCharacter(rest);
    if (step.is_cut) {
      partial_ = rest;
      break;
    }
    Take(step.code);
    rest.remove_prefix(step.bytes);
  }
  DropOld();
}

void OutputLines::AddMark(std::string_view text) {
  EndLine();
  Line& line = lines_.emplace_back(Line{Printable(text), true});
  bytes_ += line.text.size();
  DropOld();
}

void OutputLines::Take(char32_t code) {
  // A line's end ends whatever was not ended: nothing may swallow all that follows.
  if (code == '\n' || code == '\r') state_ = State::kText;
  switch (state_) {
    case State::kText:
      return TakeText(code);
    case State::kEscape:
      return TakeEscape(code);
    case State::kSequence:
      return TakeSequence(code);
    case State::kString:
      if (code == kBell || code == kC1StringEnd) state_ = State::kText;
      if (code == kEsc) state_ = State::kEscape;
  }
}

void OutputLines::TakeText(char32_t code) {
  switch (code) {
    case '\n':
      OpenLine();
      return EndLine();
    case '\r':
      returns_ = true;
      return;
    case '\b':
      return EraseLast();
    case '\t':
      do {
        Append(' ');
      } while (column_ % kTabCells != 0);
      return;
    case kEsc:
      state_ = State::kEscape;
      return;
    case kC1Sequence:
      state_ = State::kSequence;
      return;
    default:
      if (CellsOf(code) > 0) Append(code);
  }
}

void OutputLines::TakeEscape(char32_t code) {
  if (code == '[') {
    state_ = State::kSequence;
  } else if (BeginsString(code)) {
    state_ = State::kString;
  } else if (code != kEsc && (code < 0x20 || code > 0x2F)) {
    state_ = State::kText;  // What the sequence ends with.
  }
}

void OutputLines::TakeSequence(char32_t code) {
  if (code >= 0x20 && code <= 0x3F) return;
  state_ = code == kEsc ? State::kEscape : State::kText;
  const bool ends_it = code >= 0x40 && code <= 0x7E;
  if (!ends_it && code != kEsc) TakeText(code);
}

void OutputLines::Append(char32_t code) {
  if (returns_ && is_open_) {
    bytes_ -= OpenLine().text.size();
    OpenLine().text.clear();
    column_ = 0;
  }
  returns_ = false;
  const int cells = CellsOf(code);
  if (column_ + cells > kMaxCells) EndLine();
  std::string& text = OpenLine().text;
  const std::size_t before = text.size();
  AppendUtf8(code, text);
  bytes_ += text.size() - before;
  column_ += cells;
}

void OutputLines::EraseLast() {
  if (!is_open_ || OpenLine().text.empty()) return;
  std::string& text = OpenLine().text;
  std::size_t begin = text.size() - 1;
  while ((static_cast<unsigned char>(text[begin]) & 0xC0U) == 0x80) --begin;
  column_ -= CellsOf(FirstCharacter(std::string_view(text).substr(begin)).code);
  bytes_ -= text.size() - begin;
  text.resize(begin);
}

OutputLines::Line& OutputLines::OpenLine() {
  if (!is_open_) {
    lines_.emplace_back();
    is_open_ = true;
    column_ = 0;
    if (lines_.size() > 2 * kMaxLines) DropOld();  // One call may bring very many.
  }
  return lines_.back();
}

void OutputLines::EndLine() {
  is_open_ = false;
  returns_ = false;
  column_ = 0;
}

void OutputLines::DropOld() {
  while (lines_.size() > kMaxLines || (bytes_ > kMaxBytes && lines_.size() > 1)) {
    bytes_ -= lines_.front().text.size();
    lines_.pop_front();
    ++first_;
  }
}

OutputLines& OutputStore::Of(const std::string& command) {
  if (!entries_.contains(command) && entries_.size() >= kMaxCommands) {
    entries_.erase(
        std::min_element(entries_.begin(), entries_.end(), [](const auto& a, const auto& b) {
          return a.second.used < b.second.used;
        }));
  }
  Entry& entry = entries_[command];
  entry.used = ++uses_;
  return entry.lines;
}

const OutputLines* OutputStore::Find(const std::string& command) const {
  const auto found = entries_.find(command);
  return found == entries_.end() ? nullptr : &found->second.lines;
}

}  // namespace clearway::screen
