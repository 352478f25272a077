// SPDX-License-Identifier: BSD-3-Clause
// What of the tree is selected, found, folded and in sight.
#include <algorithm>
#include <utility>

#include "processes/procman_sheriff/screen_model.hpp"

namespace clearway::screen {
namespace {

using core::procman::CommandView;
using core::procman::ScriptRunner;
using Kind = KeyPress::Kind;

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

std::size_t MovedInList(std::size_t from, const KeyPress& key, std::size_t size, int page) {
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
  selected_ = MovedInList(selected_, key, lines_.size(), rows_.table);
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

}  // namespace clearway::screen
