// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/config/config.hpp"
#include "common/core/procman/allow_list.hpp"
#include "common/core/procman/health_watch.hpp"
#include "common/core/procman/output_queue.hpp"
#include "common/core/procman/respawn_policy.hpp"
#include "common/process/buses_config.hpp"
#include "processes/procman_deputy/command_logs.hpp"

namespace clearway {

/// What a deputy does by itself when no sheriff speaks. XML element: <deputy><by_itself>.
struct ByItselfConfig {
  std::string deployment;
  std::string script;
  std::int64_t after_us = 10'000'000;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Text("deployment",
                 self.deployment,
                 "Deployment file (.pmd) whose script this deputy runs by itself, for its own "
                 "commands only. Empty: it waits for a sheriff.");
    visitor.Text("script", self.script, "Name of the script in that file.");
    visitor.Milliseconds("after_ms",
                         self.after_us,
                         0.0,
                         3600000.0,
                         "It begins when no sheriff has given orders for so long after the start "
                         "[ms], and there are none from an earlier life.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    if (deployment.empty() == script.empty()) return {};
    return {"deployment and script belong together: give both or none"};
  }
};

/// XML element: <deputy>.
struct DeputyConfig {
  std::string id;
  std::string graph_config;
  std::string state_folder;
  process::BusConfig bus;
  CommandLogsConfig logs;
  core::procman::RespawnConfig respawn;
  core::procman::HealthConfig health;
  core::procman::OutputConfig output;
  ByItselfConfig by_itself;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Text("id", self.id, "Name of the deputy, unique on its bus. Empty: the host's name.");
    visitor.Text("graph_config",
                 self.graph_config,
                 "The graph's configuration on this host: ${CLEARWAY_CONFIG} in command lines. Its "
                 "digest is published, so that hosts that differ are found before anything is "
                 "started. Empty: none.");
    visitor.Text("state_folder",
                 self.state_folder,
                 "Where the last orders are kept, so that the next life carries on. Empty: the one "
                 "that the service manager gives (STATE_DIRECTORY), else nothing is kept.");
    visitor.Group("bus", self.bus, "The bus that sheriffs speak on: the graph's shared bus.");
    visitor.Group("logs", self.logs, "Output of the commands on disk.");
    visitor.Group("respawn", self.respawn, "When a command that ended is started again.");
    visitor.Group("health", self.health, "When a command with a status counts as unhealthy.");
    visitor.Group("output", self.output, "Output of the commands on the bus.");
    visitor.Group("by_itself", self.by_itself, "What is started where no sheriff is.");
  }
};

/// A host's own file: what its owner lets sheriffs do here. XML element: <clearway>.
struct DeputyFile {
  DeputyConfig deputy;
  std::vector<core::procman::AllowRule> allow;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Group("deputy", self.deputy, "The deputy of this host.");
    visitor.List("allow", self.allow, "What sheriffs may have run here; all else is refused.");
  }
};

}  // namespace clearway

// What is long to compile is compiled once, in deputy_file.cpp.
namespace clearway::config {
extern template LoadResult<DeputyFile> Parse(const std::string& text,
                                             const std::string& file,
                                             std::span<const std::string> overrides);
extern template LoadResult<DeputyFile> Load(const std::filesystem::path& file,
                                            std::span<const std::string> overrides);
extern template std::string Print(const LoadResult<DeputyFile>& result);
}  // namespace clearway::config
