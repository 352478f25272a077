// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/process_main.hpp"
#include "processes/stop_guard/stop_guard_process.hpp"

int main(int argc, char** argv) {
  using namespace clearway;
  return graph::ProcessMain(
      argc,
      argv,
      {"stop_guard",
       "Permits motion while the way is seen to be free, from raw points and without a map",
       messages::channels::kStopGuardStatus},
      [](const graph::GraphConfig& config, process::Node& node, process::LiveRuntime&) {
        return std::make_shared<StopGuardProcess>(config.stop_guard, config.vehicle, node);
      });
}
