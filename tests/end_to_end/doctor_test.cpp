// SPDX-License-Identifier: BSD-3-Clause
// clearway-doctor on hosts with something wrong, each a network namespace. What it says to mend is
// done, word by word, and it must be content then.
#include <arpa/inet.h>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <netinet/in.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/host/descriptor.hpp"
#include "tests/support/command_line.hpp"
#include "tests/support/deputy_fixture.hpp"

namespace clearway::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// A network without interfaces that are up, until the object goes.
class BareNetwork {
 public:
  explicit BareNetwork(const std::filesystem::path& folder)
      : holder_("network", {"unshare", "--net", "sleep", "1000"}, folder / "network.log") {
    const auto own = std::filesystem::read_symlink("/proc/self/ns/net");
    for (int i = 0; i < 1000 && std::filesystem::read_symlink(Path()) == own; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  // The same command, in this network.
  [[nodiscard]] std::vector<std::string> Inside(const std::vector<std::string>& command) const {
    return With({"nsenter", "--net=" + Path()}, command);
  }

 private:
  [[nodiscard]] std::string Path() const {
    return "/proc/" + std::to_string(holder_.pid()) + "/ns/net";
  }
  host::ChildProcess holder_;
};

struct Said {
  ProgramResult program;
  nlohmann::json json;

  // The findings of a check that are in this state.
  [[nodiscard]] std::vector<nlohmann::json> Of(const std::string& check,
                                               const std::string& state) const {
    std::vector<nlohmann::json> findings;
    for (const auto& each : json.at("findings")) {
      if (each.at("check") == check && each.at("state") == state) findings.push_back(each);
    }
    return findings;
  }

  // All commands and lines that mend the problems of a check.
  [[nodiscard]] std::vector<std::string> MendOf(const std::string& check) const {
    std::vector<std::string> all;
    for (const auto& each : Of(check, "problem")) {
      for (const std::string command : each.at("mend")) all.push_back(command);
    }
    return all;
  }

  // The words of the one problem that a check has.
  [[nodiscard]] std::string ProblemOf(const std::string& check) const {
    const auto problems = Of(check, "problem");
    EXPECT_EQ(problems.size(), 1U) << program.out << program.err;
    return problems.empty() ? std::string() : problems.front().at("text").get<std::string>();
  }
};

class DoctorTest : public DeputyProgramTest {
 protected:
  Said Ask(const std::vector<std::string>& arguments, const BareNetwork* network = nullptr) {
    const std::filesystem::path file = folder_.path() / "doctor.json";
    std::filesystem::remove(file);
    std::vector<std::string> command = With({Program("doctor"), "--json", file}, arguments);
    if (network != nullptr) command = network->Inside(command);
    Said said{RunProgram(command, folder_.path()), {}};
    std::ifstream stream(file);
    said.json = nlohmann::json::parse(stream, nullptr, false);
    EXPECT_FALSE(said.json.is_discarded()) << said.program.out << said.program.err;
    return said;
  }

  void Run(const std::string& command, const BareNetwork& network) {
    const ProgramResult result = RunProgram(network.Inside({"sh", "-c", command}), folder_.path());
    EXPECT_EQ(result.exit_status, 0) << command << ": " << result.err;
  }
};

TEST_F(DoctorTest, IsContentWithAHostThatIsGood) {
  const Said said = Ask({"--config", ShippedConfig("lab.xml"), "--lcm-url", url_});

  EXPECT_EQ(said.program.exit_status, 0) << said.program.out;
  EXPECT_EQ(said.json["problems"], 0);
  for (const char* check : {"configuration", "multicast_route", "port", "loop_back", "traffic"}) {
    EXPECT_EQ(said.Of(check, "ok").size(), 1U) << check << '\n' << said.program.out;
  }
  EXPECT_THAT(said.program.out, HasSubstr("0 problems, "));
}

TEST_F(DoctorTest, AMissingRouteIsMendedByWhatItSays) {
  const BareNetwork network(folder_.path());

  const Said before = Ask({"--config", ShippedConfig("lab.xml")}, &network);
  EXPECT_EQ(before.program.exit_status, 1);
  EXPECT_THAT(before.ProblemOf("multicast_route"), HasSubstr("has no route"));
  EXPECT_EQ(before.Of("loop_back", "not checked").size(), 1U) << before.program.out;
  const std::vector<std::string> mend = before.MendOf("multicast_route");
  EXPECT_THAT(
      mend,
      ElementsAre(
          "ip link set lo up", "ip link set lo multicast on", "ip route add 224.0.0.0/4 dev lo"))
      << "root needs no sudo";
  for (const std::string& command : mend) {
    EXPECT_THAT(before.program.out, HasSubstr("mend: " + command + '\n'));
    Run(command, network);
  }

  const Said after = Ask({"--config", ShippedConfig("lab.xml")}, &network);
  EXPECT_EQ(after.program.exit_status, 0) << after.program.out;
  EXPECT_EQ(after.Of("loop_back", "ok").size(), 1U) << after.program.out;
}

TEST_F(DoctorTest, LoWithoutMulticastIsMendedByWhatItSays) {
  const BareNetwork network(folder_.path());
  Run("ip link set lo up && ip link set lo multicast off && ip route add 224.0.0.0/4 dev lo",
      network);

  const Said before = Ask({}, &network);
  EXPECT_THAT(before.ProblemOf("multicast_route"), HasSubstr("goes by lo, which has no multicast"));
  for (const std::string& command : before.MendOf("multicast_route")) Run(command, network);

  const Said after = Ask({}, &network);
  EXPECT_EQ(after.program.exit_status, 0) << after.program.out;
}

TEST_F(DoctorTest, ABusThatIsToLeaveTheHostMayNotGoByLo) {
  const Said said = Ask({"--lcm-url", url_ + "?ttl=1"});

  EXPECT_EQ(said.program.exit_status, 1);
  EXPECT_THAT(said.ProblemOf("multicast_route"), HasSubstr("it is to leave the host"));
}

TEST_F(DoctorTest, BuffersThatTheKernelDoesNotGrantAreFound) {
  std::int64_t limit = 0;
  if (!(std::ifstream("/proc/sys/net/core/rmem_max") >> limit) || limit >= 268'435'456) {
    GTEST_SKIP() << "net.core.rmem_max cannot be read in a network namespace, or is huge";
  }
  const auto config = folder_.Write("big.xml",
                                    "<clearway version=\"1\"><buses>"
                                    "<local receive_buffer_bytes=\"268435456\"/>"
                                    "</buses></clearway>");

  const Said said = Ask({"--config", config, "--lcm-url", url_});

  EXPECT_EQ(said.program.exit_status, 1);
  EXPECT_THAT(said.ProblemOf("receive_buffer"), HasSubstr("the buses ask for 268435456"));
  EXPECT_THAT(said.MendOf("receive_buffer"),
              ElementsAre("sysctl -w net.core.rmem_max=268435456",
                          "echo 'net.core.rmem_max = 268435456' | tee "
                          "/etc/sysctl.d/60-clearway.conf"));
}

TEST_F(DoctorTest, WhoHoldsThePortIsNamed) {
  const host::Descriptor fd(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(17999);
  ASSERT_EQ(bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);

  const Said said = Ask({"--lcm-url", TestUrl(17999)});

  EXPECT_EQ(said.program.exit_status, 1);
  EXPECT_THAT(said.ProblemOf("port"), HasSubstr("(process " + std::to_string(getpid()) + ")"));
  EXPECT_THAT(said.MendOf("port"), ElementsAre("kill " + std::to_string(getpid())));
}

TEST_F(DoctorTest, EveryProblemOfAConfigurationIsTold) {
  const auto config = folder_.Write("bad.xml",
                                    "<clearway version=\"1\">\n<vehicle stationry=\"true\"/>\n"
                                    "<clusterer backend=\"none\"/>\n</clearway>");

  const Said said = Ask({"--config", config, "--lcm-url", url_});

  EXPECT_EQ(said.program.exit_status, 1);
  EXPECT_EQ(said.Of("configuration", "problem").size(), 2U) << said.program.out;
}

TEST_F(DoctorTest, DeputiesWithAnotherConfigurationAreNamed) {
  const auto with_config = [](const std::string& name) {
    return std::vector<std::string>{"--set", "deputy.graph_config=" + ShippedConfig(name)};
  };
  StartDeputyAndAwait("alike", with_config("lab.xml"));
  const Said alike = Ask({"--config", ShippedConfig("lab.xml"), "--lcm-url", url_});
  EXPECT_EQ(alike.program.exit_status, 0) << alike.program.out;
  StartDeputyAndAwait("other", with_config("indoor_people.xml"));

  const Said said = Ask({"--config", ShippedConfig("lab.xml"), "--lcm-url", url_});

  EXPECT_EQ(said.program.exit_status, 1);
  EXPECT_THAT(
      said.ProblemOf("digests"),
      AllOf(StartsWith("deputy \"other\" on "), HasSubstr("another configuration: digest ")));
  ASSERT_EQ(said.Of("digests", "ok").size(), 1U) << said.program.out;
  EXPECT_THAT(said.Of("digests", "ok")[0]["text"].get<std::string>(),
              StartsWith("deputy \"alike\""));
  EXPECT_EQ(said.Of("versions", "ok").size(), 1U) << said.program.out;
}

TEST_F(DoctorTest, AGraphThatRunsAlreadyIsFoundUnlessItIsADeputys) {
  const std::vector<std::string> clusterer = {
      Program("clusterer"), "--config", ShippedConfig("lab.xml"), "--lcm-url", url_};
  StartDeputyAndAwait("d");
  peer_.Order("d",
              {Wanted("c", clusterer[0] + " --config " + clusterer[2] + " --lcm-url " + url_)});
  ASSERT_TRUE(peer_.AwaitRunning("d", "c", 1));
  const std::vector<std::string> arguments = {
      "--config", ShippedConfig("lab.xml"), "--lcm-url", url_, "--listen-ms", "4000"};
  const Said managed = Ask(arguments);
  EXPECT_EQ(managed.Of("traffic", "ok").size(), 1U) << managed.program.out;

  const host::ChildProcess second("clusterer", clusterer, folder_.path() / "clusterer.log");
  const Said said = Ask(arguments);

  EXPECT_EQ(said.program.exit_status, 0) << "warnings only: " << said.program.out;
  const auto warnings = said.Of("traffic", "warning");
  ASSERT_EQ(warnings.size(), 2U) << said.program.out;
  EXPECT_THAT(warnings[0]["text"].get<std::string>(), StartsWith("two graphs on one bus"));
  EXPECT_THAT(warnings[1]["text"].get<std::string>(), HasSubstr("no deputy started"));
  EXPECT_EQ(warnings[1]["mend"][0], "kill " + std::to_string(second.pid()));
}

TEST_F(DoctorTest, WhatTheHostsFileRefusesIsAllowedByTheLineItPrints) {
  const std::string head = "<clearway version=\"1\"><deputy id=\"robot\" graph_config=\"" +
                           ShippedConfig("lab.xml") + "\"><bus url=\"" + url_ + "\"/></deputy>";
  const std::filesystem::path host_file = folder_.Write("deputy.xml", head + "</clearway>");
  const std::filesystem::path deployment =
      folder_.Write("a.pmd",
                    "cmd \"c\" { exec = \"CLEARWAY_STATUS_CHANNEL=CLUSTERER_STATUS A='x y' "
                    "clearway-clusterer --config ${CLEARWAY_CONFIG}\"; deputy = \"robot\"; }\n"
                    "cmd \"d\" { exec = \"elsewhere\"; deputy = \"laptop\"; }\n");
  const std::vector<std::string> arguments = {
      "--deployment", deployment, "--host-file", host_file, "--lcm-url", url_, "--user", "root"};

  const Said before = Ask(arguments);
  EXPECT_EQ(before.program.exit_status, 1);
  const std::vector<std::string> mend = before.MendOf("deployment");
  ASSERT_EQ(mend.size(), 1U) << before.program.out;
  const std::size_t element = mend[0].find("<allow ");
  ASSERT_NE(element, std::string::npos) << mend[0];
  folder_.Write("deputy.xml", head + mend[0].substr(element) + "</clearway>");

  const Said after = Ask(arguments);
  EXPECT_EQ(after.program.exit_status, 0) << after.program.out;
  EXPECT_EQ(after.Of("deployment", "ok").size(), 1U) << after.program.out;
  EXPECT_EQ(after.Of("deputies", "warning").size(), 2U) << "robot and laptop: none is heard";
}

TEST_F(DoctorTest, TheSensorsSubnetIsLookedForWhenAskedFor) {
  const Said said = Ask({"--lcm-url", url_, "--sensor-subnet", "127.0.0.0/8"});
  EXPECT_EQ(said.Of("sensor_subnet", "ok").size(), 1U) << said.program.out;

  const Said missing = Ask({"--lcm-url", url_, "--sensor-subnet", "192.168.1.0/24"});
  EXPECT_EQ(missing.Of("sensor_subnet", "warning").size(), 1U) << missing.program.out;
  EXPECT_EQ(missing.program.exit_status, 0);
}

TEST_F(DoctorTest, AWrongCommandLineIsAUsageError) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"--lcm-url", "tcp://x"},
                                             {"--sensor-subnet", "192.168.1.0"},
                                             {"--listen-ms", "0"},
                                             {"--no-such-option"}}) {
    EXPECT_EQ(RunProgram(With({Program("doctor")}, arguments), folder_.path()).exit_status, 64)
        << arguments[0];
  }
}

}  // namespace
}  // namespace clearway::test
