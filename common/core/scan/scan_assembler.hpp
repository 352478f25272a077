// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <vector>

#include "common/core/cloud.hpp"
#include "common/core/scan/sequence_tracker.hpp"

namespace clearway::core {

/// Settings of ScanAssembler. XML element: <preprocessor><assembler>.
struct ScanAssemblerConfig {
  std::int64_t grace_us = 100'000;
  int max_in_flight = 4;
  std::int64_t restart_us = 2'000'000;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Milliseconds("grace_ms",
                         self.grace_us,
                         1.0,
                         10000.0,
                         "How long an incomplete scan is waited for after its last slice [ms]. "
                         "Longer than the time between two slices; it is added to the latency of "
                         "every scan that lost one.");
    visitor.Integer("max_in_flight",
                    self.max_in_flight,
                    1,
                    100,
                    "Scans that may be incomplete at a time; the oldest goes out when one more "
                    "begins.");
    visitor.Milliseconds("restart_ms",
                         self.restart_us,
                         100.0,
                         600000.0,
                         "A slice whose stamp is older than the last scan by more than this comes "
                         "from a sender that started anew, or from a log played again [ms].");
  }
};

/// A part of one sensor's scan, as it travels.
struct Slice {
  int sensor = -1;  ///< Index into VehicleConfig::sensors; -1: the name is not known there.
  std::int64_t session = 0;
  std::int64_t sequence = 0;        ///< Counts this sensor's slices.
  std::int64_t scan_id = 0;         ///< Ascending; the same for all sensors of one time grid.
  std::int64_t scan_utime = 0;      ///< Start of the scan [us since the epoch].
  std::int64_t scan_end_utime = 0;  ///< End of the scan.
  int slice_index = 0;              ///< 0 .. slice_count - 1, in order of time.
  int slice_count = 1;
  std::int64_t shots = 0;         ///< Shots fired for this slice.
  std::int64_t zero_returns = 0;  ///< Those without a return; not in the cloud.
  PointCloud cloud_sensor;        ///< Frame `sensor`; time offsets count from scan_utime.
};

/// False when a field has a value that no sender can mean: negative counts, an index outside the
/// count, more than kMaxSlices slices, a scan longer than kMaxScan_us, arrays of unequal length.
[[nodiscard]] bool IsValid(const Slice& slice);
inline constexpr int kMaxSlices = 4096;
inline constexpr std::int64_t kMaxScan_us = 60'000'000;

/// What became of a slice. Every slice has exactly one outcome.
enum class SliceOutcome : std::int8_t {
  kAccepted,       ///< Is, or will be, in exactly one assembled scan.
  kDuplicate,      ///< That slice of that scan is there already.
  kLate,           ///< Its scan, or a newer one, was emitted already.
  kUnknownSensor,  ///< Not a sensor of the configuration.
  kInconsistent,   ///< Slice count, stamps or session differ from the first slice of its scan.
  kForeign,        ///< Of a second publisher, or of a session that has ended.
  kInvalid,        ///< IsValid() is false, or a negative sequence.
};
inline constexpr std::size_t kNumSliceOutcomes = 7;

/// What one sensor gave to a scan.
struct SensorScan {
  bool present = false;  ///< At least one slice came.
  std::int64_t utime_start = 0;
  std::int64_t utime_end = 0;
  int slice_count = 0;
  int missing_slices = 0;
  PointCloud cloud_sensor;  ///< In order of the slices; time offsets count from utime_start.
};

/// One scan of all sensors.
struct AssembledScan {
  std::int64_t scan_id = 0;
  std::int64_t utime_start = 0;      ///< Earliest start of the sensors present.
  std::int64_t utime_end = 0;        ///< Latest end.
  std::vector<SensorScan> sensors;   ///< One for each configured sensor, in that order.
  std::vector<int> missing_sensors;  ///< Those that sent no slice of this scan, ascending.
  bool complete = false;             ///< Every slice of every configured sensor is there.
  int missing_slices = 0;            ///< Sum over the sensors present.
  std::int64_t shots = 0;
  std::int64_t zero_returns = 0;
};

