// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/graph/graph_config.hpp"
#include "tools/plot/scan_picture.hpp"
#include "tools/run_graph/run_statistics.hpp"

namespace clearway::run_graph {

/// The newest scan of a run with DETECTIONS as a picture. @pre there is one.
[[nodiscard]] plot::ScanPicture MakePicture(const RunStatistics& run,
                                            const graph::GraphConfig& config);

}  // namespace clearway::run_graph
