// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/core/perception/floor/floor_finder.hpp"

namespace clearway::core {

/// Where the plane in use comes from. The values are those of floor_t.
enum class FloorState : std::int8_t {
  kFound = 0,       ///< Fitted to this scan.
  kHeld = 1,        ///< The last good plane, not older than FloorConfig::hold_us.
  kConfigured = 2,  ///< z = 0 of the vehicle frame: no plane was found for longer than that.
};

/// The plane that a scan is judged by.
struct FloorEstimate {
  FloorState state = FloorState::kConfigured;
  FloorFit fit;  ///< Of this scan (kFound), the last good one (kHeld), else z = 0, 0 inliers.
  std::int64_t age_us = 0;  ///< Since the last good fit; -1 when there never was one.
};

/// Bridges scans without a visible floor.
class FloorTracker {
 public:
  explicit FloorTracker(const FloorConfig& config) : config_(config) {}

  /// Takes what was found in the scan with this stamp [us]. A stamp before the last one starts
  /// anew: what was found "later" is forgotten (a log that was wound back, a clock that was set).
  FloorEstimate Update(std::int64_t utime, const std::optional<FloorFit>& found);

 private:
  FloorConfig config_;
  std::optional<std::int64_t> last_utime_;
  std::optional<FloorFit> last_good_;
  std::int64_t last_good_utime_ = 0;
};

}  // namespace clearway::core
