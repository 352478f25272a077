// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>

#include "common/core/guard/stop_guard_config.hpp"
#include "common/core/scan/freshness_watch.hpp"
#include "common/core/scan/sequence_tracker.hpp"
#include "common/core/vehicle.hpp"

namespace clearway::core {

/// Directions around the vehicle in sectors of 5 deg; sector k begins at -180 deg + 5 k deg.
using Sectors = std::bitset<72>;

/// The sectors that lie in the sensor's horizontal field of view altogether. A sensor whose x axis
/// points up or down (within 45 deg) sees none.
[[nodiscard]] Sectors FieldOfView(const SensorConfig& sensor);

/// What is wrong with a sensor's stream, the gravest first.
enum class SensorState : std::int8_t {
  kGood,
  kNotHeard,       ///< No slice has come yet.
  kSilent,         ///< None within slice_timeout_us.
  kLate,           ///< Slices come, but late: a queue is being drained, a stage is too slow.
  kTwoPublishers,  ///< A second publisher, or slices played again, within
                   ///< SequenceTracker::kForeign_us.
  kNoReturns,      ///< Slices without returns: covered, or looking at nothing.
};

/// Judges the stream of one sensor. Only the newest slice of the stream makes it fresh: what is
/// repeated, overtaken or of a second publisher does not.
class SensorWatch {
 public:
  explicit SensorWatch(const StopGuardConfig& config) : config_(config) {}

  /// A valid slice arrived; `stamp_us` is the end of its measurement. True when it is the newest
  /// of its stream: then its returns are to be told by OnReturns().
  bool OnSlice(std::int64_t session,
               std::int64_t sequence,
               std::int64_t stamp_us,
               std::int64_t now_us);
  /// `num_returns` counts the returns of a slice that can be believed.
  void OnReturns(std::int64_t num_returns, std::int64_t now_us);

  [[nodiscard]] SensorState State(std::int64_t now_us) const;
  [[nodiscard]] const SequenceCounts& counts() const { return tracker_.counts(); }
  /// As FreshnessWatch::Query().
  [[nodiscard]] FreshnessWatch::State Freshness(std::int64_t now_us) const {
    return freshness_.Query(now_us);
  }

 private:
  [[nodiscard]] std::int64_t ReturnsWithinWindow(std::int64_t now_us) const;
  [[nodiscard]] bool RestartedLately(std::int64_t now_us) const;

  StopGuardConfig config_;
  SequenceTracker tracker_;
  FreshnessWatch freshness_;
  bool foreign_heard_ = false;
  std::int64_t foreign_us_ = 0;
  bool has_restarted_ = false;
  std::int64_t restart_us_ = 0;
  std::int64_t half_start_us_ = 0;   // The window is counted in halves.
  std::int64_t returns_now_ = 0;     // Since half_start_us_.
  std::int64_t returns_before_ = 0;  // In the half before.
};

}  // namespace clearway::core
