// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>

#include "processes/procman_sheriff/screen_parts.hpp"
#include "processes/procman_sheriff/text_cells.hpp"

namespace clearway::screen {
namespace {

using core::procman::DeputyView;

constexpr int kStateCells = 12;
constexpr int kCpuCells = 4;
constexpr int kMemoryCells = 13;
constexpr int kCommandsCells = 4;
// Of what a problem may take the place of.
constexpr int kNumbersCells = kCpuCells + kMemoryCells + kCommandsCells + 3;

// What most hosts have of these; empty where none says it or none is the most common.
std::string MostCommon(const std::vector<DeputyView>& deputies, std::string DeputyView::*field) {
  std::map<std::string, int> counts;
  for (const DeputyView& deputy : deputies) {
    if (!(deputy.*field).empty()) ++counts[deputy.*field];
  }
  std::string common;
  int most = 0;
  for (const auto& [value, count] : counts) {
    if (count == most) common.clear();
    if (count > most) common = value;
    most = std::max(most, count);
  }
  return common;
}

struct Common {
  std::string version;
  std::string config;
};

bool IsOdd(const std::string& value, const std::string& common) {
  return !value.empty() && value != common;
}

std::string StateOf(const DeputyView& deputy) {
  if (deputy.age_us < 0) return "NEVER HEARD";
  return (deputy.is_heard ? "heard " : "SILENT ") + TimeInWords(deputy.age_us);
}

std::string MemoryOf(const DeputyView& deputy) {
  if (deputy.phys_mem_total_bytes <= 0) return "-";
  std::string used = BytesInWords(deputy.phys_mem_total_bytes - deputy.phys_mem_free_bytes);
  const std::string total = BytesInWords(deputy.phys_mem_total_bytes);
  // "2.9/7.6 GB": the unit once where it is the same.
  const std::string unit = total.substr(total.find(' '));
  if (used.ends_with(unit)) used.resize(used.size() - unit.size());
  return used + "/" + total;
}

std::string ProblemsOf(const DeputyView& deputy, const Common& common) {
  std::string problems = deputy.text;
  const auto add = [&problems](const std::string& text) {
    problems += (problems.empty() ? "" : "; ") + text;
  };
  if (IsOdd(deputy.version, common.version)) add("version differs: " + deputy.version);
  if (IsOdd(deputy.config_digest, common.config)) {
    add("config differs: " + deputy.config_digest.substr(0, 8));
  }
  return problems;
}

bool IsWell(const DeputyView& deputy, const Common& common) {
  return deputy.is_heard && ProblemsOf(deputy, common).empty();
}

std::string NoteOf(const DeputyView& deputy) {
  std::string note = deputy.is_in_file ? "" : "not in the file";
  if (!deputy.host.empty() && deputy.host != deputy.id) {
    note += (note.empty() ? "" : ", ") + std::string("on ") + deputy.host;
  }
  return note;
}

Line HostLine(const DeputyView& deputy, int width, int name_cells, const Common& common) {
  const bool is_well = IsWell(deputy, common);
  LineWriter line(width);
  line.Add(is_well ? "   " : " ! ", Style::kTrouble)
      .Cell(deputy.id, name_cells, Style::kStrong)
      .Cell(StateOf(deputy), kStateCells, deputy.is_heard ? Style::kPlain : Style::kTrouble);
  const std::string problems = Printable(ProblemsOf(deputy, common));
  const int room = line.left() - kNumbersCells;
  if (problems.empty() || CellsOf(std::string_view(problems)) <= room) {
    line.RightCell(deputy.is_heard ? Percent(deputy.cpu_load) : "-", kCpuCells)
        .RightCell(deputy.is_heard ? MemoryOf(deputy) : "-", kMemoryCells)
        .RightCell(std::to_string(deputy.commands), kCommandsCells);
  }
  if (!problems.empty()) return line.Add(problems, Style::kTrouble).Take();
  if (deputy.age_us < 0) return line.Add("is one running, with this id and URL?").Take();
  return line.Add(NoteOf(deputy), Style::kDim).Take();
}

// Those in trouble first where not all have a line.
std::vector<const DeputyView*> Ordered(const std::vector<DeputyView>& deputies,
                                       std::size_t lines,
                                       const Common& common) {
  std::vector<const DeputyView*> ordered;
  for (const DeputyView& deputy : deputies) ordered.push_back(&deputy);
  if (deputies.size() > lines) {
    std::stable_partition(ordered.begin(), ordered.end(), [&](const DeputyView* deputy) {
      return !IsWell(*deputy, common);
    });
  }
  return ordered;
}

// How those that have no line of their own are.
Line RestLine(const std::vector<const DeputyView*>& rest, int width, const Common& common) {
  const auto bad = std::count_if(
      rest.begin(), rest.end(), [&](const auto* deputy) { return !IsWell(*deputy, common); });
  LineWriter line(width);
  line.Add(bad > 0 ? " ! " : "   ", Style::kTrouble)
      .Add("and " + std::to_string(rest.size()) + " more: ", Style::kDim);
  if (bad == 0) return line.Add("all well", Style::kDim).Take();
  return line.Add(std::to_string(bad) + " in trouble", Style::kTrouble).Take();
}

// All hosts in one line, those in trouble by name.
Line SummaryLine(const std::vector<DeputyView>& deputies, int width, const Common& common) {
  LineWriter line(width);
  const auto well = std::count_if(deputies.begin(), deputies.end(), [&](const DeputyView& deputy) {
    return IsWell(deputy, common);
  });
  line.Add(" hosts: " + std::to_string(well) + " of " + std::to_string(deputies.size()) + " well");
  for (const DeputyView& deputy : deputies) {
    if (IsWell(deputy, common)) continue;
    const std::string problems = ProblemsOf(deputy, common);
    line.Add("  ! " + deputy.id + " " + (deputy.is_heard ? problems : StateOf(deputy)),
             Style::kTrouble);
  }
  return line.Take();
}

Line HostsHeader(int width, int name_cells) {
  LineWriter line(width);
  line.Add("   ").Cell("HOST", name_cells).Cell("STATE", kStateCells);
  line.RightCell("CPU%", kCpuCells).RightCell("MEMORY", kMemoryCells);
  line.RightCell("CMDS", kCommandsCells).Add("NOTE");
  return HeaderLine(TextOf(line.Take()), width);
}

}  // namespace

Lines HostLines(const ScreenModel& model, int width, const ScreenAreas& areas) {
  const std::vector<DeputyView>& deputies = model.snapshot().deputies;
  const Common common{MostCommon(deputies, &DeputyView::version),
                      MostCommon(deputies, &DeputyView::config_digest)};
  int name_cells = 4;
  for (const DeputyView& deputy : deputies) {
    name_cells = std::max(name_cells, CellsOf(std::string_view(Printable(deputy.id))));
  }
  name_cells = std::min(name_cells, std::clamp(width / 5, 8, 32));
  Lines lines;
  if (areas.has_hosts_header) lines.push_back(HostsHeader(width, name_cells));
  if (areas.hosts <= 0) return lines;
  const auto rows = static_cast<std::size_t>(areas.hosts);
  if (deputies.empty()) {
    lines.push_back(LineWriter(width).Add("   no deputy is heard", Style::kDim).Take());
    return lines;
  }
  if (!areas.has_hosts_header) {
    lines.push_back(SummaryLine(deputies, width, common));
    return lines;
  }
  const std::vector<const DeputyView*> ordered = Ordered(deputies, rows, common);
  const std::size_t shown = ordered.size() > rows ? rows - 1 : ordered.size();
  for (std::size_t i = 0; i < shown; ++i) {
    lines.push_back(HostLine(*ordered[i], width, name_cells, common));
  }
  if (shown < ordered.size()) {
    lines.push_back(RestLine(
        {ordered.begin() + static_cast<std::ptrdiff_t>(shown), ordered.end()}, width, common));
  }
  return lines;
}

}  // namespace clearway::screen
