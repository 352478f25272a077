// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/core/procman/allow_list.hpp"
#include "common/core/procman/deployment.hpp"
#include "common/core/procman/exec_string.hpp"
#include "tools/doctor/finding.hpp"

/// Whether this host can run what a deployment wants of it.
namespace clearway::doctor {

/// A file that was named after a command's --config.
struct NamedConfig {
  bool is_readable = false;
  std::string digest;                 ///< Of a graph's configuration that is good.
  std::vector<std::string> problems;  ///< One line each; of a graph's configuration.
};

/// What a command is judged by: this host, as its deputy sees it.
struct HostView {
  core::procman::LookupVariable variable;
  std::function<std::optional<std::filesystem::path>(const std::string& name)> find_program;
  std::string search_path;  ///< Where it looks for programs, for messages.
  /// Reads a graph's configuration, or, when it is not one's, only whether it can be read.
  std::function<NamedConfig(const std::string& file, bool is_of_graph)> read_config;
  std::optional<core::procman::AllowList> allowed;  ///< Nothing: there is no host's file.
  std::string host_file;
  std::string graph_config;  ///< A good one on this host; empty: none is known.
};

/// The commands of the deployment for one deputy: found, allowed, with a status and files that are
/// there. What is good is one finding for all.
[[nodiscard]] Findings CheckCommands(const core::procman::Deployment& deployment,
                                     const std::string& deputy,
                                     const HostView& host);

/// The ids of the deputies that a deployment names, sorted.
[[nodiscard]] std::vector<std::string> DeputiesOf(const core::procman::Deployment& deployment);

/// Whether one of the deputy's commands drives a sensor that is reached over a network.
[[nodiscard]] bool HasLiveSensor(const core::procman::Deployment& deployment,
                                 const std::string& deputy);

/// The line of a host's file that allows this command and nothing else.
[[nodiscard]] std::string AllowElement(const core::procman::ExecLine& line);

}  // namespace clearway::doctor
