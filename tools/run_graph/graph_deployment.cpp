// SPDX-License-Identifier: BSD-3-Clause
#include "tools/run_graph/graph_deployment.hpp"

#include <algorithm>
#include <cctype>

#include "common/core/procman/exec_string.hpp"

namespace clearway::run_graph {
namespace {

using core::procman::DeployedCommand;
using core::procman::ExecLine;

constexpr float kStopTime_s = 3.0F;

// The channels of a log that may be played into the graph, as a regular expression of
// lcm-logplayer, which anchors it at both ends. POSE has one publisher.
std::string InputsOf(const RunSettings& settings) {
  std::string prefix;
  for (const char c : settings.channel_prefix) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') prefix += '\\';
    prefix += c;
  }
  return prefix + (settings.with_pose_source ? "(LIDAR_POINTS|ODOMETRY)"
                                             : "(LIDAR_POINTS|ODOMETRY|POSE|POSE_STATUS)");
}

std::string ProgramOf(std::string process) {
  std::replace(process.begin(), process.end(), '_', '-');
  return "clearway-" + process;
}

std::string StatusChannelOf(std::string process) {
  std::transform(process.begin(), process.end(), process.begin(), [](unsigned char c) {
    return static_cast<char>(std::toupper(c));
  });
  return process + "_STATUS";
}

ExecLine ProgramLine(const std::string& process,
                     std::vector<std::string> own_arguments,
                     const RunSettings& settings) {
  ExecLine line{.environment = {}, .arguments = {ProgramOf(process)}};
  line.arguments.insert(line.arguments.end(), own_arguments.begin(), own_arguments.end());
  line.arguments.insert(
      line.arguments.end(), settings.child_arguments.begin(), settings.child_arguments.end());
  return line;
}

ExecLine FeederOf(const RunSettings& settings) {
  switch (settings.kind) {
    case InputKind::kLog:
      return {.environment = {},
              .arguments = {"lcm-logplayer",
                            "-l",
                            settings.buses.local.url + "?ttl=0",
                            "-e",
                            InputsOf(settings),
                            settings.input}};
    case InputKind::kLvx:
      return ProgramLine("livox_driver", {"--replay", settings.input}, settings);
    case InputKind::kSimulated:
      return ProgramLine("simulator", {}, settings);
    case InputKind::kPlayed:
    case InputKind::kLive:
      break;
  }
  return ProgramLine("play", {"--headless", "--input", settings.input}, settings);
}

DeployedCommand CommandOf(const std::string& id, const char* group, const ExecLine& line) {
  DeployedCommand command;
  command.spec.id = id;
  command.spec.group = group;
  command.spec.exec = core::procman::FormatExecLine(line);
  command.spec.stop_time_allowed_s = kStopTime_s;
  return command;
}

}  // namespace

std::string FeederName(const RunSettings& settings) {
  if (settings.kind == InputKind::kSimulated) return "simulator";
  return settings.kind == InputKind::kLvx ? "livox_driver" : "play";
}

std::vector<std::string> ProcessNames(const RunSettings& settings) {
  std::vector<std::string> names{"preprocessor", "clusterer", "stop_guard"};
  if (settings.kind == InputKind::kSimulated) names.emplace_back("livox_driver");
  if (settings.with_map_server) names.emplace_back("map_server");
  if (settings.with_pose_source) names.emplace_back("pose_source");
  return names;
}

core::procman::Deployment MakeDeployment(const RunSettings& settings, const std::string& deputy) {
  core::procman::Deployment deployment;
  for (const std::string& process : ProcessNames(settings)) {
    // By its status the deputy tells whether it is ready.
    ExecLine line = ProgramLine(process, {}, settings);
    line.environment = {{"CLEARWAY_STATUS_CHANNEL", StatusChannelOf(process)}};
    deployment.commands.push_back(CommandOf(process, kGraphGroup, line));
  }
  if (settings.kind != InputKind::kLive) {
    deployment.commands.push_back(CommandOf(FeederName(settings), kInputGroup, FeederOf(settings)));
  }
  for (DeployedCommand& command : deployment.commands) command.deputy = deputy;
  return deployment;
}

}  // namespace clearway::run_graph
