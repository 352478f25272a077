// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "common/graph/process_main.hpp"
#include "processes/pose_source/pose_source_process.hpp"

int main(int argc, char** argv) {
  using namespace clearway;
  return graph::ProcessMain(
      argc,
      argv,
      {"pose_source",
       "Publishes POSE: a fixed pose, or dead reckoning from ODOMETRY",
       messages::channels::kPoseSourceStatus},
      [](const graph::GraphConfig& config, process::Node& node, process::LiveRuntime&) {
        if (config.pose_source.mode == core::PoseSourceMode::kOff) {
          throw std::runtime_error(
              "nothing to do: set pose_source.mode to \"fixed\" or \"dead_reckoning\"");
        }
        return std::make_shared<PoseSourceProcess>(config.pose_source, node);
      });
}
