// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "common/process/node.hpp"
#include "tools/play/scan_source.hpp"

namespace clearway::play {

/// How a recording is played.
struct PlayerSettings {
  std::string sensor;     ///< Name in LIDAR_POINTS.
  bool loop = false;      ///< Begin again at the end, with stamps that go on.
  double settle_s = 0.0;  ///< Wait this long before the first scan.
};

/// Publishes LIDAR_POINTS: each slice when its share of the scan's time is over, at the pace of the
/// recording's stamps. A scan that cannot be read is reported, counted and left out.
class Player {
 public:
  struct Progress {
    std::size_t played = 0;      ///< Scans sent whole.
    std::size_t unreadable = 0;  ///< Scans that could not be read.
  };

  /// `on_done` is called after the last slice; when it loops, only after a whole pass in which no
  /// scan could be read.
  /// @pre the source holds at least one scan.
  Player(process::Node& node,
         ScanSource& source,
         const PlayerSettings& settings,
         std::function<void()> on_done);

  [[nodiscard]] const Progress& progress() const { return progress_; }

 private:
  void BeginNextScan();
  void LoadScan();
  void ScheduleSlice();
  void SendSlice();
  [[nodiscard]] std::int64_t StampOf(std::size_t scan) const;
  void ReportState(std::int8_t code);

  process::Node& node_;
  ScanSource& source_;
  PlayerSettings settings_;
  std::function<void()> on_done_;
  std::size_t next_scan_ = 0;        // Counts on through loops.
  std::vector<core::Slice> slices_;  // Of the scan that is being played.
  std::size_t next_slice_ = 0;
  std::int64_t monotonic_minus_utime_us_ = 0;
  Progress progress_;
};

}  // namespace clearway::play
