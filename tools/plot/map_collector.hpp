// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <clearway/map_tile_t.hpp>

#include "common/core/mapping/map_tiles.hpp"

namespace clearway::plot {

/// The static map as far as its tiles came.
struct CollectedMap {
  std::shared_ptr<const core::OccupancyGrid> grid;  ///< Null: no tile came.
  std::int64_t epoch = 0;                           ///< 0: no tile came.
  int tiles = 0;                                    ///< Those that came; the rest is unknown.
  int tiles_expected = 0;
};

/// Puts the static map together from MAP.
class MapCollector {
 public:
  /// Tiles of other layers, and those that break a rule of the type, are passed over.
  void Add(const map_tile_t& message);

  /// The newest map that is whole; as long as there is none, what there is of one. O(1), or
  /// O(cells) as long as it is not whole.
  [[nodiscard]] CollectedMap Get() const;

 private:
  [[nodiscard]] CollectedMap Copy() const;

  core::MapAssembler assembler_;
  std::optional<core::MapVersion> whole_version_;
  CollectedMap whole_;
};

}  // namespace clearway::plot
