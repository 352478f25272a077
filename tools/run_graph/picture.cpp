// SPDX-License-Identifier: BSD-3-Clause
#include "tools/run_graph/picture.hpp"

#include "tools/plot/scan_from_messages.hpp"

namespace clearway::run_graph {

plot::ScanPicture MakePicture(const RunStatistics& run, const graph::GraphConfig& config) {
  return plot::MakePicture(*run.LastDetectedScan(),
                           {.title = "clearway: last scan of the run",
                            .vehicle = config.vehicle,
                            .floor_threshold_m = config.preprocessor.floor.distance_threshold_m,
                            .map = run.map()});
}

}  // namespace clearway::run_graph
