// SPDX-License-Identifier: BSD-3-Clause
// What keys mean in each mode.
#include "processes/procman_sheriff/screen_model.hpp"

#include <algorithm>
#include <utility>

namespace clearway::screen {
namespace {

using core::procman::CommandView;
using core::procman::ScriptRunner;
using Kind = KeyPress::Kind;

}  // namespace

Intent ScreenModel::OnKey(const KeyPress& key) {
  notice_.clear();
  if (key.kind == Kind::kRedraw) return {.kind = Intent::Kind::kRedraw};
  if (question_) return Answer(key);
  if (key.kind == Kind::kInterrupt) return AskToQuit(false);
  if (search_) {
    Search(key);
    return {};
  }
  switch (mode_) {
    case Mode::kOutput:
      return OnOutputKey(key);
    case Mode::kScripts:
      return OnScriptsKey(key);
    case Mode::kHelp:
      return OnHelpKey(key);
    case Mode::kTable:
      break;
  }
  return OnTableKey(key);
}

Intent ScreenModel::Answer(const KeyPress& key) {
  const bool is_character = key.kind == Kind::kCharacter;
  const bool is_yes = is_character && (key.character == 'y' || key.character == 'Y');
  const bool is_no = is_character && (key.character == 'n' || key.character == 'N');
  if (key.kind == Kind::kInterrupt) return AskToQuit(question_->intent.kind == Intent::Kind::kQuit);
  if (is_yes) return std::exchange(question_, std::nullopt)->intent;
  if (is_no || key.kind == Kind::kEscape) question_.reset();
  return {};
}

Intent ScreenModel::OnTableKey(const KeyPress& key) {
  switch (key.kind) {
    case Kind::kEnter:
      return Enter();
    case Kind::kLeft:
    case Kind::kRight:
      Fold(key.kind == Kind::kLeft);
      return {};
    case Kind::kEscape:
      is_progress_dismissed_ = content_.progress.state != ScriptRunner::State::kRunning;
      return {};
    case Kind::kCharacter:
      return OnTableCharacter(key.character);
    default:
      Move(key);
      return {};
  }
}

Intent ScreenModel::OnTableCharacter(char32_t character) {
  switch (character) {
    case 'f':
      mode_ = Mode::kOutput;
      paused_end_.reset();
      return {};
    case '/':
      search_.emplace();
      return {};
    case 'n':
      if (!searched_.empty()) SelectNext(selected_ + 1, &ScreenModel::MatchesSearch);
      return {};
    case '!':
      SelectNext(selected_ + 1, &ScreenModel::IsInTrouble);
      return {};
    case 'q':
      return AskToQuit(false);
    case 'j':
    case 'k':
      Move({.kind = Kind::kCharacter, .character = character});
      return {};
    default:
      return OnCommonCharacter(character);
  }
}

// What also works while an output is shown.
Intent ScreenModel::OnCommonCharacter(char32_t character) {
  switch (character) {
    case 's':
      return Order(Intent::Kind::kStart);
    case 't':
      return Order(Intent::Kind::kStop);
    case 'r':
      return Order(Intent::Kind::kRestart);
    case 'x':
      mode_ = Mode::kScripts;
      return {};
    case 'c':
      return AskToCommand();
    case 'o':
      if (snapshot().is_observer) return {};
      return Ask("Give no more orders and only observe? What runs goes on.",
                 {.kind = Intent::Kind::kStepBack});
    case '?':
    case 'h':
      mode_ = Mode::kHelp;
      help_top_ = 0;
      return {};
    default:
      return {};
  }
}

Intent ScreenModel::OnOutputKey(const KeyPress& key) {
  const std::int64_t page = std::max(rows_.page - 1, 1);
  const char32_t character = key.kind == Kind::kCharacter ? key.character : 0;
  if (key.kind == Kind::kUp || character == 'k') {
    ScrollOutput(-1);
  } else if (key.kind == Kind::kDown || character == 'j') {
    ScrollOutput(1);
  } else if (key.kind == Kind::kPageUp) {
    ScrollOutput(-page);
  } else if (key.kind == Kind::kPageDown || character == ' ') {
    ScrollOutput(page);
  } else if (key.kind == Kind::kHome) {
    ScrollOutput(SubjectLines().first() - SubjectLines().end());
  } else if (key.kind == Kind::kEnd || character == 'f') {
    paused_end_.reset();
  } else if (key.kind == Kind::kEscape || key.kind == Kind::kEnter || key.kind == Kind::kLeft ||
             character == 'q') {
    mode_ = Mode::kTable;
  } else if (character != 0) {
    return OnCommonCharacter(character);
  }
  return {};
}

Intent ScreenModel::OnScriptsKey(const KeyPress& key) {
  const bool runs = content_.progress.state == ScriptRunner::State::kRunning;
  const char32_t character = key.kind == Kind::kCharacter ? key.character : 0;
  if (key.kind == Kind::kEscape && runs) return {.kind = Intent::Kind::kAbortScript};
  if (key.kind == Kind::kEscape || character == 'q' || character == 'x') {
    mode_ = Mode::kTable;
  } else if (key.kind == Kind::kEnter) {
    return RunScript();
  } else if (character == 'c' || character == '?') {
    return OnCommonCharacter(character);
  } else if (!content_.scripts.empty()) {
    selected_script_ = MovedInList(selected_script_, key, content_.scripts.size(), rows_.page);
  }
  return {};
}

Intent ScreenModel::OnHelpKey(const KeyPress& key) {
  const std::size_t before = help_top_;
  const auto tops = static_cast<std::size_t>(std::max(rows_.help_top, 0)) + 1;
  help_top_ = MovedInList(std::min(before, tops - 1), key, tops, rows_.page);
  const bool is_character = key.kind == Kind::kCharacter;
  if (help_top_ == before &&
      (is_character || key.kind == Kind::kEscape || key.kind == Kind::kEnter)) {
    mode_ = Mode::kTable;
  }
  return {};
}

Intent ScreenModel::Enter() {
  const TreeLine& line = lines_[selected_];
  if (line.kind == TreeLine::Kind::kGroup) {
    Fold(!line.is_folded);
    return {};
  }
  mode_ = Mode::kOutput;
  paused_end_.reset();
  return {};
}

const CommandView* ScreenModel::Subject() const {
  const TreeLine& line = lines_[selected_];
  return line.kind == TreeLine::Kind::kCommand ? &snapshot().commands[line.index] : nullptr;
}

const OutputLines& ScreenModel::SubjectLines() const {
  static const OutputLines kNone;
  const CommandView* command = Subject();
  if (command == nullptr) return messages_;
  const OutputLines* lines = output_.Find(command->id);
  return lines == nullptr ? kNone : *lines;
}

std::int64_t ScreenModel::output_end() const {
  const OutputLines& lines = SubjectLines();
  if (!paused_end_) return lines.end();
  return std::clamp(*paused_end_, std::min(lines.first() + 1, lines.end()), lines.end());
}

void ScreenModel::ScrollOutput(std::int64_t by) {
  const OutputLines& lines = SubjectLines();
  // A page at the top is full where there are as many lines.
  const std::int64_t least = std::min(lines.first() + rows_.page, lines.end());
  const std::int64_t end = std::max(output_end() + by, least);
  paused_end_.reset();
  if (end < lines.end()) paused_end_ = end;
}

bool ScreenModel::shows_progress() const {
  return content_.progress.state != ScriptRunner::State::kIdle && !is_progress_dismissed_;
}

}  // namespace clearway::screen
