// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/screen_model.hpp"

#include <algorithm>
#include <utility>

namespace clearway::screen {
namespace {

using core::procman::CommandView;
using core::procman::ScriptRunner;
using core::procman::Status;
using Kind = KeyPress::Kind;

// Of a list of `size` > 0.
std::size_t Moved(std::size_t from, const KeyPress& key, std::size_t size, int page) {
  const auto rows = static_cast<std::size_t>(std::max(page, 1));
  const std::size_t last = size - 1;
  const bool is_j = key.kind == Kind::kCharacter && key.character == 'j';
  const bool is_k = key.kind == Kind::kCharacter && key.character == 'k';
  if (key.kind == Kind::kUp || is_k) return from == 0 ? 0 : from - 1;
  if (key.kind == Kind::kDown || is_j) return std::min(from + 1, last);
  if (key.kind == Kind::kPageUp) return from < rows ? 0 : from - rows;
  if (key.kind == Kind::kPageDown) return std::min(from + rows, last);
  if (key.kind == Kind::kHome) return 0;
  if (key.kind == Kind::kEnd) return last;
  return from;
}

std::string LowerCase(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

// The same line of another snapshot. A command has one line on each deputy that runs a copy of it.
bool IsSame(const TreeLine& a,
            const CommandView* command_a,
            const TreeLine& b,
            const CommandView* command_b) {
  if (a.kind != b.kind) return false;
  if (a.kind != TreeLine::Kind::kCommand) return a.path == b.path;
  return a.name == b.name && command_a->is_stray == command_b->is_stray &&
         (!command_a->is_stray || command_a->deputy == command_b->deputy);
}

const CommandView* CommandOf(const TreeLine& line, const core::procman::Snapshot& snapshot) {
  return line.kind == TreeLine::Kind::kCommand ? &snapshot.commands[line.index] : nullptr;
}

}  // namespace

void ScreenModel::Take(ScreenContent content) {
  std::vector<TreeLine> lines = TreeOf(content.snapshot, folded_);
  if (!lines_.empty()) {
    const TreeLine& old = lines_[selected_];
    const CommandView* old_command = CommandOf(old, snapshot());
    const auto found = std::find_if(lines.begin(), lines.end(), [&](const TreeLine& line) {
      return IsSame(line, CommandOf(line, content.snapshot), old, old_command);
    });
    if (found != lines.end()) {
      selected_ = static_cast<std::size_t>(found - lines.begin());
    } else if (mode_ == Mode::kOutput) {
      mode_ = Mode::kTable;  // What it belongs to is gone.
    }
  }
  const bool is_new_script = content.progress.script != content_.progress.script ||
                             content.progress.state == ScriptRunner::State::kRunning;
  if (is_new_script) is_progress_dismissed_ = false;
  lines_ = std::move(lines);
  content_ = std::move(content);
  selected_ = std::min(selected_, lines_.size() - 1);
  const std::size_t scripts = content_.scripts.size();
  selected_script_ = scripts == 0 ? 0 : std::min(selected_script_, scripts - 1);
  ShowSelected();
}

void ScreenModel::Fit(const ScreenRows& rows) {
  rows_ = rows;
  ShowSelected();
}

void ScreenModel::ShowSelected() {
  const auto rows = static_cast<std::size_t>(std::max(rows_.table, 1));
  if (selected_ < top_) top_ = selected_;
  if (selected_ >= top_ + rows) top_ = selected_ - rows + 1;
  top_ = lines_.size() <= rows ? 0 : std::min(top_, lines_.size() - rows);
}

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

void ScreenModel::Search(const KeyPress& key) {
  if (key.kind == Kind::kEnter || key.kind == Kind::kEscape) {
    search_.reset();
    return;
  }
  if (key.kind == Kind::kBackspace) {
    if (!search_->empty()) search_->pop_back();
  } else if (key.kind == Kind::kCharacter && key.character >= 0x20 && key.character < 0x7F) {
    *search_ += static_cast<char>(key.character);
  } else {
    return Move(key);
  }
  searched_ = LowerCase(*search_);
  if (!searched_.empty()) SelectNext(selected_, &ScreenModel::MatchesSearch);
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
    selected_script_ = Moved(selected_script_, key, content_.scripts.size(), rows_.page);
  }
  return {};
}

Intent ScreenModel::OnHelpKey(const KeyPress& key) {
  const std::size_t before = help_top_;
  const auto tops = static_cast<std::size_t>(std::max(rows_.help_top, 0)) + 1;
  help_top_ = Moved(std::min(before, tops - 1), key, tops, rows_.page);
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

void ScreenModel::Fold(bool is_folded) {
  const TreeLine& line = lines_[selected_];
  if (line.kind == TreeLine::Kind::kEverything || line.path.empty()) return;
  if (!is_folded) {
    folded_.erase(line.path);
  } else {
    folded_.insert(line.path);
    // Of a command its group is folded, and selected.
    while (lines_[selected_].kind != TreeLine::Kind::kGroup ||
           lines_[selected_].path != line.path) {
      --selected_;
    }
  }
  Take(content_);
}

void ScreenModel::Move(const KeyPress& key) {
  selected_ = Moved(selected_, key, lines_.size(), rows_.table);
  ShowSelected();
}

void ScreenModel::SelectNext(std::size_t from, bool (ScreenModel::*matches)(std::size_t) const) {
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const std::size_t line = (from + i) % lines_.size();
    if (!(this->*matches)(line)) continue;
    selected_ = line;
    ShowSelected();
    return;
  }
  SetNotice(matches == &ScreenModel::IsInTrouble ? "Nothing is in trouble." : "Not found.");
}

bool ScreenModel::IsInTrouble(std::size_t line) const {
  const TreeLine& tree_line = lines_[line];
  if (tree_line.kind == TreeLine::Kind::kCommand) {
    return core::procman::IsTrouble(snapshot().commands[tree_line.index].status);
  }
  return tree_line.is_folded && snapshot().groups[tree_line.index].trouble > 0;
}

bool ScreenModel::MatchesSearch(std::size_t line) const {
  return LowerCase(lines_[line].name).find(searched_) != std::string::npos;
}

const CommandView* ScreenModel::Subject() const {
  return CommandOf(lines_[selected_], snapshot());
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
