// SPDX-License-Identifier: BSD-3-Clause
#include "processes/map_server/map_server_process.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/core/mapping/run_length.hpp"
#include "common/messages/map_tiles.hpp"

namespace clearway {
namespace {

using messages::channels::kMap;
using messages::channels::kMapRequest;

// With the bus's pause between two tiles this is 6 MB/s: the tiles neither flood a receiver at
// stock kernel settings nor hold up the scans beside them.
constexpr std::size_t kMaxTileBytes = 12'000;

std::size_t DataBytes(const process::Runtime& runtime) {
  return std::min(kMaxTileBytes, runtime.MaxMessageBytes(kMap.bus)) - messages::kMapTileHeaderBytes;
}

}  // namespace

MapServerProcess::MapServerProcess(core::OccupancyGrid map, process::Node& node)
    : map_(std::move(map)),
      node_(node),
      epoch_(node.runtime().UtimeNow()),
      checksum_(core::Checksum(map_.cells)),
      tiles_(core::CutTiles(map_, DataBytes(node.runtime()))) {
  node_.Subscribe<map_request_t>(kMapRequest, [this](const auto& m) { OnRequest(m); });
  SetCounters();
  node_.SetState({status_t::STATE_OK,
                  true,
                  "serving a map of " + std::to_string(map_.geometry.width) + " x " +
                      std::to_string(map_.geometry.height) + " cells"});
}

void MapServerProcess::OnRequest(const map_request_t& request) {
  ++requests_;
  const std::vector<int> wanted = TilesOf(request);
  if (wanted.empty()) {
    ++requests_refused_;
    node_.CountInvalid();
  }
  waiting_.insert(wanted.begin(), wanted.end());
  if (!is_sending_) SendNextTile();
  SetCounters();
}

// Nothing when the request cannot be met: another layer, a window off the map, unknown tiles.
std::vector<int> MapServerProcess::TilesOf(const map_request_t& request) const {
  std::vector<int> wanted;
  if (request.layer != map_request_t::LAYER_STATIC) return wanted;
  if (request.epoch == epoch_ && !request.missing.empty()) {
    std::copy_if(request.missing.begin(),
                 request.missing.end(),
                 std::back_inserter(wanted),
                 [this](int tile) { return tile >= 0 && tile < std::ssize(tiles_); });
    return wanted;
  }
  const bool is_window = request.window_max[0] > request.window_min[0] &&
                         request.window_max[1] > request.window_min[1];
  const core::CellRectangle window =
      is_window ? core::CellsInWindow(map_.geometry,
                                      {request.window_min[0], request.window_min[1]},
                                      {request.window_max[0], request.window_max[1]})
                : core::CellRectangle{0, 0, map_.geometry.width, map_.geometry.height};
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    if (core::Intersection(window, tiles_[i]).num_cells() > 0) {
      wanted.push_back(static_cast<int>(i));
    }
  }
  return wanted;
}

// Tiles go round in their order, so that a client that keeps asking cannot starve another one.
void MapServerProcess::SendNextTile() {
  is_sending_ = !waiting_.empty();
  if (!is_sending_) {
    SetCounters();
    return;
  }
  auto next = waiting_.lower_bound(next_);
  if (next == waiting_.end()) next = waiting_.begin();
  const int index = *next;
  waiting_.erase(next);
  next_ = index + 1;

  core::MapTile tile;
  tile.version.epoch = epoch_;
  tile.geometry = map_.geometry;
  tile.index = index;
  tile.count = static_cast<int>(tiles_.size());
  tile.rectangle = tiles_[static_cast<std::size_t>(index)];
  tile.cells = core::CellsOf(map_, tile.rectangle);
  tile.map_checksum = checksum_;
  map_tile_t message = messages::ToLcm(tile);
  message.utime = epoch_;
  message.layer = map_request_t::LAYER_STATIC;
  node_.Publish(kMap, std::move(message));
  ++tiles_sent_;
  node_.runtime().After(node_.runtime().BurstIntervalUs(kMap.bus), [this] { SendNextTile(); });
}

void MapServerProcess::SetCounters() {
  node_.SetCounter("map_epoch", epoch_);
  node_.SetCounter("map_tiles", std::ssize(tiles_));
  node_.SetCounter("requests", requests_);
  node_.SetCounter("requests_refused", requests_refused_);
  node_.SetCounter("tiles_sent", tiles_sent_);
}

}  // namespace clearway
