// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <string_view>

#include "processes/procman_sheriff/screen_parts.hpp"
#include "processes/procman_sheriff/text_cells.hpp"

namespace clearway::screen {
namespace {

using core::procman::CommandView;
using core::procman::ScriptAction;
using core::procman::ScriptRunner;
using core::procman::Target;

constexpr int kMostReasonLines = 2;

constexpr std::array<std::string_view, 34> kHelp = {
    "MOVE     Up Down PgUp PgDn Home End, also j k",
    "         Left and Right fold and unfold a group; so does Enter on it",
    "         / finds a name, n the next; ! goes to the next one in trouble",
    "",
    "ORDER    s start, t stop, r restart what is selected: a command, a group",
    "         with all below it, or everything. Orders go out at once. Stop and",
    "         restart of more than one command ask first. A start lets run what",
    "         runs already.",
    "         A host that is silent gets its orders as soon as it is heard.",
    "",
    "OUTPUT   Enter or f shows the output of the selected command on the whole",
    "         screen, and that of everything: messages. It follows until you go",
    "         up; End follows again. Long lines go on in the next row.",
    "         2000 lines of each command are kept, from when this view began;",
    "         a host's log may have more.",
    "",
    "SCRIPTS  x lists those of the file. Enter runs one, Esc aborts it: what it",
    "         has started goes on running.",
    "",
    "COMMAND  One sheriff gives orders, any number may observe. c takes command,",
    "         o gives it up. Of two in command the last order wins: the title",
    "         warns of that.",
    "",
    "MARKS    !  trouble: Failed, Unhealthy, Backing off, Gave up, Refused",
    "         ~  on its way: Starting, Getting ready, Restarting, Stopping,",
    "            Moving, Removing",
    "         ?  unknown: its host is not heard",
    "         none: Running, and ready as far as its host can tell; or Stopped",
    "",
    "QUIT     q. What runs goes on running: the deputies look after it, with or",
    "         without a sheriff. The same holds when this terminal is closed.",
    "",
    "CPU%     of all processors of the host together. STARTS: since its deputy has",
    "         known the command.",
};

Style StyleOfLine(const OutputLines::Line& line) {
  return line.is_mark ? Style::kDim : Style::kPlain;
}

// The command without the settings of its environment that stand before it.
std::string_view ProgramOf(std::string_view exec) {
  while (true) {
    const std::string_view word = exec.substr(0, exec.find(' '));
    const bool is_setting = word.find('=') != std::string_view::npos &&
                            word.find_first_of("'\"\\") == std::string_view::npos;
    if (!is_setting || word.size() == exec.size()) return exec;
    exec.remove_prefix(word.size() + 1);
  }
}

std::string SubjectTitle(const ScreenModel& model) {
  const CommandView* command = model.Subject();
  if (command == nullptr) return "MESSAGES";
  std::string title = "OUTPUT of " + command->id + " on " + command->deputy;
  if (command->dropped_output_bytes > 0) {
    title += ", without " + BytesInWords(command->dropped_output_bytes) + " that were too much";
  }
  return title + ": " + std::string(ProgramOf(command->exec));
}

Line NoLines(const ScreenModel& model, int width) {
  return LineWriter(width)
      .Add(model.Subject() == nullptr ? "(no messages yet)" : "(no output since this view began)",
           Style::kDim)
      .Take();
}

// The last lines before `end`, wrapped: at most `rows`.
Lines WrappedBefore(const OutputLines& output, std::int64_t end, int width, int rows) {
  Lines reversed;
  const auto enough = static_cast<std::size_t>(std::max(rows, 0));
  for (std::int64_t i = end; i > output.first() && reversed.size() < enough; --i) {
    const OutputLines::Line& line = output.At(i - 1);
    std::vector<std::string> pieces = Wrapped(line.text, width);
    for (auto piece = pieces.rbegin(); piece != pieces.rend() && reversed.size() < enough;
         ++piece) {
      reversed.push_back(LineWriter(width).Add(*piece, StyleOfLine(line)).Take());
    }
  }
  std::reverse(reversed.begin(), reversed.end());
  return reversed;
}

std::string NameOf(const Target& target) {
  switch (target.kind) {
    case Target::Kind::kCommand:
      return "cmd " + target.name;
    case Target::Kind::kGroup:
      return "group " + target.name;
    case Target::Kind::kEverything:
      break;
  }
  return "everything";
}

std::string WordFor(ScriptAction::Status status) {
  return status == ScriptAction::Status::kStopped ? "stopped" : "running";
}

std::string TextOf(const ScriptAction& action) {
  const bool waits = action.wait != ScriptAction::Status::kNone;
  const std::string wait = waits ? ", wait until " + WordFor(action.wait) : "";
  switch (action.kind) {
    case ScriptAction::Kind::kStart:
      return "start " + NameOf(action.target) + wait;
    case ScriptAction::Kind::kStop:
      return "stop " + NameOf(action.target) + wait;
    case ScriptAction::Kind::kRestart:
      return "restart " + NameOf(action.target) + wait;
    case ScriptAction::Kind::kWaitTime:
      return "wait " + std::to_string(action.duration_ms) + " ms";
    case ScriptAction::Kind::kWaitStatus:
      return "wait until " + NameOf(action.target) + " is " + WordFor(action.wait);
    case ScriptAction::Kind::kRunScript:
      break;
  }
  return "run script " + action.script;
}

std::string WordFor(ScriptRunner::State state) {
  switch (state) {
    case ScriptRunner::State::kRunning:
      return "is running";
    case ScriptRunner::State::kDone:
      return "is done";
    case ScriptRunner::State::kFailed:
      return "FAILED";
    case ScriptRunner::State::kTimedOut:
      return "TIMED OUT";
    case ScriptRunner::State::kAborted:
      return "was ABORTED";
    case ScriptRunner::State::kIdle:
      break;
  }
  return "";
}

Lines ProgressLines(const ScreenModel& model, int width) {
  const ScriptProgress& progress = model.content().progress;
  Lines lines;
  if (progress.state == ScriptRunner::State::kIdle) return lines;
  lines.push_back(HeaderLine("SCRIPT " + progress.script + " " + WordFor(progress.state) + ", " +
                                 TimeInWords(progress.elapsed_us),
                             width));
  const bool is_bad = progress.state == ScriptRunner::State::kFailed ||
                      progress.state == ScriptRunner::State::kTimedOut;
  if (!progress.text.empty() && progress.state != ScriptRunner::State::kAborted) {
    for (const std::string& piece : Wrapped(Printable(progress.text), std::max(width - 3, 2))) {
      lines.push_back(LineWriter(width)
                          .Add(is_bad ? " ! " : "   ", Style::kTrouble)
                          .Add(piece, is_bad ? Style::kTrouble : Style::kPlain)
                          .Take());
    }
  }
  for (const CommandView& command : model.snapshot().commands) {
    const auto& awaited = progress.awaited;
    if (std::find(awaited.begin(), awaited.end(), command.id) == awaited.end()) continue;
    lines.push_back(
        LineWriter(width)
            .Add(" " + std::string(1, MarkOf(command.status)) + " ", StyleOf(command.status))
            .Add(command.id + ": ")
            .Add(WordsFor(command.status), StyleOf(command.status))
            .Add("  " + ReasonOf(command))
            .Take());
  }
  return lines;
}

// `size` lines of which the one selected is to be seen in `rows`.
std::size_t FirstShown(std::size_t selected, std::size_t rows) {
  return selected < rows ? 0 : selected - rows + 1;
}

}  // namespace

Lines PaneLines(const ScreenModel& model, int width, int rows) {
  Lines lines;
  if (rows <= 0) return lines;
  lines.push_back(HeaderLine(SubjectTitle(model), width));
  // The reason in full: the table has cut it.
  if (const CommandView* command = model.Subject(); command != nullptr && rows > 2) {
    const std::string reason = Printable(ReasonOf(*command));
    int reasons = 0;
    for (const std::string& piece : Wrapped(reason, std::max(width, 2))) {
      if (reason.empty() || reasons++ == kMostReasonLines || reasons > rows - 2) break;
      lines.push_back(LineWriter(width).Add(piece, StyleOf(command->status)).Take());
    }
  }
  const OutputLines& output = model.SubjectLines();
  const auto left = static_cast<std::int64_t>(rows) - static_cast<std::int64_t>(lines.size());
  if (output.end() == output.first() && left > 0) lines.push_back(NoLines(model, width));
  for (std::int64_t i = std::max(output.first(), output.end() - left); i < output.end(); ++i) {
    const OutputLines::Line& line = output.At(i);
    lines.push_back(LineWriter(width).Add(line.text, StyleOfLine(line)).Take());
  }
  lines.resize(static_cast<std::size_t>(rows));
  return lines;
}

Lines OutputPage(const ScreenModel& model, int width, int rows) {
  const OutputLines& output = model.SubjectLines();
  const std::int64_t newer = output.end() - model.output_end();
  const std::string right =
      model.follows() ? " follows" : " WAITS: " + std::to_string(newer) + " newer lines, End: on";
  Lines lines{HeaderLine(Shortened(Printable(SubjectTitle(model)),
                                   std::max(width - static_cast<int>(right.size()) - 1, 0)),
                         width,
                         right)};
  if (output.end() == output.first()) lines.push_back(NoLines(model, width));
  for (Line& line : WrappedBefore(output, model.output_end(), std::max(width, 2), rows)) {
    lines.push_back(std::move(line));
  }
  return lines;
}

Lines ScriptsPage(const ScreenModel& model, int width, int rows) {
  const auto& scripts = model.content().scripts;
  Lines lines{HeaderLine("SCRIPTS of " + model.snapshot().file, width)};
  if (scripts.empty()) {
    lines.push_back(LineWriter(width).Add("   The file has no scripts.", Style::kDim).Take());
    return lines;
  }
  Lines progress = ProgressLines(model, width);
  const auto all = static_cast<std::size_t>(std::max(rows, 0));
  progress.resize(std::min(progress.size(), all / 2));
  const std::size_t left = all - progress.size();
  const std::size_t listed = std::min(scripts.size(), std::max<std::size_t>(left / 2, 1));
  const std::size_t first = FirstShown(model.selected_script(), listed);
  for (std::size_t i = first; i < first + listed; ++i) {
    const bool is_selected = i == model.selected_script();
    lines.push_back(LineWriter(width)
                        .Add(is_selected ? " > " : "   ", Style::kStrong)
                        .Add(scripts[i].name, Style::kStrong)
                        .Take());
    lines.back().is_selected = is_selected;
  }
  for (Line& line : progress) lines.push_back(std::move(line));
  const auto& script = scripts[model.selected_script()];
  lines.push_back(HeaderLine("STEPS of " + script.name, width));
  for (const ScriptAction& action : script.actions) {
    if (lines.size() > all) break;
    lines.push_back(LineWriter(width).Add("   " + TextOf(action)).Take());
  }
  return lines;
}

int HelpLines() {
  return static_cast<int>(kHelp.size());
}

Lines HelpPage(const ScreenModel& model, int width, int rows) {
  Lines lines{HeaderLine("HELP", width)};
  const auto shown = static_cast<std::size_t>(std::max(rows, 0));
  const std::size_t last_top = kHelp.size() > shown ? kHelp.size() - shown : 0;
  const std::size_t top = std::min(model.help_top(), last_top);
  for (std::size_t i = top; i < std::min(top + shown, kHelp.size()); ++i) {
    lines.push_back(LineWriter(width).Add(kHelp[i]).Take());
  }
  return lines;
}

}  // namespace clearway::screen