/// Puts slices together to scans.
///
/// A scan is emitted when all slices of all sensors are there, or when it is due: grace_us after
/// its last new slice arrived, and not later than grace_us after a newer scan became complete.
/// Scans leave in ascending scan_id: a complete scan waits for an older one until that is due, so
/// for grace_us at most. A sensor that gave nothing to the last kAbsentScans scans is reported as
/// missing but no longer waited for, until it is heard again.
///
/// A sender starts anew when its session changes, when its ids go back while its numbering goes on,
/// when its stamps go back by more than restart_us, or when a scan id that was passed comes with a
/// start at or after the last scan's end. If its ids then lie at or below the last emitted one,
/// what is in flight is emitted as it is and the order begins again.
///
/// The result does not depend on the order in which the slices of a scan arrive.
/// Time: O(scans in flight) a slice. Thread safety: none.
class ScanAssembler {
 public:
  static constexpr int kAbsentScans = 5;

  /// @throws std::invalid_argument when num_sensors < 1.
  ScanAssembler(const ScanAssemblerConfig& config, int num_sensors);

  /// Takes a slice; `now_us` is the receiver's monotonic clock. Poll() afterwards.
  SliceOutcome Add(Slice slice, std::int64_t now_us);

  /// The scans that are complete or due, oldest first.
  [[nodiscard]] std::vector<AssembledScan> Poll(std::int64_t now_us);

  /// When Poll() should be called at the latest, on the clock of now_us; nothing while no scan is
  /// in flight.
  [[nodiscard]] std::optional<std::int64_t> NextDeadline() const;

  /// Slices so far, by outcome.
  [[nodiscard]] std::int64_t count(SliceOutcome outcome) const {
    return counts_[static_cast<std::size_t>(outcome)];
  }
  [[nodiscard]] std::int64_t restarts() const { return restarts_; }
  /// The numbering of one sensor's slices. @pre 0 <= sensor < num_sensors.
  [[nodiscard]] const SequenceCounts& sequence_counts(int sensor) const {
    return trackers_[static_cast<std::size_t>(sensor)].counts();
  }

 private:
  static constexpr std::int64_t kNoId = std::numeric_limits<std::int64_t>::min();

  struct Part {
    Slice head;                      // The first slice that came, without its cloud.
    std::vector<PointCloud> clouds;  // By slice index.
    std::vector<char> received;      // Likewise.
    int num_received = 0;
    [[nodiscard]] bool present() const { return num_received > 0; }
    [[nodiscard]] bool complete() const { return present() && num_received == head.slice_count; }
  };
  struct Pending {
    std::int64_t scan_id = 0;
    std::vector<Part> parts;  // By sensor.
    std::int64_t last_new_us = 0;
    std::int64_t due_cap_us = std::numeric_limits<std::int64_t>::max();
    std::int64_t shots = 0;
    std::int64_t zero_returns = 0;
  };

  [[nodiscard]] SliceOutcome Judge(Slice& slice, std::int64_t now_us);
  [[nodiscard]] bool Contradicts(const Slice& slice) const;
  [[nodiscard]] SliceOutcome Store(Slice& slice, std::int64_t now_us);
  [[nodiscard]] std::deque<Pending>::iterator FindOrOpen(std::int64_t scan_id);
  [[nodiscard]] bool IsDone(const Pending& pending) const;
  [[nodiscard]] std::int64_t DueAt(const Pending& pending) const;
  void Restart();
  void EmitFront();
  [[nodiscard]] static AssembledScan Finish(const Pending& pending);

  ScanAssemblerConfig config_;
  std::vector<SequenceTracker> trackers_;  // By sensor.
  std::vector<int> missed_in_row_;         // By sensor.
  std::vector<std::int64_t> stream_ids_;   // By sensor: scan of its newest slice in this order.
  std::deque<Pending> in_flight_;          // Ascending scan_id.
  std::vector<AssembledScan> ready_;
  bool has_emitted_ = false;  // In the present order of ids.
  std::int64_t last_id_ = 0;
  std::int64_t last_utime_start_ = 0;
  std::int64_t last_utime_end_ = 0;
  std::optional<std::int64_t> begun_by_session_;  // The session that appeared last.
  std::optional<std::int64_t> ended_session_;
  std::int64_t restarts_ = 0;
  std::array<std::int64_t, kNumSliceOutcomes> counts_{};
};

}  // namespace clearway::core
