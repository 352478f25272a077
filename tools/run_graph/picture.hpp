// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include <clearway/drive_permit_t.hpp>

#include "common/core/vehicle.hpp"
#include "tools/plot/scan_picture.hpp"
#include "tools/run_graph/run_statistics.hpp"

namespace clearway::run_graph {

/// One scan of a run as a picture. The floor's points are the raw points within
/// `floor_threshold_m` of the plane that FLOOR gives.
[[nodiscard]] plot::ScanPicture MakePicture(const ScanRecord& scan,
                                            const std::optional<drive_permit_t>& permit,
                                            const core::VehicleConfig& vehicle,
                                            double floor_threshold_m);

}  // namespace clearway::run_graph
