// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/screen_text.hpp"

#include <algorithm>
#include <iterator>

#include "processes/procman_sheriff/screen_parts.hpp"

namespace clearway::screen {
namespace {

// Below this the hosts get one line together.
constexpr int kRowsForHosts = 16;

void Append(Lines& lines, Lines more) {
  std::move(more.begin(), more.end(), std::back_inserter(lines));
}

Lines Page(const ScreenModel& model, ScreenSize size, const ScreenAreas& areas) {
  switch (model.mode()) {
    case ScreenModel::Mode::kOutput:
      return OutputPage(model, size.columns, areas.page);
    case ScreenModel::Mode::kScripts:
      return ScriptsPage(model, size.columns, areas.page);
    case ScreenModel::Mode::kHelp:
      return HelpPage(model, size.columns, areas.page);
    case ScreenModel::Mode::kTable:
      break;
  }
  Lines lines = HostLines(model, size.columns, areas);
  Append(lines, TableLines(model, size.columns, areas));
  Append(lines, PaneLines(model, size.columns, areas.pane));
  return lines;
}

}  // namespace

ScreenAreas AreasOf(const ScreenModel& model, ScreenSize size) {
  ScreenAreas areas;
  areas.banners = static_cast<int>(BannerLines(model, size.columns).size());
  int left = size.rows - 2 - areas.banners;  // The title and the keys.
  areas.page = std::max(left - 1, 0);        // Its header.

  const int hosts = std::max(static_cast<int>(model.snapshot().deputies.size()), 1);
  areas.has_hosts_header = size.rows >= kRowsForHosts;
  areas.hosts = areas.has_hosts_header ? std::min(hosts, std::max(3, size.rows / 6)) : 1;
  areas.hosts = std::clamp(areas.hosts, 0, std::max(left - 2, 0));
  left -= areas.hosts + (areas.has_hosts_header ? 1 : 0) + 1;  // And the header of the tree.

  const int tree = static_cast<int>(model.lines().size());
  const int least_pane = size.rows >= kRowsForHosts ? std::max(5, size.rows / 4) : 2;
  areas.table = std::clamp(std::min(tree, left - least_pane), std::min(left, 2), std::max(left, 0));
  areas.table = std::max(areas.table, 0);
  areas.pane = std::max(left - areas.table, 0);
  return areas;
}

ScreenRows RowsOf(const ScreenModel& model, ScreenSize size) {
  const ScreenAreas areas = AreasOf(model, size);
  return {.table = areas.table, .page = areas.page, .help_top = HelpLines() - areas.page};
}

std::vector<Line> Compose(const ScreenModel& model, ScreenSize size, const std::string& clock) {
  const ScreenAreas areas = AreasOf(model, size);
  Lines lines{TitleLine(model, size.columns, clock)};
  Append(lines, BannerLines(model, size.columns));
  Append(lines, Page(model, size, areas));
  const auto rows = static_cast<std::size_t>(std::max(size.rows, 0));
  // The keys have the last row, also where there is hardly any.
  lines.resize(rows > 0 ? rows - 1 : 0);
  if (rows > 0) lines.push_back(KeysLine(model, size.columns));
  return lines;
}

}  // namespace clearway::screen
