// SPDX-License-Identifier: BSD-3-Clause
// The real deputy when deputies, sheriffs, the network or clocks fail, and what a host's own file
// keeps from running.
#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "tests/support/deputy_fixture.hpp"

namespace clearway::test {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kSecond = 1'000'000;

class DeputyFaultsTest : public DeputyProgramTest {
 protected:
  std::vector<std::string> WithState() const {
    return {"--set", "deputy.state_folder=" + (folder_.path() / "state").string()};
  }
  std::string WriteHostFile(const std::string& rules) const {
    const std::filesystem::path path = folder_.path() / "deputy.xml";
    std::ofstream(path) << "<clearway version=\"1\">" << rules << "</clearway>\n";
    return path.string();
  }
};

TEST_F(DeputyFaultsTest, KilledItTakesItsChildrenAlongAndItsNextLifeCarriesOn) {
  StartDeputyAndAwait("d", WithState());
  peer_.Order("d",
              {Wanted("runs", "sh -c 'setsid sleep 7201 & sleep 7202'", 4),
               Wanted("ended", "echo once", 2)});
  ASSERT_TRUE(peer_.AwaitRunning("d", "runs", 4));
  ASSERT_TRUE(peer_.AwaitState("d", "ended", State::kEnded));
  ASSERT_TRUE(AwaitOutput("ended", "exited with 0"));
  ASSERT_TRUE(peer_.Await([] { return PidWith("sleep 7201") != 0; }));
  const std::int32_t old_pid = peer_.Command("d", "runs").pid;

  deputies_.back()->Signal(SIGKILL);
  deputies_.back()->WaitOrKill(10'000);
  EXPECT_TRUE(peer_.Await([&] { return !IsAlive(old_pid); })) << "no sheriff, no orphan";
  peer_.reports.clear();
  peer_.health.clear();
  peer_.output.clear();
  StartDeputyAndAwait("d", WithState());

  ASSERT_TRUE(peer_.AwaitRunning("d", "runs", 4)) << "without any orders";
  EXPECT_NE(peer_.Command("d", "runs").pid, old_pid);
  EXPECT_EQ(peer_.Command("d", "ended").pid, 0);
  EXPECT_EQ(OutputOf("ended"), "") << "what had ended does not run again";
  ASSERT_TRUE(peer_.Await([] { return PidWith("sleep 7201") != 0; }));
  peer_.Order("d", {Unwanted(Wanted("runs", "sleep 50", 4))});
  ASSERT_TRUE(peer_.AwaitStopped("d", "runs"));
  EXPECT_EQ(PidWith("sleep 7201"), 0) << "nor is anything left of the first life";
}

TEST_F(DeputyFaultsTest, StoppedAndStartedItCarriesOnAsBefore) {
  host::ChildProcess& deputy = StartDeputy("d", WithState());
  ASSERT_TRUE(peer_.AwaitDeputy("d"));
  peer_.Order("d", {Wanted("runs", "sleep 50", 4), Unwanted(Wanted("stopped", "sleep 50", 3))});
  ASSERT_TRUE(peer_.AwaitRunning("d", "runs", 4));

  deputy.Signal(SIGTERM);
  EXPECT_EQ(deputy.WaitOrKill(10'000), 0);
  peer_.reports.clear();
  StartDeputyAndAwait("d", WithState());

  EXPECT_TRUE(peer_.AwaitRunning("d", "runs", 4));
  EXPECT_EQ(peer_.Command("d", "stopped").pid, 0);
  EXPECT_EQ(peer_.Command("d", "stopped").run_id, 3);
}

TEST_F(DeputyFaultsTest, KeptOrdersThatCannotBeReadArePutAsideAndTold) {
  std::filesystem::create_directories(folder_.path() / "state");
  std::ofstream(folder_.path() / "state" / "orders") << "no orders";

  StartDeputyAndAwait("d", WithState());

  EXPECT_TRUE(peer_.Await([&] { return !peer_.health["d"].text.empty(); }));
  EXPECT_THAT(peer_.health["d"].text, HasSubstr("not orders; put aside"));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "state" / "orders.unreadable"));
}

TEST_F(DeputyFaultsTest, ASecondDeputyOnOneStateFolderIsRefused) {
  StartDeputyAndAwait("d", WithState());

  host::ChildProcess& second = StartDeputy("other", WithState());

  EXPECT_EQ(second.WaitOrKill(10'000), 70);
  EXPECT_THAT(second.LastWords(), HasSubstr("another deputy uses this folder"));
}

TEST_F(DeputyFaultsTest, WhenTheSheriffIsGoneEverythingRunsOnAndTheNextOneChangesNothing) {
  StartDeputyAndAwait("d");
  core::procman::DesiredCommand command = Wanted("a", "sleep 50", 3);
  peer_.Order("d", {command});
  ASSERT_TRUE(peer_.AwaitRunning("d", "a", 3));
  const std::int32_t pid = peer_.Command("d", "a").pid;
  const std::size_t seen = peer_.report_times_us["d"].size();
  ASSERT_TRUE(peer_.Await([&] { return peer_.report_times_us["d"].size() >= seen + 4; }));

  ProcmanPeer next(url_, "next:2:2");
  next.Order("d", {command});

  ASSERT_TRUE(peer_.Await([&] { return peer_.health["d"].sheriff_id == "next:2:2"; }));
  EXPECT_EQ(peer_.Command("d", "a").pid, pid);
  EXPECT_TRUE(IsAlive(pid));
}

TEST_F(DeputyFaultsTest, ADeputyWithATakenIdEndsAtOnceAndTheFirstOneLives) {
  StartDeputyAndAwait("d");
  peer_.Order("d", {Wanted("a", "sleep 50")});
  ASSERT_TRUE(peer_.AwaitRunning("d", "a", 1));
  const std::int32_t pid = peer_.Command("d", "a").pid;

  host::ChildProcess& second = StartDeputy("d");

  EXPECT_EQ(second.WaitOrKill(10'000), 2);
  EXPECT_THAT(second.LastWords(), HasSubstr("another deputy runs with the id \"d\""));
  EXPECT_FALSE(deputies_.front()->ExitStatus().has_value());
  EXPECT_TRUE(IsAlive(pid));
}

TEST_F(DeputyFaultsTest, OfTwoDeputiesWithOneIdThatStartTogetherOneLives) {
  host::ChildProcess& one = StartDeputy("d");
  host::ChildProcess& two = StartDeputy("d");

  ASSERT_TRUE(peer_.AwaitDeputy("d"));
  ASSERT_TRUE(peer_.Await([&] { return one.ExitStatus() || two.ExitStatus(); }));

  EXPECT_NE(one.ExitStatus().has_value(), two.ExitStatus().has_value());
  EXPECT_EQ(one.ExitStatus().value_or(two.ExitStatus().value_or(0)), 1);
}

TEST_F(DeputyFaultsTest, TwoSheriffsAreReportedAndTheLastOneIsObeyed) {
  StartDeputyAndAwait("d");
  ProcmanPeer rival(url_, "rival:2:2");

  peer_.Order("d", {Wanted("a", "sleep 50")});
  ASSERT_TRUE(peer_.AwaitRunning("d", "a", 1));
  rival.Order("d", {Unwanted(Wanted("a", "sleep 50"))});

  ASSERT_TRUE(peer_.AwaitStopped("d", "a"));
  peer_.Order("d", {Unwanted(Wanted("a", "sleep 50"))});
  rival.Order("d", {Unwanted(Wanted("a", "sleep 50"))});
  EXPECT_TRUE(peer_.Await([&] {
    return peer_.health["d"].text == "two sheriffs command this deputy: rival:2:2 and test:1:1";
  })) << peer_.health["d"].text;
}

TEST_F(DeputyFaultsTest, OldOrdersOfASheriffAreDroppedAndSaid) {
  StartDeputyAndAwait("d");
  peer_.Order("d", {Wanted("a", "sleep 50")});
  ASSERT_TRUE(peer_.Await([&] { return !peer_.orders.empty(); }));
  procman_lcm::orders_t old = peer_.orders.front();
  ASSERT_TRUE(peer_.AwaitRunning("d", "a", 1));

  old.utime -= 1;
  old.ncmds = 0;
  old.cmds.clear();
  peer_.Send("PM_ORDERS", messages::Encode(old));

  EXPECT_TRUE(AwaitOutput("", "stale orders of test:1:1 ignored"));
  EXPECT_NE(peer_.Command("d", "a").pid, 0);
}

TEST_F(DeputyFaultsTest, ASheriffWhoseClockIsAnHourOffIsObeyed) {
  StartDeputyAndAwait("d");
  std::int32_t run_id = 0;

  for (const std::int64_t off_us : {-3600 * kSecond, 3600 * kSecond}) {
    ProcmanPeer sheriff(url_, "off:" + std::to_string(off_us));
    sheriff.clock_off_us = off_us;
    sheriff.Order("d", {Wanted("a", "sleep 50", ++run_id)});

    EXPECT_TRUE(peer_.AwaitRunning("d", "a", run_id)) << off_us;
  }
}

TEST_F(DeputyFaultsTest, BytesThatAreNoMessagesChangeNothing) {
  StartDeputyAndAwait("d");
  peer_.Order("d", {Wanted("a", "sleep 50")});
  ASSERT_TRUE(peer_.AwaitRunning("d", "a", 1));
  const std::vector<std::byte> good = messages::Encode(peer_.orders.back());

  for (const char* channel : {"PM_ORDERS", "PM_INFO", "PM_DISCOVER"}) {
    for (std::size_t size = 0; size < good.size(); ++size) {
      peer_.Send(channel, {good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)});
      std::vector<std::byte> flipped = good;
      flipped[size] ^= std::byte{0xFF};
      if (size >= 8) continue;  // A flipped fingerprint only: other flips may be other orders.
      peer_.Send(channel, flipped);
    }
  }
  const std::size_t seen = peer_.report_times_us["d"].size();

  EXPECT_TRUE(peer_.Await([&] { return peer_.report_times_us["d"].size() > seen + 1; }));
  EXPECT_NE(peer_.Command("d", "a").pid, 0);
  EXPECT_FALSE(deputies_.back()->ExitStatus().has_value());
}

TEST_F(DeputyFaultsTest, OnlyWhatTheHostsFileAllowsRunsAndTheRestIsRefusedWithAReason) {
  const std::string file = WriteHostFile(
      "<allow program=\"sleep\" arguments=\"7?\"/>"
      "<allow program=\"env\" environment=\"CW_*=*\"/>");
  StartDeputyAndAwait("d", {"--config", file});

  peer_.Order("d",
              {Wanted("good", "sleep 70"),
               Wanted("argument", "sleep 50"),
               Wanted("more", "sleep 70 1"),
               Wanted("program", "rm -rf /nowhere"),
               Wanted("variable", "LD_PRELOAD=x env"),
               Wanted("shell", "sh -c 'sleep 70'")});

  ASSERT_TRUE(peer_.AwaitRunning("d", "good", 1));
  for (const char* id : {"argument", "more", "program", "variable", "shell"}) {
    EXPECT_TRUE(peer_.AwaitState("d", id, State::kRefused)) << id;
    EXPECT_EQ(peer_.Command("d", id).exit_code, 126 << 8);
    EXPECT_TRUE(AwaitOutput(id, "see <allow>")) << id;
  }
  EXPECT_THAT(peer_.HealthOf("d", "program").text, HasSubstr("\"rm\""));
  EXPECT_THAT(peer_.HealthOf("d", "variable").text, HasSubstr("LD_PRELOAD"));
}

TEST_F(DeputyFaultsTest, WithoutAFileAndWithoutAllowAnyNothingRuns) {
  host::ChildProcess& deputy = StartDeputy("d", {"--config", WriteHostFile("")});
  ASSERT_TRUE(peer_.AwaitDeputy("d")) << deputy.LastWords();

  peer_.Order("d", {Wanted("a", "true")});

  EXPECT_TRUE(peer_.AwaitState("d", "a", State::kRefused));
  EXPECT_THAT(deputy.LastWords(), HasSubstr("nothing may run here"));
}

TEST_F(DeputyFaultsTest, AsRootItDoesNotStartUnlessTold) {
  if (geteuid() != 0) GTEST_SKIP() << "not root";
  host::ChildProcess deputy("root",
                            {Program("deputy"), "--id", "d", "--lcm-url", url_, "--allow-any"},
                            folder_.path() / "root.log");

  EXPECT_EQ(deputy.WaitOrKill(10'000), 77);
  EXPECT_THAT(deputy.LastWords(), HasSubstr("--allow-root"));
}

TEST_F(DeputyFaultsTest, AHostFileWithMistakesIsRefusedWithAllOfThem) {
  const std::string file = WriteHostFile(
      "<deputy><respawn give_up_after=\"0\"/><helth/></deputy><allow program=\"a\" "
      "argments=\"\"/>");

  host::ChildProcess& deputy = StartDeputy("d", {"--config", file});

  EXPECT_EQ(deputy.WaitOrKill(10'000), 78);
  EXPECT_THAT(deputy.LastWords(), HasSubstr("deputy.xml:1: "));
  EXPECT_THAT(deputy.LastWords(), HasSubstr("give_up_after=\"0\""));
  EXPECT_THAT(deputy.LastWords(), HasSubstr("health"));
  EXPECT_THAT(deputy.LastWords(), HasSubstr("arguments"));
}

TEST_F(DeputyFaultsTest, WithoutASheriffItRunsItsScriptForItsOwnCommandsAndASheriffTakesOver) {
  const std::filesystem::path pmd = folder_.path() / "own.pmd";
  std::ofstream(pmd) << R"(cmd "mine" { exec = "sleep 7401"; deputy = "d"; }
                           cmd "other" { exec = "sleep 7402"; deputy = "elsewhere"; }
                           script "up" { start everything wait "running"; })";
  StartDeputyAndAwait("d",
                      {"--set",
                       "deputy.by_itself.deployment=" + pmd.string(),
                       "--set",
                       "deputy.by_itself.script=up",
                       "--set",
                       "deputy.by_itself.after_ms=700"});

  ASSERT_TRUE(peer_.Await([&] { return peer_.Command("d", "mine").pid != 0; }));
  const core::procman::CommandReport mine = peer_.Command("d", "mine");
  EXPECT_EQ(PidWith("sleep 7402"), 0);
  EXPECT_TRUE(peer_.Await([&] { return peer_.health["d"].sheriff_id.starts_with("d:by-itself:"); }))
      << peer_.health["d"].sheriff_id;
  core::procman::DesiredCommand wanted = Wanted("mine", "sleep 7401", mine.run_id);
  peer_.Order("d", {wanted});

  ASSERT_TRUE(peer_.Await([&] { return peer_.health["d"].sheriff_id == "test:1:1"; }));
  EXPECT_EQ(peer_.Command("d", "mine").pid, mine.pid) << "nothing was restarted";
}

TEST_F(DeputyFaultsTest, AScriptThatIsNotThereIsToldAndNothingElseSuffers) {
  StartDeputyAndAwait("d",
                      {"--set",
                       "deputy.state_folder=" + (folder_.path() / "state").string(),
                       "--set",
                       "deputy.by_itself.deployment=/nowhere.pmd",
                       "--set",
                       "deputy.by_itself.script=up",
                       "--set",
                       "deputy.by_itself.after_ms=600"});

  EXPECT_TRUE(peer_.Await(
      [&] { return peer_.health["d"].text.find("/nowhere.pmd") != std::string::npos; }));
  peer_.Order("d", {Wanted("a", "sleep 50")});
  EXPECT_TRUE(peer_.AwaitState("d", "a", State::kRunning));
  EXPECT_THAT(peer_.health["d"].text, HasSubstr("/nowhere.pmd"))
      << "orders that are kept end no trouble";
}

// This test has a network of its own: its multicast route goes and comes.
TEST_F(DeputyFaultsTest, StartedBeforeAnyNetworkItCarriesOnWithItsOrdersAndIsThereWhenItComes) {
  if (geteuid() != 0) GTEST_SKIP() << "only root changes routes";
  host::ChildProcess& first = StartDeputy("d", WithState());
  ASSERT_TRUE(peer_.AwaitDeputy("d"));
  peer_.Order("d", {Wanted("a", "sleep 7301", 2)});
  ASSERT_TRUE(peer_.AwaitRunning("d", "a", 2));
  first.Signal(SIGTERM);
  ASSERT_EQ(first.WaitOrKill(10'000), 0);
  ASSERT_EQ(std::system("ip route del 224.0.0.0/4 dev lo && ip link set lo down"), 0);

  host::ChildProcess& second = StartDeputy("d", WithState());
  EXPECT_TRUE(peer_.Await([] { return PidWith("sleep 7301") != 0; })) << second.LastWords();
  ASSERT_EQ(std::system("ip link set lo up && ip route add 224.0.0.0/4 dev lo"), 0);
  // The listener's own socket lost its membership when the link went down.
  ProcmanPeer peer(url_);

  EXPECT_TRUE(peer.AwaitRunning("d", "a", 2)) << second.LastWords();
  peer.Order("d", {Unwanted(Wanted("a", "sleep 7301", 2))});
  EXPECT_TRUE(peer.AwaitStopped("d", "a"));
}

}  // namespace
}  // namespace clearway::test
