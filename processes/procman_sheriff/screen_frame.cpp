// SPDX-License-Identifier: BSD-3-Clause
// The lines around all pages.
#include <algorithm>
#include <iterator>

#include "processes/procman_sheriff/screen_parts.hpp"
#include "processes/procman_sheriff/text_cells.hpp"

namespace clearway::screen {
namespace {

using core::procman::ScriptRunner;

// "host:pid:utime" without the time.
std::string ShortId(const std::string& sheriff_id) {
  return sheriff_id.substr(0, sheriff_id.rfind(':'));
}

struct Piece {
  std::string text;
  Style style = Style::kTitle;
};

int WidthOf(const std::vector<Piece>& pieces) {
  int width = 0;
  for (const Piece& piece : pieces) {
    width += CellsOf(std::string_view(piece.text)) + (piece.text.empty() ? 0 : 2);
  }
  return width;
}

std::string Counted(int count, const std::string& what) {
  return count == 0 ? "" : std::to_string(count) + " " + what;
}

std::vector<Piece> TitlePieces(const ScreenModel& model, const std::string& clock) {
  const auto& snapshot = model.snapshot();
  const auto& all = snapshot.groups.empty() ? core::procman::GroupView{} : snapshot.groups.front();
  const auto silent = std::count_if(snapshot.deputies.begin(),
                                    snapshot.deputies.end(),
                                    [](const auto& deputy) { return !deputy.is_heard; });
  const std::string hosts = silent == 1 ? "HOST SILENT" : "HOSTS SILENT";
  return {{Printable(snapshot.file.empty() ? "clearway-sheriff" : snapshot.file)},
          {std::to_string(all.ready) + "/" + std::to_string(all.commands) + " ready"},
          {Counted(all.trouble, "IN TROUBLE"), Style::kBanner},
          {Counted(static_cast<int>(silent), hosts), Style::kBanner},
          {model.content().is_looking ? "looking"
           : snapshot.is_observer     ? "observer"
                                      : "in command"},
          {Printable(ShortId(snapshot.sheriff_id))},
          {clock}};
}

std::string Progress(const ScreenModel& model) {
  const auto& progress = model.content().progress;
  const std::string name = "script " + progress.script;
  const bool has_text = !progress.text.empty() && progress.state != ScriptRunner::State::kAborted;
  const std::string text = has_text ? ": " + progress.text : "";
  switch (progress.state) {
    case ScriptRunner::State::kRunning:
      return name + " is running, " + TimeInWords(progress.elapsed_us) + text;
    case ScriptRunner::State::kDone:
      return name + " is done" + text;
    case ScriptRunner::State::kFailed:
      return name + " FAILED" + text;
    case ScriptRunner::State::kTimedOut:
      return name + " TIMED OUT" + text;
    case ScriptRunner::State::kAborted:
      return name + " was ABORTED" + text;
    case ScriptRunner::State::kIdle:
      break;
  }
  return "";
}

bool IsBad(ScriptRunner::State state) {
  return state == ScriptRunner::State::kFailed || state == ScriptRunner::State::kTimedOut;
}

Line Banner(const std::string& text, int width, Style style = Style::kBanner) {
  return LineWriter(width).Add(" " + text, style).Fill(style).Take();
}

// Words between keys are plain, keys are strong: "s start  t stop".
Line KeysOf(const std::vector<std::pair<std::string, std::string>>& keys, int width) {
  LineWriter line(width);
  for (const auto& [key, meaning] : keys) {
    const int cells = static_cast<int>(key.size() + meaning.size()) + 2;
    if (line.left() < cells) continue;
    line.Add(line.column() == 0 ? " " : "  ").Add(key, Style::kStrong).Add(" " + meaning);
  }
  return line.Take();
}

std::vector<std::pair<std::string, std::string>> KeysFor(const ScreenModel& model) {
  const bool observes = model.snapshot().is_observer;
  switch (model.mode()) {
    case ScreenModel::Mode::kOutput:
      return {{"Esc", "back"},
              {"Up/PgUp", "earlier, waits"},
              {"End", "follow"},
              {"s", "start"},
              {"t", "stop"},
              {"r", "restart"}};
    case ScreenModel::Mode::kScripts:
      if (model.content().progress.state == ScriptRunner::State::kRunning) {
        return {{"Esc", "abort the script"}, {"q", "back, it goes on"}};
      }
      return {{"Enter", "run"}, {"Up/Down", "choose"}, {"Esc", "back"}};
    case ScreenModel::Mode::kHelp:
      return {{"Up/Down", "scroll"}, {"any other key", "back"}};
    case ScreenModel::Mode::kTable:
      break;
  }
  // Those that come first are there at any width.
  if (observes) {
    return {{"Enter", "output"},
            {"c", "take command"},
            {"?", "help"},
            {"q", "quit"},
            {"!", "trouble"},
            {"/", "find"}};
  }
  return {{"s", "start"},
          {"t", "stop"},
          {"r", "restart"},
          {"Enter", "output"},
          {"x", "scripts"},
          {"?", "help"},
          {"q", "quit"},
          {"!", "trouble"},
          {"/", "find"}};
}

}  // namespace

Line TitleLine(const ScreenModel& model, int width, const std::string& clock) {
  std::vector<Piece> pieces = TitlePieces(model, clock);
  // In this order they make room: the file's folder, the sheriff's id, the clock, the mode, what is
  // ready.
  std::string& file = pieces[0].text;
  if (WidthOf(pieces) > width) file.erase(0, file.rfind('/') + 1);
  for (const std::size_t i : {5U, 6U, 4U, 1U}) {
    if (WidthOf(pieces) <= width) break;
    pieces[i].text.clear();
  }
  const int too_many = WidthOf(pieces) - width;
  if (too_many > 0) {
    const int keep = std::max(CellsOf(std::string_view(file)) - too_many - 2, 8);
    while (CellsOf(std::string_view(file)) > keep) file.erase(0, FirstCharacter(file).bytes);
    file.insert(0, "..");
  }
  LineWriter line(width);
  const int right = WidthOf({pieces[4], pieces[5], pieces[6]});
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (i == 4) line.SkipTo(width - right, Style::kTitle);
    if (pieces[i].text.empty()) continue;
    line.Add(" ", Style::kTitle).Add(pieces[i].text, pieces[i].style).Add(" ", Style::kTitle);
  }
  return line.Fill(Style::kTitle).Take();
}

