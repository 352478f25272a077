// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/process_main.hpp"

#include <algorithm>

#include <CLI/CLI.hpp>

#include "common/graph/options.hpp"
#include "common/process/log.hpp"

namespace clearway::graph {

int ProcessMain(int argc, char** argv, const ProcessInfo& info, const MakeProcess& make) {
  std::string program = "clearway-" + info.name;
  std::replace(program.begin(), program.end(), '_', '-');
  CLI::App app(info.description, program);
  Options options;
  AddOptions(app, options);
  if (info.add_options) info.add_options(app);
  return GuardedMain(app, options, argc, argv, [&] {
    const config::LoadResult<GraphConfig> config = LoadConfig(options);
    if (AnsweredByConfig(options, config)) return kExitOk;
    if (info.answer && info.answer(config.root)) return kExitOk;

    process::LiveRuntime runtime(config.root.buses, options.channel_prefix);
    process::Node node(
        runtime, {info.name, CLEARWAY_VERSION, config::Digest(config.root)}, info.status_channel);
    const std::shared_ptr<void> process = make(config.root, node, runtime);
    process::LogInfo("started, configuration " + config::Digest(config.root));
    runtime.Run();
    node.RefreshAndPublishStatus();
    process::LogInfo("stopped");
    return kExitOk;
  });
}

}  // namespace clearway::graph
