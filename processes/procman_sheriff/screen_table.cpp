// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>

#include "processes/procman_sheriff/screen_parts.hpp"
#include "processes/procman_sheriff/text_cells.hpp"

namespace clearway::screen {
namespace {

using core::procman::CommandView;
using core::procman::GroupView;
using core::procman::Status;

constexpr int kStateCells = 13;  // "Getting ready".
constexpr int kStartsCells = 6;
constexpr int kPidCells = 7;
constexpr int kCpuCells = 4;
constexpr int kMemoryCells = 7;
constexpr int kAgeCells = 7;
// Deeper groups are not moved further to the right.
constexpr int kMaxDepth = 6;

struct Columns {
  int name = 0;
  int host = 0;  // 0: left out.
  bool has_pid = false;
  bool has_numbers = false;  // Starts, processor, memory.
  bool has_age = false;
};

std::string NameOf(const TreeLine& line) {
  std::string name(2 * static_cast<std::size_t>(std::min(line.depth, kMaxDepth)), ' ');
  name += Printable(line.name);
  if (line.kind == TreeLine::Kind::kGroup) name += line.is_folded ? "/ +" : "/";
  return name;
}

Columns ColumnsFor(const ScreenModel& model, int width) {
  Columns columns{.has_pid = width >= 50, .has_numbers = width >= 72, .has_age = width >= 100};
  int longest = 10;
  for (const TreeLine& line : model.lines()) {
    longest = std::max(longest, CellsOf(std::string_view(NameOf(line))));
  }
  columns.name = std::min(longest, std::max(width * 3 / 10, 12));
  if (width >= 100) {
    longest = 4;
    for (const CommandView& command : model.snapshot().commands) {
      longest = std::max(longest, CellsOf(std::string_view(Printable(command.deputy))));
    }
    columns.host = std::min(longest, width / 8);
  }
  return columns;
}

Line TableHeader(const Columns& columns, int width, const std::string& right) {
  LineWriter line(width);
  line.Add("   ").Cell("COMMAND", columns.name).Cell("STATE", kStateCells);
  if (columns.host > 0) line.Cell("HOST", columns.host);
  if (columns.has_numbers) line.RightCell("STARTS", kStartsCells);
  if (columns.has_pid) line.RightCell("PID", kPidCells);
  if (columns.has_age) line.RightCell("UP FOR", kAgeCells);
  if (columns.has_numbers) line.RightCell("CPU%", kCpuCells).RightCell("MEMORY", kMemoryCells);
  line.Add("WHY");
  return HeaderLine(TextOf(line.Take()), width, right);
}

void AddNumbers(LineWriter& line, const CommandView& command, const Columns& columns) {
  if (columns.has_age) {
    line.RightCell(command.running_us < 0 ? "-" : TimeInWords(command.running_us), kAgeCells);
  }
  if (!columns.has_numbers) return;
  line.RightCell(Percent(command.cpu_usage), kCpuCells);
  line.RightCell(BytesInWords(command.mem_rss_bytes), kMemoryCells);
}

int NumbersCells(const Columns& columns) {
  return (columns.has_age ? kAgeCells + 1 : 0) +
         (columns.has_numbers ? kCpuCells + kMemoryCells + 2 : 0);
}

void AddCommand(LineWriter& line, const CommandView& command, const Columns& columns) {
  const Style style = StyleOf(command.status);
  line.Cell(WordsFor(command.status), kStateCells, style);
  if (columns.host > 0) line.Cell(command.deputy, columns.host);
  if (columns.has_numbers) {
    line.RightCell(command.starts < 0 ? "-" : std::to_string(command.starts), kStartsCells);
  }
  const std::string reason = ReasonOf(command);
  const Style reason_style = style == Style::kTrouble ? Style::kTrouble : Style::kPlain;
  // What has no process has no numbers: the reason takes their place.
  const bool is_up = command.pid > 0;
  if (!is_up && reason.empty()) return;
  if (is_up && columns.has_pid) line.RightCell(std::to_string(command.pid), kPidCells);
  // What is not well is told sooner than how much memory it takes, where both do not fit.
  const int room = line.left() - NumbersCells(columns);
  const bool has_room =
      style == Style::kPlain || CellsOf(std::string_view(Printable(reason))) <= room;
  if (is_up && has_room) AddNumbers(line, command, columns);
  line.Add(reason, reason_style);
}

void AddGroup(LineWriter& line, const GroupView& group) {
  line.Cell(std::to_string(group.ready) + "/" + std::to_string(group.commands) + " ready",
            kStateCells,
            Style::kStrong);
  if (group.trouble > 0) {
    line.Add(std::to_string(group.trouble) + " IN TROUBLE", Style::kTrouble).Add("  ");
  }
  const int others = group.up - group.ready;
  if (others > 0) line.Add(std::to_string(others) + " running, not ready  ", Style::kBusy);
  if (group.unknown > 0) line.Add(std::to_string(group.unknown) + " unknown", Style::kDim);
}

Line TableLine(const ScreenModel& model, std::size_t index, const Columns& columns, int width) {
  const TreeLine& tree_line = model.lines()[index];
  const bool is_selected = index == model.selected();
  LineWriter line(width);
  line.Add(is_selected ? ">" : " ", Style::kStrong);
  if (tree_line.kind == TreeLine::Kind::kCommand) {
    const CommandView& command = model.snapshot().commands[tree_line.index];
    const Style style = StyleOf(command.status);
    line.Add(std::string(1, MarkOf(command.status)) + " ", style);
    line.Cell(NameOf(tree_line), columns.name);
    AddCommand(line, command, columns);
  } else if (tree_line.index < model.snapshot().groups.size()) {
    const GroupView& group = model.snapshot().groups[tree_line.index];
    const bool is_known = group.unknown == 0;
    line.Add(group.trouble > 0 ? "! "
             : is_known        ? "  "
                               : "? ",
             group.trouble > 0 ? Style::kTrouble : Style::kDim);
    line.Cell(NameOf(tree_line), columns.name, Style::kStrong);
    AddGroup(line, group);
  } else {
    line.Add("  ").Cell(NameOf(tree_line), columns.name, Style::kStrong);
  }
  Line done = line.Take();
  done.is_selected = is_selected;
  return done;
}

int TroubleBetween(const ScreenModel& model, std::size_t first, std::size_t end) {
  int trouble = 0;
  for (std::size_t i = first; i < end; ++i) {
    const TreeLine& line = model.lines()[i];
    if (line.kind != TreeLine::Kind::kCommand) continue;
    trouble += IsTrouble(model.snapshot().commands[line.index].status) ? 1 : 0;
  }
  return trouble;
}

// What of the tree is not to be seen.
std::string HiddenPart(const ScreenModel& model, std::size_t top, std::size_t end) {
  const std::size_t size = model.lines().size();
  if (top == 0 && end == size) return "";
  std::string text =
      "  " + std::to_string(top + 1) + "-" + std::to_string(end) + " of " + std::to_string(size);
  const int trouble = TroubleBetween(model, 0, top) + TroubleBetween(model, end, size);
  if (trouble > 0) text += ", " + std::to_string(trouble) + " more in trouble: !";
  return text + " ";
}

}  // namespace

Style StyleOf(Status status) {
  if (core::procman::IsTrouble(status)) return Style::kTrouble;
  if (status == Status::kUnknown) return Style::kDim;
  if (IsOnItsWay(status) || status == Status::kGettingReady) return Style::kBusy;
  return Style::kPlain;
}

char MarkOf(Status status) {
  switch (StyleOf(status)) {
    case Style::kTrouble:
      return '!';
    case Style::kBusy:
      return '~';
    case Style::kDim:
      return '?';
    default:
      return ' ';
  }
}

std::string ReasonOf(const CommandView& command) {
  if (command.differs.empty()) return command.text;
  return command.text + (command.text.empty() ? "" : "; ") + command.differs;
}

Lines TableLines(const ScreenModel& model, int width, const ScreenAreas& areas) {
  const Columns columns = ColumnsFor(model, width);
  const std::size_t top = model.top();
  const std::size_t end =
      std::min(top + static_cast<std::size_t>(std::max(areas.table, 0)), model.lines().size());
  Lines lines{TableHeader(columns, width, HiddenPart(model, top, end))};
  for (std::size_t i = top; i < end; ++i) lines.push_back(TableLine(model, i, columns, width));
  // A snapshot may have become shorter since the model was fitted.
  lines.resize(static_cast<std::size_t>(std::max(areas.table, 0)) + 1);
  return lines;
}

}  // namespace clearway::screen
