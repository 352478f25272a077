// SPDX-License-Identifier: BSD-3-Clause
// clearway-run when it is interrupted, when one of its processes, its deputy or it itself dies, and
// beside others on one bus.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/host/process_table.hpp"
#include "common/io/lcm_log.hpp"
#include "tests/support/command_line.hpp"
#include "tests/support/graph_listener.hpp"
#include "tests/support/live_buses.hpp"
#include "tests/support/procman_peer.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::test {
namespace {

class RunnerTest : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> RunCommand(const std::string& output) const {
    return {Program("run"),
            "--headless",
            "--config",
            ShippedConfig("lab_standing.xml"),
            "--lcm-url",
            TestUrl(kPort),
            "--output",
            folder_.path() / output,
            "--json",
            folder_.path() / "run.json"};
  }

  void StartAndAwaitDetections() {
    run_.emplace("run", RunCommand("output"), folder_.path() / "run.log");
    ASSERT_TRUE(listener_.Await([&] { return listener_.detections.size() >= 5; }))
        << run_->LastWords();
  }

  // The process that had the clusterer started.
  [[nodiscard]] std::int32_t DeputyPid() const {
    const auto clusterer = host::ReadProcess(listener_.statuses.at("clusterer").message.pid);
    return clusterer ? clusterer->ppid : 0;
  }

  // Nothing of the graph is left when nothing is said any more.
  bool AwaitSilence() {
    constexpr std::int64_t kQuiet_us = 1'500'000;
    std::int64_t messages = -1;
    std::int64_t since_us = 0;
    return listener_.Await([&] {
      const std::int64_t now_us = GraphListener::NowUs();
      if (listener_.num_messages != messages) since_us = now_us;
      messages = listener_.num_messages;
      return now_us - since_us > kQuiet_us;
    });
  }

  static constexpr int kPort = 17600;
  TestFolder folder_;
  GraphListener listener_{TestUrl(kPort)};
  std::optional<host::ChildProcess> run_;
};

