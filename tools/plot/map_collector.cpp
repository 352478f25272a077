// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/map_collector.hpp"

#include <clearway/map_request_t.hpp>

#include "common/messages/map_tiles.hpp"

namespace clearway::plot {

void MapCollector::Add(const map_tile_t& message) {
  if (message.layer != map_request_t::LAYER_STATIC) return;
  const std::optional<core::MapTile> tile = messages::FromLcm(message);
  if (!tile) return;
  assembler_.Add(*tile);
  if (assembler_.IsCorrupt()) assembler_.Clear();
  if (!assembler_.IsComplete() || assembler_.version() == whole_version_) return;
  whole_ = Copy();
  whole_version_ = assembler_.version();
}

CollectedMap MapCollector::Get() const {
  return whole_version_ ? whole_ : Copy();
}

CollectedMap MapCollector::Copy() const {
  const std::optional<core::MapVersion> version = assembler_.version();
  if (!version) return {};
  return {.grid = std::make_shared<const core::OccupancyGrid>(assembler_.grid()),
          .epoch = version->epoch,
          .tiles = assembler_.received(),
          .tiles_expected = assembler_.count()};
}

}  // namespace clearway::plot
