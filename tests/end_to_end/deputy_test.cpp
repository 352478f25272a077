// SPDX-License-Identifier: BSD-3-Clause
// The real deputy, procman's protocol on one side and real processes on the other: what it does
// with orders and with children of all kinds.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/deputy_fixture.hpp"

namespace clearway::test {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kSecond = 1'000'000;

class DeputyTest : public DeputyProgramTest {};

TEST_F(DeputyTest, AnnouncesItselfThreeTimesThenReportsAtOneHertzAndWhenAsked) {
  StartDeputyAndAwait("d");

  EXPECT_EQ(peer_.discoveries, 3);
  const std::size_t before = peer_.reports.size();
  EXPECT_EQ(before, 1U);
  auto& times_us = peer_.report_times_us["d"];
  const std::size_t seen = times_us.size();
  peer_.Discover("somebody", 0);
  EXPECT_TRUE(peer_.Await([&] { return times_us.size() > seen; }, kSecond / 2)) << "at once";
  const std::size_t from = times_us.size();
  ASSERT_TRUE(peer_.Await([&] { return times_us.size() >= from + 3; }));
  EXPECT_NEAR(static_cast<double>(times_us[from + 2] - times_us[from]), 2e6, 5e5);
}

TEST_F(DeputyTest, StartsStopsAndRestartsByOneOrderEach) {
  StartDeputyAndAwait("d");

  peer_.Order("d", {Wanted("a", "sleep 50")});
  ASSERT_TRUE(peer_.AwaitRunning("d", "a", 1));
  const std::int32_t first = peer_.Command("d", "a").pid;
  EXPECT_TRUE(IsAlive(first));
  peer_.Order("d", {Wanted("a", "sleep 50", 2)});
  ASSERT_TRUE(peer_.AwaitRunning("d", "a", 2));
  EXPECT_FALSE(IsAlive(first));
  EXPECT_NE(peer_.Command("d", "a").pid, first);
  peer_.Order("d", {Unwanted(Wanted("a", "sleep 50", 2))});
  ASSERT_TRUE(peer_.AwaitStopped("d", "a"));

  EXPECT_EQ(peer_.Command("d", "a").exit_code, SIGINT);
  EXPECT_TRUE(peer_.AwaitState("d", "a", State::kStopped));
}

TEST_F(DeputyTest, AOneCharacterArgumentArrives) {
  StartDeputyAndAwait("d");

  peer_.Order("d", {Wanted("a", "echo 5")});

  EXPECT_TRUE(AwaitOutput("a", "5\n")) << OutputOf("a");
}

TEST_F(DeputyTest, EnvironmentAssignmentsReachTheChildAndVariablesAreExpanded) {
  ::setenv("CLEARWAY_TEST_WORD", "from the deputy", 1);
  StartDeputyAndAwait("d");
  ::unsetenv("CLEARWAY_TEST_WORD");

  peer_.Order("d",
              {Wanted("a",
                      "CW_ONE=1 CW_TWO=\"x y\" sh -c 'printf \"<%s>\" \"$0\"; env' "
                      "\"$CLEARWAY_TEST_WORD $CLEARWAY_NOT_SET\"")});

  EXPECT_TRUE(AwaitOutput("a", "CW_TWO=x y\n")) << OutputOf("a");
  EXPECT_THAT(OutputOf("a"), HasSubstr("CW_ONE=1\n"));
  EXPECT_THAT(OutputOf("a"), HasSubstr("<from the deputy $CLEARWAY_NOT_SET>"));
}

TEST_F(DeputyTest, ChildrenHaveATerminalAndNoOtherDescriptors) {
  StartDeputyAndAwait("d");

  peer_.Order("d",
              {Wanted("a", "sh -c 'test -t 1 && echo terminal; ls -1 /proc/self/fd; echo end'")});

  ASSERT_TRUE(AwaitOutput("a", "end\n"));
  EXPECT_THAT(OutputOf("a"), HasSubstr("terminal\n0\n1\n2\n3\nend\n")) << "3 is ls's own";
}

TEST_F(DeputyTest, AMissingProgramIsSaidAndIsAnError) {
  StartDeputyAndAwait("d");

  peer_.Order("d", {Wanted("a", "no-such-program --x")});

  ASSERT_TRUE(peer_.AwaitState("d", "a", State::kRefused));
  EXPECT_THAT(peer_.HealthOf("d", "a").text, HasSubstr("no program \"no-such-program\""));
  EXPECT_EQ(peer_.Command("d", "a").exit_code, 255 << 8);
  EXPECT_EQ(peer_.Command("d", "a").run_id, 1);
  EXPECT_TRUE(AwaitOutput("a", "not started: no program"));
}

TEST_F(DeputyTest, ACrashLoopBacksOffAndGivesUp) {
  StartDeputyAndAwait(
      "d",
      {"--set", "deputy.respawn.give_up_after=5", "--set", "deputy.respawn.first_pause_ms=50"});
  core::procman::DesiredCommand crash = Wanted("a", "sh -c 'date +%s%N; exit 3'");
  crash.spec.auto_respawn = true;

  peer_.Order("d", {crash});

  ASSERT_TRUE(peer_.AwaitState("d", "a", State::kGaveUp));
  EXPECT_EQ(peer_.HealthOf("d", "a").starts, 5);
  EXPECT_EQ(peer_.HealthOf("d", "a").quick_deaths, 5);
  EXPECT_THAT(peer_.HealthOf("d", "a").text, HasSubstr("exited with 3; gave up"));
  EXPECT_EQ(peer_.Command("d", "a").exit_code, 3 << 8);
  ASSERT_TRUE(AwaitOutput("a", "gave up"));
  std::vector<double> starts_s;
  std::istringstream lines(OutputOf("a"));
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && std::isdigit(static_cast<unsigned char>(line[0])) != 0) {
      starts_s.push_back(std::stod(line) * 1e-9);
    }
  }
  ASSERT_EQ(starts_s.size(), 5U) << OutputOf("a");
  for (std::size_t i = 1; i < starts_s.size(); ++i) {
    EXPECT_GE(starts_s[i] - starts_s[i - 1], 0.050 * (1 << (i - 1)) - 0.002) << i;
  }
}

