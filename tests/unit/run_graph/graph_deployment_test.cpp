// SPDX-License-Identifier: BSD-3-Clause
#include "tools/run_graph/graph_deployment.hpp"

#include <algorithm>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/procman/exec_string.hpp"
#include "common/messages/channels.hpp"

namespace clearway::run_graph {
namespace {

using core::procman::DeployedCommand;
using core::procman::ExecLine;
using testing::ElementsAre;
using testing::Pair;

RunSettings LabRun() {
  RunSettings settings;
  settings.input = "/data/my $HOME/it's \"a\" \\ folder";
  settings.child_arguments = {"--config", "/etc/lab one.xml", "--set", "a.b=c"};
  settings.buses.local.url = "udpm://239.255.76.67:7000";
  return settings;
}

// As a deputy reads it that has every variable set.
ExecLine LineOf(const core::procman::Deployment& deployment, const std::string& id) {
  const auto found = std::find_if(deployment.commands.begin(),
                                  deployment.commands.end(),
                                  [&](const DeployedCommand& c) { return c.spec.id == id; });
  if (found == deployment.commands.end()) return {};
  return core::procman::ParseExecLine(found->spec.exec,
                                      [](const auto&) { return std::optional<std::string>("x"); })
      .line.value_or(ExecLine{});
}

TEST(GraphDeploymentTest, HasTheProcessesAndTheirFeederOnTheOneDeputyAndRespawnsNone) {
  RunSettings settings = LabRun();
  settings.with_map_server = settings.with_pose_source = true;

  const auto deployment = MakeDeployment(settings, "d");

  std::vector<std::string> graph;
  std::vector<std::string> input;
  for (const DeployedCommand& command : deployment.commands) {
    EXPECT_EQ(command.deputy, "d");
    EXPECT_FALSE(command.spec.auto_respawn);
    (command.spec.group == kGraphGroup ? graph : input).push_back(command.spec.id);
  }
  EXPECT_THAT(graph,
              ElementsAre("preprocessor", "clusterer", "stop_guard", "map_server", "pose_source"));
  EXPECT_THAT(input, ElementsAre("play"));
}

TEST(GraphDeploymentTest, NamesTheStatusChannelThatTellsWhetherAProcessIsReady) {
  const ExecLine line = LineOf(MakeDeployment(LabRun(), "d"), "stop_guard");

  EXPECT_THAT(
      line.environment,
      ElementsAre(Pair("CLEARWAY_STATUS_CHANNEL", messages::channels::kStopGuardStatus.name)));
  EXPECT_THAT(line.arguments,
              ElementsAre("clearway-stop-guard", "--config", "/etc/lab one.xml", "--set", "a.b=c"));
}

TEST(GraphDeploymentTest, ThePathOfTheInputSurvivesWhateverIsInIt) {
  const RunSettings settings = LabRun();

  EXPECT_THAT(LineOf(MakeDeployment(settings, "d"), "play").arguments,
              ElementsAre("clearway-play",
                          "--headless",
                          "--input",
                          settings.input.string(),
                          "--config",
                          "/etc/lab one.xml",
                          "--set",
                          "a.b=c"));
}

TEST(GraphDeploymentTest, OfALogOnlyInputsArePlayedOnTheLocalBus) {
  RunSettings settings = LabRun();
  settings.kind = InputKind::kLog;
  settings.channel_prefix = "a.b_";

  EXPECT_THAT(LineOf(MakeDeployment(settings, "d"), "play").arguments,
              ElementsAre("lcm-logplayer",
                          "-l",
                          "udpm://239.255.76.67:7000?ttl=0",
                          "-e",
                          "a\\.b_(LIDAR_POINTS|ODOMETRY|POSE|POSE_STATUS)",
                          settings.input.string()));
  settings.with_pose_source = true;
  EXPECT_EQ(LineOf(MakeDeployment(settings, "d"), "play").arguments.at(4),
            "a\\.b_(LIDAR_POINTS|ODOMETRY)");
}

TEST(GraphDeploymentTest, ALiveInputNeedsNoFeeder) {
  RunSettings settings = LabRun();
  settings.kind = InputKind::kLive;

  EXPECT_EQ(MakeDeployment(settings, "d").commands.size(), 3U);
}

TEST(GraphDeploymentTest, ASimulatedRunHasTheDriverInItsGraphAndTheSimulatorAsItsFeeder) {
  RunSettings settings = LabRun();
  settings.kind = InputKind::kSimulated;

  const auto deployment = MakeDeployment(settings, "d");

  EXPECT_THAT(
      LineOf(deployment, "livox_driver").arguments,
      ElementsAre("clearway-livox-driver", "--config", "/etc/lab one.xml", "--set", "a.b=c"));
  EXPECT_THAT(LineOf(deployment, "simulator").arguments,
              ElementsAre("clearway-simulator", "--config", "/etc/lab one.xml", "--set", "a.b=c"));
  EXPECT_THAT(LineOf(deployment, "play").arguments, testing::IsEmpty());
}

TEST(GraphDeploymentTest, AnLvxFileIsPlayedByTheDriver) {
  RunSettings settings = LabRun();
  settings.kind = InputKind::kLvx;
  settings.input = "/data/a b.lvx";

  const ExecLine line = LineOf(MakeDeployment(settings, "d"), FeederName(settings));

  EXPECT_THAT(line.arguments,
              ElementsAre("clearway-livox-driver",
                          "--replay",
                          "/data/a b.lvx",
                          "--config",
                          "/etc/lab one.xml",
                          "--set",
                          "a.b=c"));
}

}  // namespace
}  // namespace clearway::run_graph
