// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "processes/procman_sheriff/screen_line.hpp"
#include "processes/procman_sheriff/screen_model.hpp"

/// Lays out the full-screen view: pure functions of what is shown and of the size.
namespace clearway::screen {

struct ScreenSize {
  int columns = 80;
  int rows = 24;
};

/// How the rows are shared out; what a row is missing for is left out.
struct ScreenAreas {
  int banners = 0;
  int hosts = 0;  ///< Lines of hosts.
  bool has_hosts_header = false;
  int table = 0;  ///< Lines of the tree, without its header.
  int pane = 0;   ///< Below, with its title.
  int page = 0;   ///< Of a full-screen list or output, in place of all these.
};
[[nodiscard]] ScreenAreas AreasOf(const ScreenModel& model, ScreenSize size);

/// What the model has to know of it.
[[nodiscard]] ScreenRows RowsOf(const ScreenModel& model, ScreenSize size);

/// Exactly size.rows lines of at most size.columns cells. `clock` is what the title shows. The
/// model should have been fitted to the same size, else the selected line may not be among them.
[[nodiscard]] std::vector<Line> Compose(const ScreenModel& model,
                                        ScreenSize size,
                                        const std::string& clock);

}  // namespace clearway::screen