Lines BannerLines(const ScreenModel& model, int width) {
  const auto& snapshot = model.snapshot();
  const auto& other = snapshot.other;
  Lines lines;
  if (model.content().is_looking) {
    // A second, which needs no banner that jumps in and out.
  } else if (snapshot.is_observer) {
    lines.push_back(Banner(
        other ? "OBSERVER: no orders from here; sheriff " + ShortId(other->id) + " is in command"
              : "OBSERVER: no orders from here, and no other sheriff is heard; c takes command",
        width));
  } else if (other) {
    lines.push_back(Banner("ANOTHER SHERIFF IS ACTIVE: " + ShortId(other->id) + ", " +
                               TimeInWords(other->age_us) +
                               " ago; o steps back. The last order wins",
                           width));
  }
  const bool is_on_its_page = model.mode() == ScreenModel::Mode::kScripts;
  if (model.shows_progress() && !is_on_its_page) {
    const Style style = IsBad(model.content().progress.state) ? Style::kBanner : Style::kStrong;
    lines.push_back(Banner(Progress(model), width, style));
  }
  return lines;
}

Line HeaderLine(const std::string& text, int width, const std::string& right) {
  LineWriter line(width);
  // What is to the right is news, what is to the left is known.
  const std::string news = Shortened(Printable(right), width);
  const int room = width - CellsOf(std::string_view(news));
  line.Add(FirstCells(Printable(text), room), Style::kHeader).SkipTo(room, Style::kHeader);
  return line.Add(news, Style::kHeader).Take();
}

Line KeysLine(const ScreenModel& model, int width) {
  if (const std::string question = model.question(); !question.empty()) {
    // The answers are always to be seen.
    const std::string answers = " y/n ";
    const int room = std::max(width - static_cast<int>(answers.size()) - 1, 0);
    return LineWriter(width)
        .Add(" " + Shortened(Printable(question), room), Style::kBanner)
        .Add(answers, Style::kBanner)
        .Fill(Style::kBanner)
        .Take();
  }
  if (model.search()) {
    return LineWriter(width).Add(" Find: ", Style::kStrong).Add(*model.search() + "_").Take();
  }
  if (!model.notice().empty()) {
    return LineWriter(width).Add(" " + model.notice(), Style::kStrong).Take();
  }
  return KeysOf(KeysFor(model), width);
}

}  // namespace clearway::screen
