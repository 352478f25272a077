// SPDX-License-Identifier: BSD-3-Clause
// Whatever users ask for and however much is lost: what they asked for comes true.
#include <algorithm>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/procman/sheriff_bed.hpp"

namespace clearway::core::procman {
namespace {

using test::Deployed;
using test::Deploying;
using test::SheriffBed;
using test::TheCommand;

enum class Wanted { kAnything, kUp, kDown };

class SheriffPropertiesTest : public testing::TestWithParam<unsigned> {};

// Half of all orders and of all reports are lost, commands crash, deputies restart, sheriffs are
// replaced, commands move: when it gets quiet, all is as it was asked for last.
TEST_P(SheriffPropertiesTest, ConvergesToWhatWasAskedFor) {
  std::mt19937 random(GetParam());
  const auto one_of = [&random](int n) {
    return std::uniform_int_distribution<int>(0, n - 1)(random);
  };
  SheriffBed bed({"dep0", "dep1"});
  bed.loses_orders = [&] { return one_of(2) == 0; };
  bed.loses_reports = [&] { return one_of(2) == 0; };
  std::vector<DeployedCommand> commands;
  for (int i = 0; i < 6; ++i) {
    commands.push_back(Deployed("c" + std::to_string(i),
                                "dep" + std::to_string(i % 2),
                                i % 3 == 2 ? "stubborn" : "run",
                                i < 3 ? "low" : "high",
                                i % 2 == 0));
  }
  Sheriff* sheriff = &bed.AddSheriff("s0");
  sheriff->Load(Deploying(commands), bed.now_us());
  std::map<std::string, Wanted> wanted;
  int sheriffs = 1;

  for (int action = 0; action < 60; ++action) {
    const std::string id = "c" + std::to_string(one_of(6));
    switch (one_of(9)) {
      case 0:
      case 1:
      case 2:
        sheriff->Start(TheCommand(id), bed.now_us());
        wanted[id] = Wanted::kUp;
        break;
      case 3:
        sheriff->Restart(TheCommand(id), bed.now_us());
        wanted[id] = Wanted::kUp;
        break;
      case 4:
      case 5:
        sheriff->Stop(TheCommand(id), bed.now_us());
        wanted[id] = Wanted::kDown;
        break;
      case 6: {
        test::ReferenceDeputy& deputy = bed.deputy("dep" + std::to_string(one_of(2)));
        if (!deputy.IsUp(id)) break;
        deputy.Crash(id, bed.now_us());
        const auto& spec = commands[static_cast<std::size_t>(id[1] - '0')].spec;
        if (!spec.auto_respawn && wanted[id] == Wanted::kUp) wanted[id] = Wanted::kAnything;
        break;
      }
      case 7: {
        // Another sheriff with the same file; or with one in which a command has moved.
        bed.RemoveSheriff(*sheriff);
        if (one_of(2) == 0) {
          auto& moved = commands[static_cast<std::size_t>(one_of(6))];
          moved.deputy = moved.deputy == "dep0" ? "dep1" : "dep0";
        }
        sheriff = &bed.AddSheriff("s" + std::to_string(sheriffs++));
        sheriff->Load(Deploying(commands), bed.now_us());
        // What it was not told yet it takes from what is there.
        for (auto& [each, what] : wanted) what = Wanted::kAnything;
        break;
      }
      default:
        break;
    }
    bed.Run(10'000LL * one_of(120));
  }

  const auto is_as_wanted = [&] {
    return std::all_of(wanted.begin(), wanted.end(), [&](const auto& entry) {
      const auto& [id, what] = entry;
      if (what == Wanted::kAnything) return true;
      const auto& home = commands[static_cast<std::size_t>(id[1] - '0')].deputy;
      return what == Wanted::kUp ? bed.deputy(home).IsUp(id) && bed.Copies(id) == 1
                                 : bed.Copies(id) == 0;
    });
  };
  // What the sheriff says is what is. (A restart of a respawned command may take the reference's
  // deputy some rounds: it starts the old run again when the second order is lost.)
  const auto is_said_so = [&] {
    return std::all_of(wanted.begin(), wanted.end(), [&](const auto& entry) {
      const Status status = bed.StatusOf(*sheriff, entry.first);
      const bool is_down = status == Status::kStopped || status == Status::kFailed;
      return (entry.second != Wanted::kDown && status == Status::kRunning) ||
             (entry.second != Wanted::kUp && is_down);
    });
  };
  EXPECT_TRUE(bed.RunUntil([&] { return is_as_wanted() && is_said_so(); }, 120'000'000));
  // And it stays so: nothing is started any more.
  bed.Run(5'000'000);
  const auto starts = [&] {
    return bed.deputy("dep0").runs().size() + bed.deputy("dep1").runs().size();
  };
  const auto before = starts();
  bed.Run(20'000'000);
  EXPECT_EQ(starts(), before);
  EXPECT_TRUE(is_as_wanted());
}

// Only the network is bad, and each sheriff hears both deputies before it is asked for anything.
TEST_P(SheriffPropertiesTest, NeverRunsTwoCopiesWhileCommandsMove) {
  std::mt19937 random(GetParam());
  const auto one_of = [&random](int n) {
    return std::uniform_int_distribution<int>(0, n - 1)(random);
  };
  SheriffBed bed({"dep0", "dep1"});
  bed.loses_orders = [&] { return one_of(2) == 0; };
  bed.loses_reports = [&] { return one_of(3) == 0; };
  int most_copies = 0;
  bed.check = [&] {
    for (const char* id : {"c0", "c1", "c2"}) most_copies = std::max(most_copies, bed.Copies(id));
  };
  std::vector<DeployedCommand> commands = {Deployed("c0", "dep0", "run", "", true),
                                           Deployed("c1", "dep1", "stubborn"),
                                           Deployed("c2", "dep0", "end 1 700", "", true)};
  Sheriff* sheriff = &bed.AddSheriff("s");
  sheriff->Load(Deploying(commands), bed.now_us());

  for (int action = 0; action < 60; ++action) {
    const auto index = static_cast<std::size_t>(one_of(3));
    const std::string id = commands[index].spec.id;
    const bool knows_both =
        sheriff->IsHeard("dep0", bed.now_us()) && sheriff->IsHeard("dep1", bed.now_us());
    switch (one_of(5)) {
      case 0:
        commands[index].deputy = commands[index].deputy == "dep0" ? "dep1" : "dep0";
        if (one_of(2) == 0) {
          bed.RemoveSheriff(*sheriff);
          sheriff = &bed.AddSheriff("s" + std::to_string(action));
        }
        sheriff->Load(Deploying(commands), bed.now_us());
        break;
      case 1:
      case 2:
        if (knows_both) sheriff->Start(TheCommand(id), bed.now_us());
        break;
      case 3:
        if (knows_both) sheriff->Restart(TheCommand(id), bed.now_us());
        break;
      default:
        if (knows_both) sheriff->Stop(TheCommand(id), bed.now_us());
        break;
    }
    bed.Run(10'000LL * one_of(150));
  }

  EXPECT_EQ(most_copies, 1);
}

INSTANTIATE_TEST_SUITE_P(Seeds, SheriffPropertiesTest, testing::Range(1U, 41U));

}  // namespace
}  // namespace clearway::core::procman
