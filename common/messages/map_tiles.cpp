// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/map_tiles.hpp"

#include <algorithm>
#include <utility>

#include "common/core/mapping/run_length.hpp"

namespace clearway::messages {
namespace {

constexpr std::size_t kLocalMapHeaderBytes = 160;

std::int32_t Int32(std::size_t value) {
  return static_cast<std::int32_t>(value);
}

bool AreCells(const std::vector<std::uint8_t>& cells) {
  return std::all_of(cells.begin(), cells.end(), [](std::uint8_t cell) {
    return cell <= core::OccupancyGrid::kOccupied || cell == core::OccupancyGrid::kUnknown;
  });
}

}  // namespace

map_tile_t ToLcm(const core::MapTile& tile) {
  map_tile_t message{};
  message.epoch = tile.version.epoch;
  message.slice_index = tile.index;
  message.slice_count = tile.count;
  message.map_width = tile.geometry.width;
  message.map_height = tile.geometry.height;
  message.resolution_m = tile.geometry.resolution_m;
  message.origin[0] = tile.geometry.origin_x_m;
  message.origin[1] = tile.geometry.origin_y_m;
  message.origin[2] = tile.geometry.origin_yaw_rad;
  message.tile_x = tile.rectangle.column;
  message.tile_y = tile.rectangle.row;
  message.tile_width = tile.rectangle.width;
  message.tile_height = tile.rectangle.height;
  message.encoding = map_tile_t::ENCODING_RLE;
  message.tile_checksum = core::Checksum(tile.cells);
  message.map_checksum = tile.map_checksum;
  message.data = core::EncodeRuns(tile.cells);
  message.n = Int32(message.data.size());
  return message;
}

std::optional<core::MapTile> FromLcm(const map_tile_t& message) {
  core::MapTile tile;
  tile.version = {message.session, message.epoch};
  tile.geometry = {message.map_width,
                   message.map_height,
                   message.resolution_m,
                   message.origin[0],
                   message.origin[1],
                   message.origin[2]};
  tile.index = message.slice_index;
  tile.count = message.slice_count;
  tile.rectangle = {message.tile_x, message.tile_y, message.tile_width, message.tile_height};
  tile.map_checksum = static_cast<std::uint32_t>(message.map_checksum);
  const bool is_sound = tile.geometry.IsValid() && message.encoding == map_tile_t::ENCODING_RLE &&
                        std::in_range<std::uint32_t>(message.map_checksum) && message.tile_x >= 0 &&
                        message.tile_y >= 0 && message.tile_width > 0 && message.tile_height > 0 &&
                        message.tile_width <= message.map_width - message.tile_x &&
                        message.tile_height <= message.map_height - message.tile_y;
  if (!is_sound) return std::nullopt;
  auto cells = core::DecodeRuns(message.data, static_cast<std::size_t>(tile.rectangle.num_cells()));
  if (!cells || !AreCells(*cells) ||
      static_cast<std::int64_t>(core::Checksum(*cells)) != message.tile_checksum) {
    return std::nullopt;
  }
  tile.cells = *std::move(cells);
  return tile;
}

std::vector<local_map_t> ToLocalMap(const core::LocalMap& map,
                                    const LocalMapHeader& header,
                                    std::size_t max_message_bytes) {
  local_map_t common{};
  common.utime = header.utime;
  common.scan_id = header.scan_id;
  common.n_origins = Int32(map.sensor_origins_map.size());
  for (const Eigen::Vector2d& origin : map.sensor_origins_map) {
    common.origin_x.push_back(origin.x());
    common.origin_y.push_back(origin.y());
  }
  common.resolution_m = map.grid.geometry.resolution_m;
  common.encoding = map_tile_t::ENCODING_RLE;
  common.slice_count = 1;
  if (map.grid.cells.empty()) return {common};

  const std::size_t header_bytes = kLocalMapHeaderBytes + 16 * map.sensor_origins_map.size();
  const std::vector<core::CellRectangle> bands =
      core::CutTiles(map.grid, max_message_bytes - header_bytes);
  std::vector<local_map_t> slices(bands.size(), common);
  for (std::size_t i = 0; i < bands.size(); ++i) {
    local_map_t& slice = slices[i];
    slice.slice_index = Int32(i);
    slice.slice_count = Int32(bands.size());
    slice.corner[0] = map.grid.geometry.origin_x_m + bands[i].column * common.resolution_m;
    slice.corner[1] = map.grid.geometry.origin_y_m + bands[i].row * common.resolution_m;
    slice.width = bands[i].width;
    slice.height = bands[i].height;
    slice.data = core::EncodeRuns(core::CellsOf(map.grid, bands[i]));
    slice.n = Int32(slice.data.size());
  }
  return slices;
}

std::optional<core::OccupancyGrid> FromLcm(const local_map_t& message) {
  core::OccupancyGrid grid;
  grid.geometry = {
      message.width, message.height, message.resolution_m, message.corner[0], message.corner[1], 0};
  if (message.width == 0 && message.height == 0 && message.n == 0) return grid;
  if (!grid.geometry.IsValid() || message.encoding != map_tile_t::ENCODING_RLE) return std::nullopt;
  auto cells = core::DecodeRuns(message.data, grid.geometry.num_cells());
  if (!cells || !AreCells(*cells)) return std::nullopt;
  grid.cells = *std::move(cells);
  return grid;
}

}  // namespace clearway::messages
