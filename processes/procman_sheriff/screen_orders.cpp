// SPDX-License-Identifier: BSD-3-Clause
// What ScreenModel asks before it hands on an intent.
#include <utility>

#include "processes/procman_sheriff/screen_model.hpp"
#include "processes/procman_sheriff/text_cells.hpp"

namespace clearway::screen {
namespace {

using core::procman::CommandView;
using core::procman::ScriptRunner;
using core::procman::Status;

std::string Count(int count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string Sentence(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') {
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  }
  if (!text.empty() && text.back() != '.') text += '.';
  return text;
}

}  // namespace

Intent ScreenModel::Ask(std::string text, Intent intent) {
  question_ = Question{std::move(text), std::move(intent)};
  return {};
}

Intent ScreenModel::Order(Intent::Kind kind) {
  const TreeLine& line = lines_[selected_];
  if (snapshot().is_observer) {
    SetNotice(content_.is_looking ? "Looking for other sheriffs: try again in a second."
                                  : "An observer gives no orders. Press c to take command.");
    return {};
  }
  Intent intent{.kind = kind, .target = line.target()};
  if (const CommandView* command = Subject()) return OrderOne(std::move(intent), *command);
  const auto& group = snapshot().groups[line.index];
  if (group.commands == 0) {
    SetNotice("There is no command yet.");
    return {};
  }
  if (kind == Intent::Kind::kStart) return intent;
  const std::string what =
      line.kind == TreeLine::Kind::kEverything ? "everything" : "group " + Printable(line.path);
  return Ask((kind == Intent::Kind::kStop ? "Stop " : "Restart ") + what + " (" +
                 Count(group.commands, "command") + ", " + std::to_string(group.up) + " running)?",
             std::move(intent));
}

Intent ScreenModel::OrderOne(Intent intent, const CommandView& command) {
  // Waits for a deputy that may never come back: only somebody who knows that nothing runs there
  // any more may go on.
  if (command.status != Status::kMoving || intent.kind == Intent::Kind::kStop) return intent;
  intent.force = true;
  return Ask(Sentence(Printable(command.text)) + " Start it on " + Printable(command.deputy) +
                 " without waiting?",
             std::move(intent));
}

Intent ScreenModel::AskToCommand() {
  if (!snapshot().is_observer) {
    SetNotice("In command already.");
    return {};
  }
  Intent intent{.kind = Intent::Kind::kTakeCommand};
  if (!snapshot().other) return intent;
  return Ask("Sheriff " + Printable(snapshot().other->id) + " gives orders. Take command from it?",
             std::move(intent));
}

Intent ScreenModel::AskToQuit(bool is_sure) {
  Intent quit{.kind = Intent::Kind::kQuit};
  if (is_sure || snapshot().is_observer) return quit;
  if (content_.progress.state == ScriptRunner::State::kRunning) {
    return Ask(
        "Script " + Printable(content_.progress.script) + " is running and stops half-way. Quit?",
        quit);
  }
  int on_their_way = 0;
  std::string first;
  for (const CommandView& command : snapshot().commands) {
    if (!IsOnItsWay(command.status)) continue;
    if (on_their_way++ == 0) {
      first = Printable(command.id) + ": " + std::string(WordsFor(command.status));
    }
  }
  if (on_their_way == 0) return quit;
  return Ask("Orders are not carried out yet (" + first +
                 (on_their_way > 1 ? ", and " + std::to_string(on_their_way - 1) + " more" : "") +
                 "). Quit?",
             std::move(quit));
}

Intent ScreenModel::RunScript() {
  if (content_.scripts.empty()) return {};
  if (snapshot().is_observer) {
    SetNotice("An observer runs no scripts. Press c to take command.");
    return {};
  }
  Intent intent;
  intent.kind = Intent::Kind::kRunScript;
  intent.script = content_.scripts[selected_script_].name;
  if (content_.progress.state != ScriptRunner::State::kRunning) return intent;
  std::string question = "Script " + Printable(content_.progress.script) +
                         " is running. Abort it and run " + Printable(intent.script) + "?";
  return Ask(std::move(question), std::move(intent));
}

}  // namespace clearway::screen
