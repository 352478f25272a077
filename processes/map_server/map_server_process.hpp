// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "common/core/mapping/map_tiles.hpp"
#include "common/core/mapping/occupancy_grid.hpp"
#include "common/process/node.hpp"

namespace clearway {

/// MAP_REQUEST -> MAP, for one static map. See README.md beside this file.
class MapServerProcess {
 public:
  /// @pre the map is valid.
  MapServerProcess(core::OccupancyGrid map, process::Node& node);

 private:
  void OnRequest(const map_request_t& request);
  [[nodiscard]] std::vector<int> TilesOf(const map_request_t& request) const;
  void SendNextTile();
  void SetCounters();

  core::OccupancyGrid map_;
  process::Node& node_;
  std::int64_t epoch_;
  std::uint32_t checksum_;
  std::vector<core::CellRectangle> tiles_;
  std::set<int> waiting_;  // Tiles to be sent, each once however many ask for it.
  int next_ = 0;           // From where on `waiting_` is sent.
  bool is_sending_ = false;
  std::int64_t requests_ = 0;
  std::int64_t requests_refused_ = 0;
  std::int64_t tiles_sent_ = 0;
};

}  // namespace clearway
