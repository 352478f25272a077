// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/process_main.hpp"
#include "processes/clusterer/clusterer_process.hpp"

int main(int argc, char** argv) {
  using namespace clearway;
  return graph::ProcessMain(
      argc,
      argv,
      {"clusterer",
       "From obstacle points to detections: Euclidean clusters, hulls, rectangles",
       messages::channels::kClustererStatus},
      [](const graph::GraphConfig& config, process::Node& node, process::LiveRuntime&) {
        return std::make_shared<ClustererProcess>(
            config.clusterer.backend, config.clusterer.clustering, node);
      });
}
