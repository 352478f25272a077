// SPDX-License-Identifier: BSD-3-Clause
#include "tools/replay/compare_detections.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <utility>

#include "common/io/lcm_log.hpp"
#include "common/io/read_error.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"

namespace clearway::replay {
namespace {

using messages::channels::kDetections;

std::string Text(float value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.9g", static_cast<double>(value));
  return text.data();
}

std::string Text(std::int64_t value) {
  return std::to_string(value);
}

bool IsSame(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

bool IsSame(std::int64_t a, std::int64_t b) {
  return a == b;
}

// Looks at pairs of values and keeps the first that differs, in words.
class FirstDifference {
 public:
  template <typename Value>
  void Look(const std::string& name, const Value& a, const Value& b) {
    if (!found_.empty() || IsSame(a, b)) return;
    found_ = name + " " + Text(a) + ", reference " + Text(b);
  }

  template <typename Values>
  void LookAtAll(const std::string& name, const Values& a, const Values& b) {
    Look("number of " + name, CountOf(a), CountOf(b));
    for (std::size_t i = 0; found_.empty() && i < std::size(a); ++i) {
      Look(name + "[" + std::to_string(i) + "]", a[i], b[i]);
    }
  }

  [[nodiscard]] const std::string& found() const { return found_; }

 private:
  template <typename Values>
  static std::int64_t CountOf(const Values& values) {
    return static_cast<std::int64_t>(std::size(values));
  }

  std::string found_;
};

std::string DifferenceOf(const detection_t& a, const detection_t& b) {
  FirstDifference difference;
  const auto look = [&](const char* name, std::int64_t x, std::int64_t y) {
    difference.Look(name, x, y);
  };
  look("id", a.id, b.id);
  look("track_id", a.track_id, b.track_id);
  look("points", a.points, b.points);
  look("points_below_floor", a.points_below_floor, b.points_below_floor);
  difference.LookAtAll("centroid", a.centroid, b.centroid);
  difference.LookAtAll("nearest", a.nearest, b.nearest);
  difference.Look("z_min", a.z_min, b.z_min);
  difference.Look("z_max", a.z_max, b.z_max);
  difference.LookAtAll("center", a.center, b.center);
  difference.Look("length_m", a.length_m, b.length_m);
  difference.Look("width_m", a.width_m, b.width_m);
  difference.Look("yaw_rad", a.yaw_rad, b.yaw_rad);
  difference.Look("yaw_confidence", a.yaw_confidence, b.yaw_confidence);
  difference.LookAtAll("velocity", a.velocity, b.velocity);
  difference.Look("velocity_variance", a.velocity_variance, b.velocity_variance);
  look("kind", a.kind, b.kind);
  difference.LookAtAll("hull_x", a.hull_x, b.hull_x);
  difference.LookAtAll("hull_y", a.hull_y, b.hull_y);
  return difference.found();
}

std::string DifferenceOf(const detections_t& a, const detections_t& b) {
  FirstDifference difference;
  const auto look = [&](const char* name, std::int64_t x, std::int64_t y) {
    difference.Look(name, x, y);
  };
  look("scan_id", a.scan_id, b.scan_id);
  look("utime", a.utime, b.utime);
  look("floor_state", a.floor_state, b.floor_state);
  look("map_state", a.map_state, b.map_state);
  look("points_in", a.points_in, b.points_in);
  look("number of detections", a.n, b.n);
  if (!difference.found().empty()) return difference.found();
  for (std::size_t i = 0; i < a.detections.size(); ++i) {
    const std::string found = DifferenceOf(a.detections[i], b.detections[i]);
    if (!found.empty()) return "detection " + std::to_string(i) + ": " + found;
  }
  return {};
}

void CompareScan(const DetectionsOfRun::Scan& run,
                 const DetectionsOfRun::Scan& reference,
                 Comparison& comparison) {
  if (!run.is_complete || !reference.is_complete) {
    ++comparison.incomplete;
    return;
  }
  comparison.detections += run.whole.detections.size();
  const std::string difference = DifferenceOf(run.whole, reference.whole);
  if (difference.empty()) {
    ++comparison.equal;
  } else if (comparison.different++ == 0) {
    comparison.first_difference = "scan " + std::to_string(run.whole.scan_id) + " at " +
                                  std::to_string(run.whole.scan_utime) + " us: " + difference;
  }
}

}  // namespace

void DetectionsOfRun::Add(detections_t slice) {
  if (slice.slice_index < 0 || slice.slice_index >= slice.slice_count) {
    ++invalid_;
    return;
  }
  const auto [found, is_new] = scans_.try_emplace(slice.scan_utime);
  Slices& slices = found->second;
  if (is_new) {
    slices.session = slice.session;
    slices.count = slice.slice_count;
  }
  if (slice.session != slices.session) {
    slices.other_session = slice.session;
  } else if (slice.slice_count != slices.count) {
    ++invalid_;
  } else {
    slices.by_index.try_emplace(slice.slice_index, std::move(slice));
  }
}

std::map<std::int64_t, DetectionsOfRun::Scan> DetectionsOfRun::Scans() const {
  std::map<std::int64_t, Scan> scans;
  for (const auto& [scan_utime, slices] : scans_) {
    if (slices.other_session) {
      throw io::ErrorInFile(name_,
                            "scan at " + std::to_string(scan_utime) + " us: sessions " +
                                std::to_string(slices.session) + " and " +
                                std::to_string(*slices.other_session) +
                                " both published DETECTIONS of it; expected the log of one run");
    }
    Scan scan;
    for (const auto& [index, slice] : slices.by_index) {
      if (scan.whole.slice_count == 0) {
        scan.whole = slice;
        continue;
      }
      const auto& more = slice.detections;
      scan.whole.detections.insert(scan.whole.detections.end(), more.begin(), more.end());
    }
    scan.whole.n = static_cast<std::int32_t>(scan.whole.detections.size());
    scan.is_complete = slices.by_index.size() == static_cast<std::size_t>(slices.count) &&
                       scan.whole.scan_state == detections_t::SCAN_COMPLETE;
    scans.emplace(scan_utime, std::move(scan));
  }
  return scans;
}

DetectionsOfRun ReadDetections(const std::filesystem::path& log,
                               const std::string& channel_prefix) {
  DetectionsOfRun detections(log.string());
  const std::string channel = channel_prefix + kDetections.name;
  io::LcmLogReader reader(log);
  while (const std::optional<io::LogEvent> event = reader.Next()) {
    if (event->channel != channel) continue;
    if (auto slice = messages::Decode<detections_t>(event->bytes)) {
      detections.Add(*std::move(slice));
    } else {
      detections.AddInvalid();
    }
  }
  return detections;
}

Comparison Compare(const DetectionsOfRun& run, const DetectionsOfRun& reference) {
  const auto ours = run.Scans();
  const auto theirs = reference.Scans();
  Comparison comparison;
  comparison.invalid = run.invalid() + reference.invalid();
  for (const auto& [scan_utime, scan] : ours) {
    const auto found = theirs.find(scan_utime);
    if (found == theirs.end()) {
      ++comparison.only_in_run;
    } else {
      CompareScan(scan, found->second, comparison);
    }
  }
  comparison.only_in_reference = static_cast<std::size_t>(
      std::count_if(theirs.begin(), theirs.end(), [&ours](const auto& scan) {
        return !ours.contains(scan.first);
      }));
  return comparison;
}

}  // namespace clearway::replay
