// SPDX-License-Identifier: BSD-3-Clause
#include "tools/map/build.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <set>
#include <utility>

#include "common/core/mapping/wall_depth.hpp"
#include "common/io/lcm_log.hpp"
#include "common/io/read_error.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "common/messages/map_tiles.hpp"

namespace clearway::map_tool {
namespace {

using core::MapBuilder;
using core::OccupancyGrid;

// One slice of LOCAL_MAP goes into the builder, or into one of the counts. True: it was usable.
bool AddSlice(const std::optional<local_map_t>& slice, MapBuilder& builder, BuildReport& report) {
  const auto grid = slice ? messages::FromLcm(*slice) : std::nullopt;
  if (!grid) {
    ++report.slices_invalid;
    return false;
  }
  if (grid->cells.empty()) return true;  // Nothing was seen.
  const MapBuilder::Outcome outcome = builder.Add(*grid);
  if (outcome == MapBuilder::Outcome::kInvalid) ++report.slices_invalid;
  if (outcome == MapBuilder::Outcome::kOtherGrid || outcome == MapBuilder::Outcome::kTooLarge) {
    ++report.slices_refused;
  }
  return outcome == MapBuilder::Outcome::kAdded;
}

std::int64_t Count(const OccupancyGrid& map, std::uint8_t value) {
  return std::count(map.cells.begin(), map.cells.end(), value);
}

}  // namespace

BuildReport BuildMap(const BuildSettings& settings) {
  const std::string channel = settings.channel_prefix + messages::channels::kLocalMap.name;
  io::LcmLogReader reader(settings.log);
  MapBuilder builder;
  BuildReport report;
  std::set<std::int64_t> scans;
  while (const auto event = reader.Next()) {
    if (event->channel != channel) continue;
    const auto slice = messages::Decode<local_map_t>(event->bytes);
    if (AddSlice(slice, builder, report)) scans.insert(slice->utime);
  }
  report.scans = scans.size();
  if (!builder.has_cells()) {
    throw io::ErrorInFile(settings.log.string(),
                          "holds no usable " + channel +
                              ": it is published for scans that have a POSE, so set pose_source "
                              "or run a localization, and record again");
  }
  const OccupancyGrid seen = builder.Build(settings.rules);
  report.map = core::WithWallDepth(seen, settings.wall_depth_m);
  report.cells_deepened = static_cast<std::size_t>(Count(report.map, OccupancyGrid::kOccupied) -
                                                   Count(seen, OccupancyGrid::kOccupied));
  return report;
}

std::string Describe(const BuildReport& report) {
  const core::GridGeometry& geometry = report.map.geometry;
  std::array<char, 512> text{};
  std::snprintf(text.data(),
                text.size(),
                "%zu scans -> %d x %d cells of %g m, origin (%g, %g): %lld occupied, %lld free, "
                "%lld unknown\n",
                report.scans,
                geometry.width,
                geometry.height,
                geometry.resolution_m,
                geometry.origin_x_m,
                geometry.origin_y_m,
                static_cast<long long>(Count(report.map, OccupancyGrid::kOccupied)),
                static_cast<long long>(Count(report.map, OccupancyGrid::kFree)),
                static_cast<long long>(Count(report.map, OccupancyGrid::kUnknown)));
  std::string description = text.data();
  if (report.cells_deepened > 0) {
    description += std::to_string(report.cells_deepened) +
                   " of the occupied cells are unknown ones behind what was hit (--wall-depth)\n";
  }
  if (report.slices_invalid + report.slices_refused > 0) {
    description += "left out: " + std::to_string(report.slices_invalid) +
                   " broken slices of LOCAL_MAP, " + std::to_string(report.slices_refused) +
                   " of another resolution or too far away\n";
  }
  return description;
}

}  // namespace clearway::map_tool