TEST_F(DeputyTest, AChildThatIgnoresSigintIsKilledAfterItsTimeByOneOrder) {
  StartDeputyAndAwait("d");
  core::procman::DesiredCommand stubborn =
      Wanted("a", "sh -c 'trap \"\" INT; echo armed; while :; do sleep 0.1; done'");
  stubborn.spec.stop_time_allowed_s = 1.0F;
  peer_.Order("d", {stubborn});
  ASSERT_TRUE(AwaitOutput("a", "armed"));

  const std::int64_t from_us = ProcmanPeer::NowUs();
  peer_.Order("d", {Unwanted(stubborn)});
  ASSERT_TRUE(peer_.AwaitStopped("d", "a"));

  EXPECT_GE(ProcmanPeer::NowUs() - from_us, kSecond - 50'000);
  EXPECT_EQ(peer_.Command("d", "a").exit_code, SIGKILL);
}

// Children in their own session, with a changed name, with an empty environment, orphaned.
TEST_F(DeputyTest, NoGrandchildSurvives) {
  StartDeputyAndAwait("d");
  const std::string script =
      "sh -c 'sleep 7101 & setsid sleep 7102 & (setsid env -i sleep 7103 &) ; "
      "(env -i setsid sh -c \"sleep 7104 & exec sleep 7105\" &) ; echo born; WAIT'";
  const auto with = [&script](const std::string& end) {
    return std::string(script).replace(script.find("WAIT"), 4, end);
  };
  const auto survivors = [] {
    std::string found;
    for (const char* name :
         {"sleep 7101", "sleep 7102", "sleep 7103", "sleep 7104", "sleep 7105"}) {
      if (PidWith(name) != 0) found += std::string(name) + "; ";
    }
    return found;
  };

  peer_.Order("d", {Wanted("stopped", with("sleep 7100"))});
  ASSERT_TRUE(AwaitOutput("stopped", "born"));
  ASSERT_TRUE(peer_.Await([] { return PidWith("sleep 7104") != 0 && PidWith("sleep 7105") != 0; }));
  peer_.Order("d", {Unwanted(Wanted("stopped", with("sleep 7100")))});
  ASSERT_TRUE(peer_.AwaitStopped("d", "stopped"));
  EXPECT_EQ(survivors(), "");

  peer_.Order("d", {Wanted("ends", with("exit 0"))});
  ASSERT_TRUE(AwaitOutput("ends", "exited with 0"));
  EXPECT_EQ(survivors(), "") << "when it ended by itself";
}

TEST_F(DeputyTest, ALoudChildSilencesNobodyAndWhatIsDroppedIsSaid) {
  StartDeputyAndAwait("d", {"--set", "deputy.logs.max_kb=1000"});
  constexpr int kSeconds = 3;
  // 10 MB/s: 100 kB each 10 ms.
  const std::string loud =
      "sh -c 'line=$(head -c 99999 /dev/zero | tr \"\\\\0\" x); i=0; while [ $i -lt 300 ]; do "
      "echo $line; i=$((i+1)); sleep 0.01; done; echo finished'";
  const std::string quiet = "sh -c 'while :; do echo tick; sleep 0.2; done'";

  peer_.Order("d", {Wanted("loud", loud), Wanted("quiet", quiet)});
  ASSERT_TRUE(peer_.AwaitRunning("d", "loud", 1));
  const std::size_t reports = peer_.report_times_us["d"].size();
  ASSERT_TRUE(peer_.AwaitStopped("d", "loud"));

  EXPECT_GE(peer_.report_times_us["d"].size() - reports, std::size_t{kSeconds});
  EXPECT_THAT(OutputOf("quiet"), HasSubstr("tick\ntick\ntick\n"));
  EXPECT_GT(peer_.HealthOf("d", "loud").dropped_output_bytes, 10'000'000);
  EXPECT_TRUE(AwaitOutput("loud", "bytes of output were not sent"));
  EXPECT_LE(peer_.largest_output_bytes, 58'000U);
  // The disk has the end of it, within its bounds.
  std::uintmax_t bytes = 0;
  std::string newest;
  for (const auto& file : std::filesystem::directory_iterator(LogFolder("d"))) {
    if (file.path().filename().string().starts_with("loud")) bytes += file.file_size();
    if (file.path().filename() != "loud.log") continue;
    std::ifstream stream(file.path());
    newest.assign(std::istreambuf_iterator<char>(stream), {});
  }
  EXPECT_LE(bytes, 4'100'000U);
  EXPECT_GT(bytes, 2'500'000U);
  EXPECT_THAT(newest, HasSubstr(" finished\n"));
  EXPECT_THAT(newest, HasSubstr(" --- exited with 0\n"));
}

TEST_F(DeputyTest, OutputOnDiskHasTimeStamps) {
  StartDeputyAndAwait("d");

  peer_.Order("d", {Wanted("a/b", "echo hello")});
  ASSERT_TRUE(AwaitOutput("a/b", "exited with 0"));

  std::ifstream stream(LogFolder("d") / "a%2Fb.log");
  const std::string log((std::istreambuf_iterator<char>(stream)), {});
  EXPECT_THAT(log, testing::ContainsRegex("20[0-9-]*T[0-9:.]*[+-][0-9]* hello\n"));
  EXPECT_THAT(log, HasSubstr(" --- started, process "));
}

TEST_F(DeputyTest, UsageCountsChildren) {
  StartDeputyAndAwait("d");

  peer_.Order("d", {Wanted("a", "sh -c '(while :; do :; done) & wait'")});

  const auto processors = static_cast<float>(sysconf(_SC_NPROCESSORS_ONLN));
  EXPECT_TRUE(peer_.Await([&] { return peer_.Command("d", "a").cpu_usage > 0.3F / processors; }));
  EXPECT_GT(peer_.Command("d", "a").mem_rss_bytes, 100'000);
  EXPECT_GT(peer_.reports["d"].phys_mem_total_bytes, 100'000'000);
  EXPECT_GT(peer_.reports["d"].cpu_load, 0.0F);
}

TEST_F(DeputyTest, RealProgramsAreReadyWhenTheirStatusSaysSoAndUnhealthyWhenItStops) {
  StartDeputyAndAwait("d");
  const std::string clusterer = "clearway-clusterer --config " +
                                std::string(std::getenv("CLEARWAY_SOURCE")) +
                                "/config/lab.xml --lcm-url " + url_;
  const core::procman::DesiredCommand watched = Wanted(
      "c", "CLEARWAY_STATUS_CHANNEL=CLUSTERER_STATUS CLEARWAY_RESTART_UNHEALTHY=1 " + clusterer);

  peer_.Order("d", {watched, Wanted("plain", "sleep 50")});
  ASSERT_TRUE(peer_.AwaitRunning("d", "c", 1));
  const std::int32_t pid = peer_.Command("d", "c").pid;
  ASSERT_TRUE(peer_.Await([&] { return IsReady(peer_.HealthOf("d", "c")); }));
  EXPECT_TRUE(IsReady(peer_.HealthOf("d", "plain"))) << "none is expected of it";
  kill(pid, SIGSTOP);
  EXPECT_TRUE(peer_.Await(
      [&] { return peer_.HealthOf("d", "c").health == core::procman::CommandHealth::kUnhealthy; }));
  EXPECT_THAT(peer_.HealthOf("d", "c").text, HasSubstr("its status has stopped"));
  ASSERT_TRUE(peer_.Await([&] {
    return IsReady(peer_.HealthOf("d", "c")) && peer_.Command("d", "c").pid != pid;
  })) << peer_.HealthOf("d", "c").text;

  EXPECT_FALSE(IsAlive(pid)) << "the frozen one was killed";
  EXPECT_EQ(peer_.HealthOf("d", "c").starts, 2);
}

TEST_F(DeputyTest, ShutDownGivesEachCommandItsTimeAndGoesBackwards) {
  host::ChildProcess& deputy = StartDeputy("d");
  ASSERT_TRUE(peer_.AwaitDeputy("d"));
  const std::string slow =
      "sh -c 'trap \"sleep 1.5; echo bye from $0; exit 0\" INT; echo up; "
      "while :; do sleep 0.05; done' ";
  peer_.Order("d", {Wanted("first", slow + "first")});
  ASSERT_TRUE(AwaitOutput("first", "up\n"));
  peer_.Order("d", {Wanted("first", slow + "first"), Wanted("second", slow + "second")});
  ASSERT_TRUE(AwaitOutput("second", "up\n"));

  deputy.Signal(SIGTERM);
  ASSERT_TRUE(AwaitOutput("second", "bye from second"));
  EXPECT_THAT(OutputOf("first"), Not(HasSubstr("bye")));
  ASSERT_TRUE(AwaitOutput("first", "bye from first"));

  EXPECT_EQ(deputy.WaitOrKill(10'000), 0);
}

TEST_F(DeputyTest, AskedTwiceToStopItKills) {
  host::ChildProcess& deputy = StartDeputy("d");
  ASSERT_TRUE(peer_.AwaitDeputy("d"));
  core::procman::DesiredCommand stubborn =
      Wanted("a", "sh -c 'trap \"\" INT; echo armed; while :; do sleep 0.1; done'");
  stubborn.spec.stop_time_allowed_s = 600.0F;
  peer_.Order("d", {stubborn});
  ASSERT_TRUE(AwaitOutput("a", "armed"));

  deputy.Signal(SIGINT);
  ASSERT_TRUE(peer_.AwaitState("d", "a", State::kStopping));
  deputy.Signal(SIGTERM);

  EXPECT_EQ(deputy.WaitOrKill(10'000), 0);
}

}  // namespace
}  // namespace clearway::test
