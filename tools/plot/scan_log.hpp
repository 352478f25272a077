// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/core/geometry/pose_buffer.hpp"
#include "tools/plot/map_collector.hpp"
#include "tools/plot/scan_messages.hpp"

namespace clearway::plot {

/// An LCM log and whose messages in it are meant.
struct ScanLog {
  std::filesystem::path file;
  std::string channel_prefix;
};

/// A scan of a log. A sender that starts anew counts its scans from 0 again: the stamp of its end
/// makes a scan one, not its id.
struct ScanEntry {
  std::int64_t scan_id = 0;
  std::int64_t end_utime = 0;        ///< [us since the epoch]
  std::int64_t first_log_utime = 0;  ///< When its first message was logged.
  std::int64_t last_log_utime = 0;   ///< And its last one.
  std::size_t last_event = 0;        ///< Number of that event in the log, from 0.
  bool has_detections = false;
};

/// The scans of a log, in the order in which they begin in it.
struct ScanIndex {
  std::string name;              ///< Of the file, for messages.
  std::int64_t first_utime = 0;  ///< Of the log's events [us since the epoch].
  std::int64_t last_utime = 0;
  std::vector<ScanEntry> scans;
};

/// A time of the log's events, counted from the first one [s].
[[nodiscard]] double SecondsInto(const ScanIndex& index, std::int64_t log_utime);

/// Looks through a log. Memory: O(scans). Throws io::ReadError when the file cannot be opened or
/// holds no scan: then it names the channels that there are.
[[nodiscard]] ScanIndex IndexScans(const ScanLog& log);

/// The scan with an id; the last one when several have it. Throws io::ReadError that names the
/// range of ids.
[[nodiscard]] ScanEntry ScanWithId(const ScanIndex& index, std::int64_t scan_id);

/// The scan that was being logged at a time, counted from the log's first event [s]: the last one
/// that began by then. Throws io::ReadError that names the range when there is none, or when the
/// log had ended.
[[nodiscard]] ScanEntry ScanAtTime(const ScanIndex& index, double time_s);

/// The last scan with DETECTIONS; the last one at all when none has any.
[[nodiscard]] ScanEntry LastScan(const ScanIndex& index);

/// The first scan and each n-th after it. @pre n > 0.
[[nodiscard]] std::vector<ScanEntry> EveryNthScan(const ScanIndex& index, int n);

/// A scan with all that the log holds of it, and the map as it was by then.
struct LoggedScan {
  ScanEntry entry;
  ScanMessages messages;
  CollectedMap map;
};

/// Reads scans and hands each on as soon as it is whole. Memory: the map and the scans that overlap
/// in time. `pose` is the configuration's <preprocessor><pose>. Throws io::ReadError.
void ReadScans(const ScanLog& log,
               const std::vector<ScanEntry>& wanted,
               const core::PoseBufferConfig& pose,
               const std::function<void(const LoggedScan&)>& take);

}  // namespace clearway::plot
