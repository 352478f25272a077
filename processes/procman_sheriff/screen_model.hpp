// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/core/procman/deployment.hpp"
#include "common/core/procman/script_runner.hpp"
#include "common/core/procman/sheriff_view.hpp"
#include "processes/procman_sheriff/output_lines.hpp"
#include "processes/procman_sheriff/screen_tree.hpp"

namespace clearway::screen {

struct KeyPress {
  enum class Kind {
    kCharacter,
    kUp,
    kDown,
    kLeft,
    kRight,
    kPageUp,
    kPageDown,
    kHome,
    kEnd,
    kEnter,
    kEscape,
    kBackspace,
    kInterrupt,  ///< Ctrl-C.
    kRedraw,     ///< Ctrl-L.
    kOther,
  };
  Kind kind = Kind::kOther;
  char32_t character = 0;  ///< kCharacter only.
};

/// What a key asks for that is not the view's own affair.
struct Intent {
  enum class Kind {
    kNone,
    kStart,
    kStop,
    kRestart,
    kRunScript,
    kAbortScript,
    kTakeCommand,
    kStepBack,  ///< Become an observer.
    kRedraw,
    kQuit,
  };
  Kind kind = Kind::kNone;
  core::procman::Target target{};  ///< The first three only.
  bool force = false;              ///< Likewise.
  std::string script{};            ///< kRunScript only.
};

/// The script that runs or ran last.
struct ScriptProgress {
  core::procman::ScriptRunner::State state = core::procman::ScriptRunner::State::kIdle;
  std::string script{};
  std::string text{};
  std::vector<std::string> awaited{};
  std::int64_t elapsed_us = 0;  ///< To now or to its end.
};

/// All that is shown.
struct ScreenContent {
  core::procman::Snapshot snapshot{};
  std::vector<core::procman::Script> scripts{};
  ScriptProgress progress{};
  /// Not known yet whether another sheriff is in command: until then an observer that is about to
  /// take command.
  bool is_looking = false;
};

/// Which rows the parts of the view have; what it takes to scroll.
struct ScreenRows {
  int table = 1;
  int page = 1;      ///< Of a full-screen list or output.
  int help_top = 0;  ///< The most that the help can be scrolled.
};

/// Where a key leads from `from` in a list of `size` > 0 lines of which `page` are shown.
[[nodiscard]] std::size_t MovedInList(std::size_t from,
                                      const KeyPress& key,
                                      std::size_t size,
                                      int page);

/// What a user of the full-screen view sees and does: selection, mode, scrolling, questions. Knows
/// no terminal, no sheriff and no clock. Each key changes the state and may return an intent, which
/// is the caller's to carry out. Not for several threads.
class ScreenModel {
 public:
  enum class Mode { kTable, kOutput, kScripts, kHelp };

  /// @pre `output` outlives the model.
  explicit ScreenModel(const OutputStore& output, const OutputLines& messages)
      : output_(output), messages_(messages) {
    Take({});
  }

  /// The selection stays with what was selected, wherever that is now.
  void Take(ScreenContent content);
  void Fit(const ScreenRows& rows);
  [[nodiscard]] Intent OnKey(const KeyPress& key);

  /// Shown in place of the keys until a key is pressed or an empty one is set.
  void SetNotice(std::string notice) { notice_ = std::move(notice); }

  [[nodiscard]] const ScreenContent& content() const { return content_; }
  [[nodiscard]] const core::procman::Snapshot& snapshot() const { return content_.snapshot; }
  [[nodiscard]] Mode mode() const { return mode_; }
  [[nodiscard]] const std::vector<TreeLine>& lines() const { return lines_; }
  [[nodiscard]] std::size_t selected() const { return selected_; }
  [[nodiscard]] std::size_t top() const { return top_; }  ///< First line shown.
  [[nodiscard]] const std::string& notice() const { return notice_; }
  /// Asked for y or n; empty: nothing is asked.
  [[nodiscard]] std::string question() const { return question_ ? question_->text : ""; }
  /// What is searched for while it is typed.
  [[nodiscard]] const std::optional<std::string>& search() const { return search_; }

  /// The command whose output is shown; null: messages are.
  [[nodiscard]] const core::procman::CommandView* Subject() const;
  /// Never null.
  [[nodiscard]] const OutputLines& SubjectLines() const;
  /// One after the last line shown of an output on the full screen; it follows where it is the end.
  [[nodiscard]] std::int64_t output_end() const;
  [[nodiscard]] bool follows() const { return !paused_end_; }

  [[nodiscard]] std::size_t selected_script() const { return selected_script_; }
  [[nodiscard]] std::size_t help_top() const { return help_top_; }
  /// Whether to show how the script goes or ended.
  [[nodiscard]] bool shows_progress() const;

 private:
  struct Question {
    std::string text;
    Intent intent;
  };

  [[nodiscard]] Intent Answer(const KeyPress& key);
  void Search(const KeyPress& key);
  [[nodiscard]] Intent OnTableKey(const KeyPress& key);
  [[nodiscard]] Intent OnOutputKey(const KeyPress& key);
  [[nodiscard]] Intent OnScriptsKey(const KeyPress& key);
  [[nodiscard]] Intent OnHelpKey(const KeyPress& key);
  [[nodiscard]] Intent OnCommonCharacter(char32_t character);
  [[nodiscard]] Intent OnTableCharacter(char32_t character);

  [[nodiscard]] Intent Ask(std::string text, Intent intent);
  [[nodiscard]] Intent AskToQuit(bool is_sure);
  [[nodiscard]] Intent AskToCommand();
  [[nodiscard]] Intent Order(Intent::Kind kind);
  [[nodiscard]] Intent OrderOne(Intent intent, const core::procman::CommandView& command);
  [[nodiscard]] Intent RunScript();
  [[nodiscard]] Intent Enter();
  void Fold(bool is_folded);
  void Move(const KeyPress& key);
  void SelectNext(std::size_t from, bool (ScreenModel::*matches)(std::size_t) const);
  [[nodiscard]] bool IsInTrouble(std::size_t line) const;
  [[nodiscard]] bool MatchesSearch(std::size_t line) const;
  void ShowSelected();
  void ScrollOutput(std::int64_t by);

  const OutputStore& output_;
  const OutputLines& messages_;
  ScreenContent content_;
  ScreenRows rows_;
  Mode mode_ = Mode::kTable;
  std::set<std::string> folded_;
  std::vector<TreeLine> lines_;
  std::size_t selected_ = 0;
  std::size_t top_ = 0;
  std::optional<std::int64_t> paused_end_;
  std::size_t selected_script_ = 0;
  std::size_t help_top_ = 0;
  bool is_progress_dismissed_ = false;
  std::optional<Question> question_;
  std::optional<std::string> search_;
  std::string searched_;
  std::string notice_;
};

}  // namespace clearway::screen
