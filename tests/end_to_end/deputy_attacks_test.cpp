// SPDX-License-Identifier: BSD-3-Clause
// The real deputy under floods, storms, shortages and hostile input.
#include <fstream>
#include <system_error>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/deputy_fixture.hpp"

namespace clearway::test {
namespace {

using core::procman::DesiredCommand;
using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kSecond = 1'000'000;

class DeputyAttackTest : public DeputyProgramTest {
 protected:
  std::vector<std::string> WithState() const {
    return {"--set", "deputy.state_folder=" + (folder_.path() / "state").string()};
  }
  [[nodiscard]] std::string PathOf(const std::string& name) const {
    return (folder_.path() / name).string();
  }
  [[nodiscard]] std::uintmax_t SizeOf(const std::string& name) const {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(PathOf(name), error);
    return error ? 0 : size;
  }
  [[nodiscard]] bool Lives() { return !deputies_.back()->ExitStatus().has_value(); }
  void Listen(std::int64_t duration_us) {
    peer_.Await([] { return false; }, duration_us);
  }
  [[nodiscard]] std::size_t NumReports() { return peer_.report_times_us["d"].size(); }
  [[nodiscard]] bool AwaitMoreReports() {
    const std::size_t seen = NumReports();
    return peer_.Await([&] { return NumReports() > seen + 1; });
  }
  [[nodiscard]] std::size_t NumRunning() const {
    const auto report = peer_.reports.find("d");
    if (report == peer_.reports.end()) return 0;
    const auto& commands = report->second.commands;
    return static_cast<std::size_t>(
        std::count_if(commands.begin(), commands.end(), [](const auto& c) { return c.pid != 0; }));
  }
  static std::vector<DesiredCommand> Many(int count, const std::string& exec) {
    std::vector<DesiredCommand> commands;
    for (int i = 0; i < count; ++i) commands.push_back(Wanted("c" + std::to_string(i), exec));
    return commands;
  }
  // A command line whose process is followed by a child of its own 300 times, each an orphan in a
  // new session; every one leaves a mark in the file "hops".
  [[nodiscard]] std::string Hopping() const {
    const std::string script = PathOf("hop.sh");
    std::ofstream(script) << "sleep 0.01; echo x >> " << PathOf("hops") << "\n"
                          << "[ $1 -lt 300 ] && setsid sh " << script << " $(($1 + 1)) &\n";
    return "sh -c 'sh " + script + " 1 & sleep 50'";
  }
};

TEST_F(DeputyAttackTest, IdsThatComeAndGoLeaveNothingOpen) {
  launcher_ = {"prlimit", "--nofile=64"};
  StartDeputyAndAwait("d");

  for (int i = 0; i < 80; ++i) {
    const std::string id = "c" + std::to_string(i);
    peer_.Order("d", {Wanted(id, "true")});
    ASSERT_TRUE(peer_.AwaitState("d", id, State::kEnded)) << deputies_.back()->LastWords();
  }

  EXPECT_EQ(peer_.HealthOf("d", "c79").text, "exited with 0");
  EXPECT_EQ(peer_.health["d"].text, "");
}

TEST_F(DeputyAttackTest, ShortOfDescriptorsItRunsWhatItCanAndStaysMasterOfIt) {
  launcher_ = {"prlimit", "--nofile=64"};
  StartDeputyAndAwait("d");

  peer_.Order("d", Many(60, "sleep 50"));
  ASSERT_TRUE(peer_.Await([&] { return peer_.health["d"].commands.size() == 60; }));
  ASSERT_TRUE(AwaitMoreReports()) << deputies_.back()->LastWords();

  EXPECT_GE(NumRunning(), 8U);
  EXPECT_LT(NumRunning(), 32U);
  EXPECT_THAT(peer_.HealthOf("d", "c59").text, HasSubstr("too few file descriptors"));
  peer_.Order("d", {});
  EXPECT_TRUE(peer_.Await([&] { return peer_.reports["d"].commands.empty(); }));
  EXPECT_TRUE(Lives());
}

TEST_F(DeputyAttackTest, ACommandThatLetsGoOfItsTerminalRunsOnAndMayTakeItAgain) {
  StartDeputyAndAwait("d");

  peer_.Order("d",
              {Wanted("a", "sh -c 'exec sleep 50 >/dev/null 2>&1 </dev/null'"),
               Wanted("b", "sh -c 'exec >&- 2>&- <&-; sleep 1; echo again >/dev/tty; sleep 50'")});

  EXPECT_TRUE(AwaitOutput("b", "again\n"));
  EXPECT_EQ(NumRunning(), 2U) << peer_.HealthOf("d", "a").text;
}

TEST_F(DeputyAttackTest, AFloodOfDiscoveriesIsNotAnsweredOneByOneNorMakesARival) {
  StartDeputyAndAwait("d");
  const std::size_t before = NumReports();

  bool has_rival = false;
  for (int i = 0; i < 3000; ++i) {
    peer_.Discover("somebody", 0);
    if (i % 100 == 0) Listen(20'000);
    has_rival = has_rival || peer_.health["d"].text.find("same id") != std::string::npos;
  }
  ASSERT_TRUE(AwaitMoreReports());

  EXPECT_LT(NumReports() - before, 300U);
  EXPECT_FALSE(has_rival);
}

TEST_F(DeputyAttackTest, AStormOfRunIdsNeverMakesTwoCopies) {
  StartDeputyAndAwait("d");
  const std::string one =
      "sh -c 'flock -n -E 9 " + PathOf("lock") + " sleep 50; [ $? -eq 9 ] && echo twice; sleep 50'";

  for (std::int32_t i = 1; i <= 200; ++i) {
    peer_.Order("d", {Wanted("a", one, i % 2 == 0 ? -i : i)});
    Listen(5'000);
  }

  ASSERT_TRUE(peer_.AwaitRunning("d", "a", -200));
  EXPECT_THAT(OutputOf("a"), Not(HasSubstr("twice")));
}

TEST_F(DeputyAttackTest, FrozenForAWhileItObeysTheLastOfWhatHasQueuedUp) {
  StartDeputyAndAwait("d");

  deputies_.back()->Signal(SIGSTOP);
  for (std::int32_t i = 1; i <= 500; ++i) {
    peer_.Order("d", {Wanted("a", "sleep 50", i)});
    if (i % 50 == 0) Listen(50'000);
  }
  deputies_.back()->Signal(SIGCONT);

  EXPECT_TRUE(peer_.AwaitRunning("d", "a", 500));
}

TEST_F(DeputyAttackTest, AFrozenCommandIsStoppedWithWhatItStarted) {
  StartDeputyAndAwait("d");
  DesiredCommand frozen = Wanted("a", "sh -c 'sleep 7501 & sleep 7502'");
  frozen.spec.stop_time_allowed_s = 1.0F;
  peer_.Order("d", {frozen});
  ASSERT_TRUE(peer_.Await([] { return PidWith("sleep 7502") != 0; }));
  ASSERT_TRUE(peer_.AwaitRunning("d", "a", 1));
  kill(PidWith("sleep 7501"), SIGSTOP);
  kill(peer_.Command("d", "a").pid, SIGSTOP);

  peer_.Order("d", {Unwanted(frozen)});

  ASSERT_TRUE(peer_.AwaitStopped("d", "a"));
  EXPECT_EQ(PidWith("sleep 7501"), 0);
}

TEST_F(DeputyAttackTest, ManyThatEndAtOnceAreAllSeen) {
  StartDeputyAndAwait("d", WithState());
  peer_.Order("d", Many(150, "sleep 50"));
  ASSERT_TRUE(peer_.Await([&] { return NumRunning() == 150; }));
  const std::size_t before = NumReports();

  for (const auto& command : peer_.reports["d"].commands) kill(command.pid, SIGTERM);
  ASSERT_TRUE(peer_.Await([&] { return NumRunning() == 0; }));

  EXPECT_LT(NumReports() - before, 75U) << "told together";
  for (const auto& command : peer_.reports["d"].commands) EXPECT_EQ(command.exit_code, SIGTERM);
}

TEST_F(DeputyAttackTest, WhatTheDiskDoesNotTakeIsToldAndEndsNothing) {
  launcher_ = {"prlimit", "--fsize=20000"};
  StartDeputyAndAwait("d", WithState());

  peer_.Order("d", Many(20, "echo " + std::string(1500, 'x')));
  EXPECT_TRUE(peer_.Await([&] {
    return peer_.health["d"].text.find("orders: cannot be written") != std::string::npos;
  }));
  peer_.Order("d", {Wanted("a", "sh -c 'head -c 50000 /dev/zero; sleep 50'")});
  EXPECT_TRUE(peer_.Await([&] {
    return peer_.health["d"].text.find("a.log: cannot be written") != std::string::npos;
  }));

  EXPECT_THAT(peer_.health["d"].text, Not(HasSubstr("orders: cannot")));
  EXPECT_NE(peer_.Command("d", "a").pid, 0);
}

TEST_F(DeputyAttackTest, AReaderOfItsOwnMessagesThatIsGoneEndsNothing) {
  launcher_ = {"bash", "-c", "exec \"$@\" 2> >(exec head -c 1 >/dev/null)", "launcher"};
  StartDeputyAndAwait("d");
  Listen(kSecond / 2);

  peer_.Order("d", {Wanted("a", "sleep 50"), Wanted("b", "true")});

  EXPECT_TRUE(peer_.AwaitState("d", "b", State::kEnded));
  EXPECT_TRUE(peer_.AwaitRunning("d", "a", 1));
}

TEST_F(DeputyAttackTest, IdsOfAllKindsRunAndEachHasItsLogInTheFolder) {
  StartDeputyAndAwait("d");
  const std::vector<std::string> ids{
      "../../x", "..", ".", "a\nb\x1b[31m", std::string(1000, 'j'), "a=b", "\xff\xc3", "%"};
  std::vector<DesiredCommand> commands;
  for (const std::string& id : ids) commands.push_back(Wanted(id, "sh -c 'echo hi; sleep 50'"));

  peer_.Order("d", commands);

  for (const std::string& id : ids) EXPECT_TRUE(AwaitOutput(id, "hi\n")) << id;
  std::size_t num_logs = 0;
  for (const auto& file : std::filesystem::directory_iterator(LogFolder("d"))) {
    if (file.path().extension() == ".log") ++num_logs;
  }
  EXPECT_EQ(num_logs, ids.size());
  EXPECT_THAT(deputies_.back()->LastWords(), HasSubstr("a?b?[31m: started")) << "on one line";
}

TEST_F(DeputyAttackTest, AStatusChannelThatCannotBeOneIsRefused) {
  StartDeputyAndAwait("d");
  std::vector<DesiredCommand> commands{
      Wanted("good", "CLEARWAY_STATUS_CHANNEL=PM_ORDERS sleep 50")};
  for (const std::string& name : {std::string(64, 'x'), std::string("\xff"), std::string()}) {
    commands.push_back(Wanted("bad " + std::to_string(name.size()),
                              "CLEARWAY_STATUS_CHANNEL=" + name + " sleep 50"));
  }

  peer_.Order("d", commands);

  for (const char* id : {"bad 64", "bad 1", "bad 0"}) {
    EXPECT_TRUE(peer_.AwaitState("d", id, State::kRefused)) << id;
  }
  EXPECT_THAT(peer_.HealthOf("d", "bad 64").text, HasSubstr("CLEARWAY_STATUS_CHANNEL"));
  ASSERT_TRUE(peer_.AwaitRunning("d", "good", 1));
  EXPECT_FALSE(IsReady(peer_.HealthOf("d", "good"))) << "orders are no status";
}

TEST_F(DeputyAttackTest, ACommandThatHopsFromProcessToProcessIsCaught) {
  StartDeputyAndAwait("d");
  peer_.Order("d", {Wanted("a", Hopping())});
  ASSERT_TRUE(peer_.Await([&] { return SizeOf("hops") > 20; }));

  peer_.Order("d", {});
  ASSERT_TRUE(peer_.Await([&] { return peer_.reports["d"].commands.empty(); }));
  const std::uintmax_t hops = SizeOf("hops");
  Listen(kSecond / 4);

  EXPECT_LE(SizeOf("hops"), hops);
}

TEST_F(DeputyAttackTest, WhatHopsOnAfterTheDeputyWasKilledIsCaughtByItsNextLife) {
  StartDeputyAndAwait("d", WithState());
  peer_.Order("d", {Wanted("a", Hopping())});
  ASSERT_TRUE(peer_.Await([&] { return SizeOf("hops") > 20; }));

  deputies_.back()->Signal(SIGKILL);
  deputies_.back()->WaitOrKill(10'000);
  std::filesystem::remove(PathOf("state/orders"));
  peer_.reports.clear();
  StartDeputyAndAwait("d", WithState());
  const std::uintmax_t hops = SizeOf("hops");
  Listen(kSecond / 4);

  EXPECT_EQ(SizeOf("hops"), hops);
}

TEST_F(DeputyAttackTest, ADeputyUnderADeputyWithACommandOfTheSameId) {
  StartDeputyAndAwait("d");
  const std::string inner = "clearway-deputy --id inner --allow-any --allow-root --lcm-url " +
                            url_ + "?ttl=0 --set deputy.logs.folder=" + PathOf("inner");
  peer_.Order("d", {Wanted("a", "sleep 50"), Wanted("deputy", inner)});
  ASSERT_TRUE(peer_.AwaitDeputy("inner"));
  peer_.Order("inner",
              {Wanted("a", "sh -c '(setsid sleep 7901 &) ; setsid sleep 7902 & sleep 7903'")});
  ASSERT_TRUE(peer_.Await([] { return PidWith("sleep 7903") != 0 && PidWith("sleep 7901") != 0; }));
  const auto pid = peer_.Command("d", "a").pid;

  kill(peer_.Command("d", "deputy").pid, SIGKILL);

  ASSERT_TRUE(peer_.AwaitState("d", "deputy", State::kEnded));
  for (const char* name : {"sleep 7901", "sleep 7902", "sleep 7903"})
    EXPECT_EQ(PidWith(name), 0) << name;
  EXPECT_TRUE(IsAlive(pid));
}

}  // namespace
}  // namespace clearway::test
