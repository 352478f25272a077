// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/procman.hpp"

#include <algorithm>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "common/messages/encoding.hpp"

namespace clearway::messages {
namespace {

using core::procman::CommandHealth;
using core::procman::CommandHealthReport;
using core::procman::CommandState;
using core::procman::DeputyHealth;

DeputyHealth HealthOf(int commands) {
  DeputyHealth health{.deputy_id = "d",
                      .host = "h",
                      .version = "1",
                      .config_digest = "0123",
                      .sheriff_id = "s",
                      .orders_age_us = 5,
                      .text = "t",
                      .commands = {}};
  for (int i = 0; i < commands; ++i) {
    health.commands.push_back({.id = "command " + std::to_string(i),
                               .state = CommandState::kRunning,
                               .health = CommandHealth::kReady,
                               .text = std::string(static_cast<std::size_t>(i), 'x'),
                               .starts = i,
                               .quick_deaths = 2,
                               .running_us = 7,
                               .dropped_output_bytes = 9});
  }
  return health;
}

std::vector<std::string> IdsOf(const DeputyHealth& health) {
  std::vector<std::string> ids;
  for (const CommandHealthReport& command : health.commands) ids.push_back(command.id);
  return ids;
}

TEST(ProcmanMessagesTest, OrdersComeBack) {
  core::procman::Orders orders{.utime = 5, .deputy_id = "d", .sheriff_id = "s", .commands = {}};
  orders.commands.push_back({.spec = {.id = "a",
                                      .exec = "x y",
                                      .group = "g/h",
                                      .auto_respawn = true,
                                      .stop_signal = 15,
                                      .stop_time_allowed_s = 2.5F},
                             .run_id = 3,
                             .force_quit = true});

  const core::procman::Orders again = FromLcm(ToLcm(orders));

  EXPECT_EQ(again.utime, 5);
  EXPECT_EQ(again.deputy_id, "d");
  EXPECT_EQ(again.sheriff_id, "s");
  EXPECT_EQ(again.commands, orders.commands);
}

TEST(ProcmanMessagesTest, HealthComesBackWholeInSlicesOfAnySizeInAnyOrder) {
  for (const std::size_t most : {200U, 600U, 1400U, 58'000U}) {
    for (const int commands : {0, 1, 3, 50}) {
      const DeputyHealth health = HealthOf(commands);

      std::vector<deputy_health_t> slices = ToLcm(health, 77, most);
      std::mt19937 random(5);
      std::shuffle(slices.begin(), slices.end(), random);

      HealthAssembler assembler;
      for (std::size_t i = 0; i < slices.size(); ++i) {
        if (slices[i].n > 1) {
          EXPECT_LE(Encode(slices[i]).size(), most);
        }
        const auto whole = assembler.Add(slices[i]);
        ASSERT_EQ(whole.has_value(), i + 1 == slices.size());
        if (!whole) continue;
        EXPECT_EQ(IdsOf(*whole), IdsOf(health));
        EXPECT_EQ(whole->sheriff_id, "s");
        EXPECT_EQ(whole->orders_age_us, 5);
      }
    }
  }
}

TEST(ProcmanMessagesTest, ALostSliceCostsThatReportOnly) {
  HealthAssembler assembler;
  std::vector<deputy_health_t> first = ToLcm(HealthOf(20), 1, 600);
  std::vector<deputy_health_t> second = ToLcm(HealthOf(20), 2, 600);
  ASSERT_GT(first.size(), 2U);

  for (std::size_t i = 1; i < first.size(); ++i) EXPECT_FALSE(assembler.Add(first[i]));
  std::optional<DeputyHealth> whole;
  for (const deputy_health_t& slice : second) whole = assembler.Add(slice);

  ASSERT_TRUE(whole.has_value());
  EXPECT_EQ(whole->commands.size(), 20U);
}

TEST(ProcmanMessagesTest, BrokenSlicesAreIgnored) {
  HealthAssembler assembler;
  deputy_health_t slice = ToLcm(HealthOf(1), 1, 600).front();

  for (const auto& [index, count] : std::vector<std::pair<int, int>>{
           {-1, 1}, {1, 1}, {0, 0}, {0, -5}, {0, 2'000'000'000}, {5, 3}}) {
    slice.slice_index = index;
    slice.slice_count = count;
    EXPECT_FALSE(assembler.Add(slice).has_value());
  }
}

TEST(ProcmanMessagesTest, StatesThatAreNotKnownClaimNothing) {
  deputy_health_t slice = ToLcm(HealthOf(1), 1, 600).front();
  slice.commands[0].state = 99;

  const auto whole = HealthAssembler().Add(slice);

  ASSERT_TRUE(whole.has_value());
  EXPECT_FALSE(core::procman::IsReady(whole->commands[0]));
}

}  // namespace
}  // namespace clearway::messages
