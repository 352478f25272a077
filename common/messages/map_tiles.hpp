// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <clearway/local_map_t.hpp>
#include <clearway/map_tile_t.hpp>

#include "common/core/mapping/local_map.hpp"
#include "common/core/mapping/map_tiles.hpp"

namespace clearway::messages {

/// Bytes of a map_tile_t besides its data.
inline constexpr std::size_t kMapTileHeaderBytes = 200;

/// The message of a tile; layer, utime and update are left to the caller, session and sequence to
/// the node that publishes it.
[[nodiscard]] map_tile_t ToLcm(const core::MapTile& tile);

/// The tile of a message. Nothing when it breaks a rule of the type: sizes, encoding, or cells that
/// do not have the checksum that the message says.
[[nodiscard]] std::optional<core::MapTile> FromLcm(const map_tile_t& message);

/// A local map as bands of rows, at least one, each within max_message_bytes; a row that does not
/// fit by itself is cut into pieces of columns. Session and sequence are left to the node.
struct LocalMapHeader {
  std::int64_t utime = 0;
  std::int64_t scan_id = 0;
};
[[nodiscard]] std::vector<local_map_t> ToLocalMap(const core::LocalMap& map,
                                                  const LocalMapHeader& header,
                                                  std::size_t max_message_bytes);

/// The cells of one slice as a grid of its own. Nothing when it breaks a rule of the type. A slice
/// without cells (nothing was seen) gives a grid of 0 x 0.
[[nodiscard]] std::optional<core::OccupancyGrid> FromLcm(const local_map_t& message);

}  // namespace clearway::messages
