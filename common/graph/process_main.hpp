// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/graph/graph_config.hpp"
#include "common/messages/channels.hpp"
#include "common/process/live_runtime.hpp"
#include "common/process/node.hpp"

namespace CLI {
class App;
}

namespace clearway::graph {

/// What main() of a process says about it.
struct ProcessInfo {
  std::string name;         ///< e.g. "preprocessor"; the program is clearway-<name>.
  std::string description;  ///< One sentence, for --help.
  messages::Channel<status_t> status_channel;
  std::function<void(CLI::App&)> add_options = {};  ///< Options of its own; may be empty.
  /// Does what needs no bus; true when that was all. May be empty.
  std::function<bool(const GraphConfig&)> answer = {};
};

/// Makes the process object; it lives until the process stops.
using MakeProcess =
    std::function<std::shared_ptr<void>(const GraphConfig&, process::Node&, process::LiveRuntime&)>;

/// The whole main() of a process of the graph: options, configuration, buses, run until a signal,
/// last status. Returns the exit status.
int ProcessMain(int argc, char** argv, const ProcessInfo& info, const MakeProcess& make);

}  // namespace clearway::graph
