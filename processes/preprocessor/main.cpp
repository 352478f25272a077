// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/process_main.hpp"
#include "processes/preprocessor/preprocessor_process.hpp"

int main(int argc, char** argv) {
  using namespace clearway;
  return graph::ProcessMain(
      argc,
      argv,
      {"preprocessor",
       "From raw LiDAR points to obstacle points: masks, deskew, voxel grid, floor",
       messages::channels::kPreprocessorStatus},
      [](const graph::GraphConfig& config, process::Node& node, process::LiveRuntime&) {
        return std::make_shared<PreprocessorProcess>(config.preprocessor, config.vehicle, node);
      });
}
