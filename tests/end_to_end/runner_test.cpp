// SPDX-License-Identifier: BSD-3-Clause
// clearway-run when it is interrupted, when one of its processes dies, and when it dies itself.
#include <csignal>
#include <fstream>
#include <map>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command_line.hpp"
#include "tests/support/graph_listener.hpp"
#include "tests/support/live_buses.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::test {
namespace {

class RunnerTest : public testing::Test {
 protected:
  void StartAndAwaitDetections() {
    run_.emplace("run",
                 std::vector<std::string>{Program("run"),
                                          "--headless",
                                          "--config",
                                          ShippedConfig("lab.xml"),
                                          "--lcm-url",
                                          TestUrl(kPort),
                                          "--output",
                                          folder_.path() / "output",
                                          "--json",
                                          folder_.path() / "run.json"},
                 folder_.path() / "run.log");
    ASSERT_TRUE(listener_.Await([&] { return listener_.detections.size() >= 5; }))
        << run_->LastWords();
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

}  // namespace
}  // namespace clearway::test
