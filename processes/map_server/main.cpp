// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "common/graph/process_main.hpp"
#include "common/io/map/map_file.hpp"
#include "common/process/log.hpp"
#include "processes/map_server/map_server_process.hpp"

int main(int argc, char** argv) {
  using namespace clearway;
  return graph::ProcessMain(
      argc,
      argv,
      {"map_server",
       "Loads a Nav2 map and serves it on request",
       messages::channels::kMapServerStatus},
      [](const graph::GraphConfig& config, process::Node& node, process::LiveRuntime&) {
        if (config.map_server.file.empty()) {
          throw std::runtime_error("no map to serve: set map_server.file to a map's YAML file");
        }
        io::LoadedMap map = io::LoadMap(config.MapFile());
        process::LogInfo("serving " + config.MapFile().string());
        return std::make_shared<MapServerProcess>(std::move(map.grid), node);
      });
}
