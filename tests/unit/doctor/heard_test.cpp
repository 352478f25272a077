// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/heard.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"

namespace clearway::doctor {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::byte> StatusOf(std::int64_t session, std::int32_t pid) {
  status_t status{};
  status.session = session;
  status.host = "robot";
  status.pid = pid;
  status.version = "1.0";
  status.config_digest = "aa";
  return messages::Encode(status);
}

std::vector<std::byte> InfoOf(const std::string& deputy, std::int32_t pid) {
  core::procman::DeputyReport report;
  report.deputy_id = deputy;
  report.commands.resize(1);
  report.commands[0].pid = pid;
  return messages::Encode(messages::ToLcm(report));
}

std::vector<std::byte> HealthOf(const std::string& deputy) {
  core::procman::DeputyHealth health;
  health.deputy_id = deputy;
  health.host = "h";
  health.version = "1.0";
  health.config_digest = "aa";
  return messages::Encode(messages::ToLcm(health, 5, 58000).front());
}

TEST(Listener, TellsLivesOfAProcessApart) {
  Listener listener;

  listener.OnMessage("CLUSTERER_STATUS", StatusOf(1, 10));
  listener.OnMessage("CLUSTERER_STATUS", StatusOf(1, 10));
  listener.OnMessage("CLUSTERER_STATUS", StatusOf(2, 9));
  listener.OnMessage("BENCH_CLUSTERER_STATUS", StatusOf(1, 11));

  const Heard heard = listener.Result();
  ASSERT_EQ(heard.processes.size(), 3U);
  EXPECT_EQ(heard.processes[0].channel, "BENCH_CLUSTERER_STATUS");
  EXPECT_EQ(heard.processes[1].pid, 9);
  EXPECT_EQ(heard.processes[2].pid, 10);
  EXPECT_EQ(heard.processes[2].config_digest, "aa");
  EXPECT_THAT(heard.channels, ElementsAre("BENCH_CLUSTERER_STATUS", "CLUSTERER_STATUS"));
}

TEST(Listener, JoinsWhatADeputySaysOnBothChannels) {
  Listener listener;

  listener.OnMessage("PM_HEALTH", HealthOf("b"));
  listener.OnMessage("PM_INFO", InfoOf("b", 7));
  listener.OnMessage("PM_INFO", InfoOf("b", 8));
  listener.OnMessage("PM_INFO", InfoOf("a", 0));

  const Heard heard = listener.Result();
  ASSERT_EQ(heard.deputies.size(), 2U);
  EXPECT_FALSE(heard.deputies[0].is_ours) << "a has said nothing on PM_HEALTH";
  EXPECT_THAT(heard.deputies[0].pids, IsEmpty());
  EXPECT_TRUE(heard.deputies[1].is_ours);
  EXPECT_EQ(heard.deputies[1].host, "h");
  EXPECT_EQ(heard.deputies[1].version, "1.0");
  EXPECT_THAT(heard.deputies[1].pids, ElementsAre(7, 8));
}

TEST(Listener, TakesNothingFromOtherBytes) {
  Listener listener;
  const std::vector<std::byte> noise(100, std::byte{0x5a});

  for (const char* channel : {"PM_HEALTH", "PM_INFO", "CLUSTERER_STATUS", "POSE_STATUS", "X"}) {
    listener.OnMessage(channel, noise);
    listener.OnMessage(channel, {});
  }

  EXPECT_THAT(listener.Result().processes, IsEmpty());
  EXPECT_THAT(listener.Result().deputies, IsEmpty());
  EXPECT_EQ(listener.Result().channels.size(), 5U);
}

TEST(Listener, KeepsABoundedAmount) {
  Listener listener;

  for (int i = 0; i < 5000; ++i) {
    listener.OnMessage("C" + std::to_string(i), {});
    listener.OnMessage("A_STATUS", StatusOf(i, i));
    listener.OnMessage("PM_INFO", InfoOf(std::to_string(i), i));
  }

  EXPECT_LE(listener.Result().channels.size(), 1000U);
  EXPECT_LE(listener.Result().processes.size(), 1000U);
  EXPECT_LE(listener.Result().deputies.size(), 1000U);
}

}  // namespace
}  // namespace clearway::doctor