TEST_F(RunnerTest, InterruptedItEndsTheGraphAndStillSumsUp) {
  StartAndAwaitDetections();

  run_->Signal(SIGINT);

  EXPECT_EQ(run_->WaitOrKill(30'000), 0) << run_->LastWords();
  std::ifstream stream(folder_.path() / "run.json");
  const auto figures = nlohmann::json::parse(stream);
  EXPECT_GE(figures.at("scans_detected"), 4);
  EXPECT_EQ(figures.at("messages_lost"), 0);
  EXPECT_TRUE(AwaitSilence());
}

TEST_F(RunnerTest, WhenAProcessDiesItSaysWhichOneAndEndsTheOthers) {
  StartAndAwaitDetections();
  ASSERT_TRUE(listener_.Await([&] { return listener_.statuses.contains("clusterer"); }));

  kill(listener_.statuses["clusterer"].message.pid, SIGKILL);

  EXPECT_EQ(run_->WaitOrKill(30'000), 70);
  EXPECT_THAT(run_->LastWords(), testing::HasSubstr("clusterer ended with status 137"));
  EXPECT_TRUE(AwaitSilence());
}

TEST_F(RunnerTest, WhenItIsKilledItsProcessesEndWithIt) {
  StartAndAwaitDetections();

  run_->Signal(SIGKILL);

  EXPECT_EQ(run_->WaitOrKill(30'000), 128 + SIGKILL);
  EXPECT_TRUE(AwaitSilence());
}

TEST_F(RunnerTest, WhenItsDeputyIsKilledItSaysSoAndNothingIsLeft) {
  StartAndAwaitDetections();
  ASSERT_TRUE(listener_.Await([&] { return listener_.statuses.contains("clusterer"); }));

  kill(DeputyPid(), SIGKILL);

  EXPECT_EQ(run_->WaitOrKill(30'000), 70);
  EXPECT_THAT(run_->LastWords(), testing::HasSubstr("the deputy ended with status 137"));
  EXPECT_TRUE(AwaitSilence());
}

TEST_F(RunnerTest, AnotherGraphOnTheBusIsNotDisturbedButRefused) {
  StartAndAwaitDetections();
  const std::size_t detections = listener_.detections.size();

  const ProgramResult second = RunProgram(RunCommand("second"), folder_.path(), 60);

  EXPECT_EQ(second.exit_status, 70);
  EXPECT_THAT(second.err, testing::HasSubstr("runs on this bus: stop it, or use --channel-prefix"));
  EXPECT_FALSE(run_->ExitStatus().has_value()) << run_->LastWords();
  EXPECT_TRUE(listener_.Await([&] { return listener_.detections.size() > detections + 5; }));
  run_->Signal(SIGINT);
  EXPECT_EQ(run_->WaitOrKill(30'000), 0) << run_->LastWords();
}

TEST_F(RunnerTest, OtherDeputiesOnTheBusGetNoOrdersAlsoWithCommandsOfTheSameNames) {
  ProcmanPeer peer(TestUrl(kPort) + "?ttl=0");
  const host::ChildProcess robot("robot",
                                 {Program("deputy"),
                                  "--id",
                                  "robot",
                                  "--lcm-url",
                                  TestUrl(kPort) + "?ttl=0",
                                  "--allow-root",
                                  "--allow-any",
                                  "--set",
                                  "deputy.logs.folder=" + (folder_.path() / "robot").string()},
                                 folder_.path() / "robot.log");
  ASSERT_TRUE(peer.AwaitDeputy("robot")) << robot.LastWords();
  peer.Order("robot", {Wanted("clusterer", "sleep 100", 7), Wanted("play", "sleep 100", 3)});
  ASSERT_TRUE(peer.AwaitRunning("robot", "clusterer", 7));
  ASSERT_TRUE(peer.AwaitRunning("robot", "play", 3));
  const std::int32_t pid = peer.Command("robot", "clusterer").pid;

  const ProgramResult run = RunProgram(With(RunCommand("output"), {"--for", "1"}), folder_.path());

  EXPECT_EQ(run.exit_status, 0) << run.err;
  peer.Await([] { return false; }, 2'000'000);  // All that was sent meanwhile, and a new report.
  EXPECT_EQ(peer.Command("robot", "clusterer").pid, pid);
  EXPECT_NE(peer.Command("robot", "play").pid, 0);
  EXPECT_TRUE(peer.health["robot"].text.empty()) << peer.health["robot"].text;
  EXPECT_GT(peer.orders.size(), 1U);
  for (const auto& orders : peer.orders) {
    EXPECT_EQ(orders.deputy_id == "robot", orders.sheriff_id == "test:1:1") << orders.sheriff_id;
  }
}

TEST_F(RunnerTest, ItsLogHoldsWhatItsDeputySaidAndWasTold) {
  const auto log = folder_.path() / "run.lcmlog";

  const ProgramResult run =
      RunProgram(With(RunCommand("output"), {"--for", "1", "--log", log}), folder_.path());

  ASSERT_EQ(run.exit_status, 0) << run.err;
  std::map<std::string, int> events;
  io::LcmLogReader reader(log);
  while (const auto event = reader.Next()) ++events[event->channel];
  for (const char* channel : {"PM_INFO", "PM_HEALTH", "PM_ORDERS", "PM_OUTPUT"}) {
    EXPECT_GT(events[channel], 0) << channel;
  }
}

TEST_F(RunnerTest, AnyPathMayHaveBlanksQuotesDollarsAndBackslashes) {
  const auto folder = folder_.path() / "it's a $HOME \\ \"folder\"";
  std::filesystem::create_directories(folder);
  std::filesystem::copy(ShippedConfig("lab_standing.xml"), folder / "the lab.xml");
  std::filesystem::copy(ShippedConfig("lab_scene.xml"), folder / "$PWD scene.xml");
  const std::vector<std::string> command = {Program("run"),
                                            "--headless",
                                            "--config",
                                            folder / "the lab.xml",
                                            "--input",
                                            folder / "$PWD scene.xml",
                                            "--lcm-url",
                                            TestUrl(kPort),
                                            "--output",
                                            folder / "out put",
                                            "--for",
                                            "1"};

  const ProgramResult run = RunProgram(command, folder_.path());

  EXPECT_EQ(run.exit_status, 0) << run.err;
  for (const char* file : {"preprocessor.log", "play.log", "deputy.log", "last_scan.png"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / "out put" / file)) << file;
  }
}

TEST_F(RunnerTest, LogsOfAnEarlierRunAreGoneAlsoThoseThatWereFull) {
  const auto output = folder_.path() / "output";
  std::filesystem::create_directories(output);
  for (const char* file : {"map_server.log", "play.log.2", "play.log.keep", "notes.txt"}) {
    std::ofstream(output / file) << "old";
  }

  const ProgramResult run =
      RunProgram(With(RunCommand("output"), {"--for", "0.5"}), folder_.path());

  EXPECT_EQ(run.exit_status, 0) << run.err;
  EXPECT_FALSE(std::filesystem::exists(output / "map_server.log"));
  EXPECT_FALSE(std::filesystem::exists(output / "play.log.2"));
  EXPECT_TRUE(std::filesystem::exists(output / "play.log.keep"));
  EXPECT_TRUE(std::filesystem::exists(output / "notes.txt"));
}

}  // namespace
}  // namespace clearway::test
