// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "common/messages/channels.hpp"
#include "common/messages/map_state.hpp"
#include "tools/plot/scan_from_messages.hpp"

namespace clearway::plot {
namespace {

// Each line is empty when there is nothing to say.

namespace channels = messages::channels;

template <typename... Values>
std::string Format(const char* format, Values... values) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

double Degrees(double angle_rad) {
  return angle_rad * 180.0 / std::numbers::pi;
}

// 2025-04-12 22:47:53.711 UTC.
std::string Date(std::int64_t utime) {
  if (utime < 0) return std::to_string(utime) + " us";
  const std::time_t seconds = utime / 1'000'000;
  std::tm parts{};
  std::array<char, 64> text{};
  if (gmtime_r(&seconds, &parts) == nullptr ||
      std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S", &parts) == 0) {
    return std::to_string(utime) + " us";
  }
  return text.data() + Format(".%03d UTC", static_cast<int>(utime % 1'000'000 / 1000));
}

std::string ScanLine(const ScanMessages& scan, const ScanContext& context) {
  const ScanStamps stamps = StampsOf(scan);
  std::string line = "scan " + (stamps.scan_id ? std::to_string(*stamps.scan_id) : "not known");
  if (!scan.obstacles.empty()) {
    const obstacle_points_t& header = scan.obstacles.front();
    line += header.scan_state == obstacle_points_t::SCAN_COMPLETE
                ? " (complete)"
                : " (INCOMPLETE: " + std::to_string(header.missing_slices) + " slices missing)";
  }
  if (stamps.end_utime) line += ", ends " + Date(*stamps.end_utime);
  if (context.seconds_into_log) line += Format(", %.2f s into the log", *context.seconds_into_log);
  return line;
}

// "CHANNEL 1 of 2" when slices are missing, else empty.
template <typename Message>
std::string Gap(const char* channel, const std::vector<Message>& slices) {
  if (slices.empty() || static_cast<std::int64_t>(slices.size()) >= slices.front().slice_count) {
    return {};
  }
  return std::string(channel) + " (" + std::to_string(slices.size()) + " of " +
         std::to_string(slices.front().slice_count) + " slices)";
}

std::string RawGap(const ScanMessages& scan) {
  std::map<std::string, std::vector<lidar_points_t>> by_sensor;
  for (const lidar_points_t& slice : scan.raw) {
    lidar_points_t header;  // Without the points.
    header.slice_count = slice.slice_count;
    by_sensor[slice.sensor].push_back(header);
  }
  std::string text;
  for (const auto& [sensor, slices] : by_sensor) {
    if (text.empty()) text = Gap(channels::kLidarPoints.name, slices);
  }
  return text;
}

void Append(std::string& list, const std::string& item) {
  if (item.empty()) return;
  if (!list.empty()) list += ", ";
  list += item;
}

// What was not heard, or not whole; empty when all is there.
std::string MissingLine(const ScanMessages& scan, const ScanContext& context) {
  std::string missing;
  const auto name_if = [&](bool is_missing, const char* channel) {
    if (is_missing) Append(missing, channel);
  };
  name_if(scan.raw.empty(), channels::kLidarPoints.name);
  name_if(scan.obstacles.empty(), channels::kObstaclePoints.name);
  name_if(scan.removed.empty(), channels::kRemovedPoints.name);
  name_if(!scan.floor, channels::kFloor.name);
  name_if(scan.detections.empty(), channels::kDetections.name);
  name_if(!context.map.grid, channels::kMap.name);
  name_if(!scan.T_map_vehicle, channels::kPose.name);
  name_if(!scan.permit, channels::kDrivePermit.name);
  Append(missing, RawGap(scan));
  Append(missing, Gap(channels::kObstaclePoints.name, scan.obstacles));
  Append(missing, Gap(channels::kRemovedPoints.name, scan.removed));
  Append(missing, Gap(channels::kDetections.name, scan.detections));
  return missing.empty() ? missing : "not heard of this scan: " + missing;
}

// Slices that are there and not shown; empty when there are none.
std::string LeftOutLine(const ScanMessages& scan, const ScanContext& context) {
  std::string line;
  std::set<std::string> unknown;
  for (const lidar_points_t& slice : scan.raw) {
    if (!context.vehicle.FindSensor(slice.sensor)) unknown.insert(slice.sensor);
  }
  for (const std::string& sensor : unknown) {
    Append(line, "sensor '" + sensor + "' is not in the configuration");
  }
  if (scan.refused > 0) {
    Append(line,
           std::to_string(scan.refused) + " slices that came twice or from a second publisher");
  }
  return line.empty() ? line : "left out: " + line;
}

std::string PointsLine(const ScanMessages& scan) {
  if (scan.obstacles.empty()) return {};
  const obstacle_points_t& header = scan.obstacles.front();
  return Format("points: %d in, %d voxels, %d without the floor, %d left",
                header.points_in,
                header.points_voxel,
                header.points_floor,
                header.points_map);
}

std::string FloorLine(const ScanMessages& scan, const ScanContext& context) {
  if (!scan.floor) return {};
  constexpr const char* kStates[] = {
      "found", "held from an earlier scan", "not found, as configured (z = 0)"};
  std::string line = std::string("floor: ") +
                     kStates[static_cast<std::size_t>(std::clamp<int>(scan.floor->state, 0, 2))] +
                     Format(", tilt %.1f deg", Degrees(scan.floor->tilt_rad));
  if (scan.removed.empty() && !scan.raw.empty()) {
    line += Format("; shown: raw points within %.2f m of it", context.floor_threshold_m);
  }
  return line;
}

std::string MapLine(const ScanMessages& scan, const ScanContext& context) {
  const CollectedMap& map = context.map;
  if (!map.grid && scan.obstacles.empty()) return {};
  std::string line = "map: ";
  if (map.grid) {
    const core::GridGeometry& geometry = map.grid->geometry;
    line +=
        "epoch " + std::to_string(map.epoch) +
        Format(", %d x %d cells of %g m", geometry.width, geometry.height, geometry.resolution_m);
    if (map.tiles < map.tiles_expected) {
      line += Format(" (%d of %d tiles)", map.tiles, map.tiles_expected);
    }
  } else {
    line += "not known";
  }
  if (scan.obstacles.empty()) return line;
  const obstacle_points_t& header = scan.obstacles.front();
  line += std::string("; ") + messages::MapStateInWords(header.map_state);
  if (header.map_epoch != 0 && header.map_epoch != map.epoch) {
    line += " (FILTERED WITH EPOCH " + std::to_string(header.map_epoch) + ")";
  }
  return line;
}

std::string PoseLine(const ScanMessages& scan) {
  if (!scan.T_map_vehicle) return {};
  const Eigen::Isometry3d& pose = *scan.T_map_vehicle;
  return Format("pose: x %.2f m, y %.2f m, yaw %.1f deg in map",
                pose.translation().x(),
                pose.translation().y(),
                Degrees(std::atan2(pose.linear()(1, 0), pose.linear()(0, 0))));
}

std::string PermitLine(const ScanMessages& scan) {
  if (!scan.permit) return {};
  std::string line =
      Format("permit: forward %.2f m/s: ", scan.permit->forward_mps) + scan.permit->text;
  if (scan.permit->free_distance_m >= 0.0) {
    line += Format("; the nearest thing ahead at %.2f m", scan.permit->free_distance_m);
  }
  return line;
}

std::string DetectionsLine(const ScanMessages& scan) {
  if (scan.detections.empty()) return {};
  std::size_t count = 0;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const detections_t& slice : scan.detections) {
    for (const detection_t& detection : slice.detections) {
      ++count;
      nearest_m = std::min(nearest_m,
                           std::hypot(static_cast<double>(detection.nearest[0]),
                                      static_cast<double>(detection.nearest[1])));
    }
  }
  std::string line = "detections: " + std::to_string(count);
  return count == 0 ? line : line + Format(", the nearest at %.2f m", nearest_m);
}

}  // namespace

std::vector<std::string> DescribeScan(const ScanMessages& scan, const ScanContext& context) {
  std::vector<std::string> lines = {ScanLine(scan, context),
                                    MissingLine(scan, context),
                                    LeftOutLine(scan, context),
                                    PointsLine(scan),
                                    FloorLine(scan, context),
                                    MapLine(scan, context),
                                    PoseLine(scan),
                                    PermitLine(scan),
                                    DetectionsLine(scan)};
  std::erase(lines, "");
  return lines;
}

}  // namespace clearway::plot
