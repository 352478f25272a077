// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/core/vehicle.hpp"
#include "tools/plot/map_collector.hpp"
#include "tools/plot/scan_messages.hpp"
#include "tools/plot/scan_picture.hpp"

namespace clearway::plot {

/// What a picture needs besides the messages of its scan.
struct ScanContext {
  std::string title;
  core::VehicleConfig vehicle;
  double floor_threshold_m = 0.05;  ///< Of the configuration: <preprocessor><floor>.
  CollectedMap map = {};
  std::optional<double> seconds_into_log = {};  ///< When the first message of the scan came [s].
};

/// One scan as a picture. What was not heard is missing from it, is named in its text, and is not
/// guessed: the map is drawn only with the pose of the scan's end. The floor's points are those of
/// REMOVED_POINTS, else the raw points near the plane that FLOOR gives. O(points).
[[nodiscard]] ScanPicture MakePicture(const ScanMessages& scan, const ScanContext& context);

/// The legend's text; see ScanPicture::text_lines.
[[nodiscard]] std::vector<std::string> DescribeScan(const ScanMessages& scan,
                                                    const ScanContext& context);

}  // namespace clearway::plot
