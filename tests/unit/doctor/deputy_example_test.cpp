// SPDX-License-Identifier: BSD-3-Clause
// procman/deputy.xml, the example of a host's own file.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "common/core/procman/allow_list.hpp"
#include "common/core/procman/exec_string.hpp"
#include "common/io/procman/pmd_reader.hpp"
#include "processes/procman_deputy/deputy_options.hpp"

namespace clearway {
namespace {

std::filesystem::path ProcmanFolder() {
  return std::filesystem::path(std::getenv("CLEARWAY_SOURCE")) / "procman";
}

DeputyFile Example() {
  DeputyOptions options;
  options.config_path = ProcmanFolder() / "deputy.xml";
  return LoadDeputyFile(options).root;
}

std::string WhyRefused(const DeputyFile& file, const std::string& exec) {
  const auto parsed = core::procman::ParseExecLine(exec, [&file](const std::string& name) {
    return name == "CLEARWAY_CONFIG" ? std::optional(file.deputy.graph_config) : std::nullopt;
  });
  EXPECT_EQ(parsed.problem, "") << exec;
  return core::procman::AllowList(file.allow).WhyRefused(*parsed.line);
}

TEST(DeputyExample, AllowsWhatTheRobotRuns) {
  const DeputyFile file = Example();
  int num_commands = 0;
  for (const char* name : {"robot.pmd", "robot_laptop.pmd"}) {
    for (const auto& command : io::ReadPmd(ProcmanFolder() / name).commands) {
      if (command.deputy != file.deputy.id) continue;
      ++num_commands;
      EXPECT_EQ(WhyRefused(file, command.spec.exec), "") << name << ": " << command.spec.id;
    }
  }
  EXPECT_GT(num_commands, 5);
}

TEST(DeputyExample, AllowsNothingElse) {
  const DeputyFile file = Example();

  for (const char* exec : {"sh -c 'rm -rf /'",
                           "clearway-clusterer --config /tmp/other.xml",
                           "clearway-clusterer --config ${CLEARWAY_CONFIG} --set a.b=c",
                           "LD_PRELOAD=/tmp/x.so clearway-clusterer --config ${CLEARWAY_CONFIG}",
                           "/tmp/clearway-clusterer --config ${CLEARWAY_CONFIG}"}) {
    EXPECT_NE(WhyRefused(file, exec), "") << exec;
  }
}

TEST(DeputyExample, RulesOfTheReadmeAreGoodAndAllowWhatTheySay) {
  std::ifstream stream(ProcmanFolder() / "README.md");
  const std::string readme((std::istreambuf_iterator<char>(stream)), {});
  const std::size_t begin = readme.find("```xml\n") + 7;
  const std::string rules = readme.substr(begin, readme.find("```", begin) - begin);
  DeputyFile file =
      config::Parse<DeputyFile>("<clearway version=\"1\">" + rules + "</clearway>", "README.md")
          .root;
  file.deputy.graph_config = "/etc/clearway/graph.xml";

  for (const char* exec :
       {"clearway-play --config ${CLEARWAY_CONFIG} --input /srv/recordings/a --loop",
        "lcm-logger --split-mb=100 --rotate=20 /var/log/clearway/lcm.log",
        "chrt --fifo 20 clearway-stop-guard --config ${CLEARWAY_CONFIG}"}) {
    EXPECT_EQ(WhyRefused(file, exec), "");
  }
}

TEST(DeputyExample, IsOnTheGraphsBusByDefault) {
  const process::BusesConfig buses;

  EXPECT_EQ(Example().deputy.bus.url, buses.shared.url);
  EXPECT_EQ(Example().deputy.bus.ttl, buses.shared.ttl);
}

}  // namespace
}  // namespace clearway
