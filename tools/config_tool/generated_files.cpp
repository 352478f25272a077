// SPDX-License-Identifier: BSD-3-Clause
#include "tools/config_tool/generated_files.hpp"

#include "common/core/simulation/scene.hpp"
#include "common/graph/graph_config.hpp"

namespace clearway::config_tool {

std::string DefaultXml() {
  return config::ToXml(graph::GraphConfig{}, {.with_help = true});
}

std::string ReferenceMarkdown() {
  return "# Reference of the configuration\n\n" + config::Reference(graph::GraphConfig{}) +
         "\n# Reference of scene files\n\n" + config::Reference(core::SceneFile{});
}

}  // namespace clearway::config_tool
