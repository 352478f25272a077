// SPDX-License-Identifier: BSD-3-Clause
// The verbs of clearway-sheriff on a simulated bus, with deputies of both kinds.
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/process/simulated_runtime.hpp"
#include "processes/procman_sheriff/verbs.hpp"
#include "tests/support/deputy_on_bus.hpp"

namespace clearway {
namespace {

using core::procman::DeployedCommand;
using core::procman::Deployment;
using core::procman::Script;
using core::procman::ScriptAction;
using testing::HasSubstr;

constexpr std::int64_t kStart = 1'700'000'000'000'000;

DeployedCommand Deployed(const std::string& id,
                         const std::string& deputy,
                         const std::string& exec = "run",
                         bool auto_respawn = false) {
  DeployedCommand command;
  command.spec.id = id;
  command.spec.exec = exec;
  command.spec.group = "sense";
  command.spec.auto_respawn = auto_respawn;
  command.spec.stop_time_allowed_s = 1.0F;
  command.deputy = deputy;
  return command;
}

Deployment Deploying(std::vector<DeployedCommand> commands) {
  Deployment deployment;
  deployment.file = "test.pmd";
  deployment.commands = std::move(commands);
  return deployment;
}

struct Outcome {
  bool is_done = false;
  int exit_status = -1;
  std::int64_t took_us = 0;
  std::vector<std::string> out;
  std::vector<std::string> error;
};

class ProcmanSheriffTest : public testing::Test {
 protected:
  // Programs come and go, so each has a runtime of its own in reality; here what they leave behind
  // in the one runtime has to live as long as that.
  SheriffVerbRun& Begin(const SheriffRequest& request, Outcome& outcome) {
    const std::int64_t start_us = runtime.MonotonicUs();
    verbs.push_back(std::make_unique<SheriffVerbRun>(
        runtime,
        request,
        SheriffPrinter{
            .out = [&outcome](const std::string& text) { outcome.out.push_back(text); },
            .error = [&outcome](const std::string& text) { outcome.error.push_back(text); }},
        SheriffVerbHooks{.done =
                             [this, &outcome, start_us] {
                               outcome.is_done = true;
                               outcome.took_us = runtime.MonotonicUs() - start_us;
                             },
                         .is_gone = is_gone}));
    return *verbs.back();
  }

  Outcome Run(SheriffVerb verb,
              std::optional<Deployment> deployment,
              std::vector<std::string> targets = {},
              const SheriffRequest& options = {}) {
    SheriffRequest request = options;
    request.verb = verb;
    request.deployment = std::move(deployment);
    request.targets = std::move(targets);
    Outcome outcome;
    SheriffVerbRun& run = Begin(request, outcome);
    for (int i = 0; i < 12'000 && !outcome.is_done; ++i) Pass(10'000);
    EXPECT_TRUE(outcome.is_done);
    outcome.exit_status = run.exit_status();
    // Its program ends.
    run.process().sheriff().SetMode(core::procman::Sheriff::Mode::kObserve);
    return outcome;
  }

  void Pass(std::int64_t duration_us) { runtime.RunUntil(runtime.MonotonicUs() + duration_us); }

  process::SimulatedRuntime runtime{kStart, {}};
  test::DeputyOnBus<test::MemoryDeputy> own{runtime, "own"};
  test::DeputyOnBus<test::ReferenceDeputy> ref{runtime, "ref"};
  std::function<bool(const std::string&)> is_gone = [](const std::string&) { return true; };
  std::vector<std::unique_ptr<SheriffVerbRun>> verbs;
  std::vector<std::unique_ptr<SheriffProcess>> others;
};

TEST_F(ProcmanSheriffTest, StartStopAndRestartDoWhatTheySay) {
  const Deployment file = Deploying({Deployed("a", "own", "ready 300"), Deployed("b", "own")});

  const Outcome start = Run(SheriffVerb::kStart, file, {"everything"});
  EXPECT_EQ(start.exit_status, 0);
  EXPECT_TRUE(own.deputy().IsUp("a") && own.deputy().IsUp("b"));
  EXPECT_LT(start.took_us, 2'500'000);
  const Outcome again = Run(SheriffVerb::kRestart, file, {"a"});
  EXPECT_EQ(again.exit_status, 0);
  EXPECT_EQ(own.deputy().StartsOf("a"), 2);
  EXPECT_EQ(own.deputy().StartsOf("b"), 1);
  const Outcome stop = Run(SheriffVerb::kStop, std::nullopt, {"sense"});
  EXPECT_EQ(stop.exit_status, 0);
  EXPECT_FALSE(own.deputy().IsUp("a") || own.deputy().IsUp("b"));
}

TEST_F(ProcmanSheriffTest, AnswersAtOnceWhereDeputiesTellTheirHealth) {
  ref.is_mute = true;
  Pass(500'000);
  const Deployment file = Deploying({Deployed("a", "own")});

  EXPECT_LE(Run(SheriffVerb::kStatus, file).took_us, 60'000);
  EXPECT_LE(Run(SheriffVerb::kStart, file, {"a"}).took_us, 700'000) << "half a second to settle";
  EXPECT_LE(Run(SheriffVerb::kStop, file, {"a"}).took_us, 110'000);
}

TEST_F(ProcmanSheriffTest, TheReferencesDeputyIsListenedToForAPeriod) {
  own.is_mute = true;
  const Deployment file =
      Deploying({Deployed("a", "ref", "stubborn"), Deployed("b", "ref", "run", true)});
  const Outcome start = Run(SheriffVerb::kStart, file, {"everything"});
  EXPECT_EQ(start.exit_status, 0);
  EXPECT_GE(start.took_us, 1'200'000);
  EXPECT_LE(start.took_us, 2'000'000);
  EXPECT_EQ(Run(SheriffVerb::kRestart, file, {"everything"}).exit_status, 0);
  EXPECT_EQ(ref.deputy().StartsOf("a"), 2);
  EXPECT_EQ(Run(SheriffVerb::kStop, file, {"everything"}).exit_status, 0);

  EXPECT_FALSE(ref.deputy().IsUp("a") || ref.deputy().IsUp("b"));
}

TEST_F(ProcmanSheriffTest, HalfOfAllOrdersMayBeLost) {
  std::mt19937 random(3);
  own.loses_orders = [&random] { return random() % 2 == 0; };
  ref.loses_orders = own.loses_orders;
  const Deployment file = Deploying({Deployed("a", "own", "ready 100"),
                                     Deployed("b", "ref"),
                                     Deployed("c", "ref", "stubborn"),
                                     Deployed("d", "own", "run", true)});
  for (int round = 1; round <= 5; ++round) {
    const Outcome up = Run(SheriffVerb::kRestart, file, {"everything"});
    ASSERT_EQ(up.exit_status, 0) << testing::PrintToString(up.error);
    EXPECT_EQ(own.deputy().StartsOf("a"), round);
    EXPECT_EQ(ref.deputy().StartsOf("c"), round);
  }
  EXPECT_EQ(Run(SheriffVerb::kStop, file, {"everything"}).exit_status, 0);
  EXPECT_FALSE(own.deputy().IsUp("a") || own.deputy().IsUp("d") || ref.deputy().IsUp("b") ||
               ref.deputy().IsUp("c"));
}

TEST_F(ProcmanSheriffTest, FailuresAreNamed) {
  Deployment file = Deploying({Deployed("good", "own"),
                               Deployed("bad", "own", "end 3 100"),
                               Deployed("mute", "own", "mute"),
                               Deployed("forbidden", "own", "forbidden")});

  const Outcome failed = Run(SheriffVerb::kStart, file, {"good", "bad"});
  EXPECT_EQ(failed.exit_status, kSheriffFailed);
  EXPECT_EQ(failed.error, std::vector<std::string>{"bad: Failed, exited with 3"});
  const Outcome refused = Run(SheriffVerb::kStart, file, {"cmd:forbidden"});
  EXPECT_EQ(refused.exit_status, kSheriffFailed);
  EXPECT_THAT(refused.error.front(), HasSubstr("no rule allows it"));
  SheriffRequest short_time;
  short_time.timeout_us = 2'000'000;
  const Outcome late = Run(SheriffVerb::kStart, file, {"mute"}, short_time);
  EXPECT_EQ(late.exit_status, kSheriffTimeout);
  EXPECT_EQ(late.error.front(), "not running after 2 s: mute: Getting ready, no status yet");
  const Outcome unknown = Run(SheriffVerb::kStart, file, {"godo"});
  EXPECT_EQ(unknown.exit_status, kSheriffUsage);
  EXPECT_THAT(unknown.error.front(), HasSubstr("known: bad, forbidden, good, mute, sense"));
}

TEST_F(ProcmanSheriffTest, ADeputyThatIsNeededAndNotHeardIsNamed) {
  const Deployment file = Deploying({Deployed("a", "own"), Deployed("far", "away")});

  const Outcome start = Run(SheriffVerb::kStart, file, {"everything"});
  EXPECT_EQ(start.exit_status, kSheriffUnheard);
  EXPECT_THAT(start.error.back(),
              HasSubstr("not heard: deputy away: is clearway-deputy running there"));
  EXPECT_FALSE(own.deputy().IsUp("a")) << "all or nothing, unless by force";
  EXPECT_EQ(Run(SheriffVerb::kStart, file, {"a"}).exit_status, 0) << "that one needs it not";
  const Outcome status = Run(SheriffVerb::kStatus, file);
  EXPECT_EQ(status.exit_status, kSheriffUnheard);
  EXPECT_THAT(status.out.front(), HasSubstr("Running"));
  const Outcome stop = Run(SheriffVerb::kStop, file, {"everything"});
  EXPECT_EQ(stop.exit_status, kSheriffUnheard);
  EXPECT_FALSE(own.deputy().IsUp("a")) << "what can be stopped is stopped";
}

TEST_F(ProcmanSheriffTest, NothingHeardAtAllIsSaid) {
  own.is_mute = true;
  ref.is_mute = true;
  const Outcome status = Run(SheriffVerb::kStatus, std::nullopt);
  EXPECT_EQ(status.exit_status, kSheriffUnheard);
  EXPECT_THAT(status.error.back(), HasSubstr("no deputy is heard"));
  const Outcome stop = Run(SheriffVerb::kStop, std::nullopt, {"everything"});
  EXPECT_EQ(stop.exit_status, kSheriffUnheard);
}

TEST_F(ProcmanSheriffTest, AnotherSheriffThatIsActiveKeepsTheVerbsOut) {
  is_gone = [](const std::string&) { return false; };
  for (const std::string deputy : {"own", "ref"}) {
    SCOPED_TRACE(deputy);
    const Deployment file = Deploying({Deployed("a", deputy)});
    Pass(4'000'000);
    auto screen = std::make_unique<SheriffProcess>(runtime, SheriffProcess::Settings{});
    screen->sheriff().Load(file, runtime.MonotonicUs());
    Pass(2'000'000);

    const Outcome start = Run(SheriffVerb::kStart, file, {"a"});
    EXPECT_EQ(start.exit_status, kSheriffOther);
    EXPECT_THAT(start.error.front(), HasSubstr(screen->sheriff().id()));
    EXPECT_THAT(start.error.front(), HasSubstr("--force"));
    EXPECT_EQ(Run(SheriffVerb::kStatus, file).exit_status, 0);
    SheriffRequest force;
    force.force = true;
    EXPECT_EQ(Run(SheriffVerb::kStart, file, {"a"}, force).exit_status, 0);
    screen->sheriff().SetMode(core::procman::Sheriff::Mode::kObserve);
    others.push_back(std::move(screen));
  }
}

// The deputy tells of orders that are less than 3 s old; who gave them has ended.
TEST_F(ProcmanSheriffTest, AVerbThatHasEndedIsNoOtherSheriff) {
  is_gone = [](const std::string&) { return false; };
  ref.is_mute = true;
  const Deployment file = Deploying({Deployed("a", "own")});
  EXPECT_EQ(Run(SheriffVerb::kStart, file, {"a"}).exit_status, 0);

  const Outcome slow = Run(SheriffVerb::kRestart, file, {"a"});
  EXPECT_EQ(slow.exit_status, 0) << "it is not known to have ended: its orders have to be old";
  EXPECT_GE(slow.took_us, 2'500'000);
  is_gone = [](const std::string&) { return true; };
  const Outcome quick = Run(SheriffVerb::kStop, file, {"a"});
  EXPECT_EQ(quick.exit_status, 0);
  EXPECT_LE(quick.took_us, 150'000);
}

TEST_F(ProcmanSheriffTest, WithoutWaitingTheOrdersAreSentThreeTimes) {
  SheriffRequest no_wait;
  no_wait.waits = false;
  ref.is_mute = true;
  Pass(100'000);
  int lost = 0;
  own.loses_orders = [&lost] { return ++lost <= 2; };

  const Outcome start =
      Run(SheriffVerb::kStart, Deploying({Deployed("a", "own", "ready 5000")}), {"a"}, no_wait);

  EXPECT_EQ(start.exit_status, 0);
  EXPECT_LT(start.took_us, 500'000);
  EXPECT_TRUE(own.deputy().IsUp("a"));
}

TEST_F(ProcmanSheriffTest, RunsAScriptOfTheFile) {
  Deployment file = Deploying({Deployed("a", "own"), Deployed("far", "away")});
  ScriptAction start;
  start.target = {core::procman::Target::Kind::kCommand, "a"};
  start.wait = ScriptAction::Status::kRunning;
  Script script;
  script.name = "up";
  script.actions = {start};
  file.scripts = {script};

  EXPECT_EQ(Run(SheriffVerb::kRun, file, {"up"}).exit_status, 0) << "it needs only one deputy";
  EXPECT_TRUE(own.deputy().IsUp("a"));
}

TEST_F(ProcmanSheriffTest, StatusAsJsonHasTheNamesOfTheReadme) {
  const Deployment file = Deploying({Deployed("a", "own"), Deployed("b", "ref", "end 3 10")});
  Run(SheriffVerb::kStart, file, {"everything"});
  SheriffRequest json;
  json.json = true;

  const Outcome status = Run(SheriffVerb::kStatus, file, {"sense"}, json);
  ASSERT_EQ(status.out.size(), 1U);
  const auto parsed = nlohmann::json::parse(status.out.front());

  EXPECT_EQ(parsed.at("result"), "done");
  EXPECT_EQ(parsed.at("file"), "test.pmd");
  EXPECT_EQ(parsed.at("deputies").at(0).at("id"), "own");
  EXPECT_EQ(parsed.at("deputies").at(0).at("heard"), true);
  EXPECT_EQ(parsed.at("deputies").at(0).at("tells_health"), true);
  EXPECT_EQ(parsed.at("deputies").at(1).at("tells_health"), false);
  const auto& a = parsed.at("commands").at(0);
  EXPECT_EQ(a.at("status"), "running");
  EXPECT_EQ(a.at("ready"), true);
  EXPECT_GT(a.at("pid"), 0);
  EXPECT_EQ(a.at("starts"), 1);
  const auto& b = parsed.at("commands").at(1);
  EXPECT_EQ(b.at("status"), "failed");
  EXPECT_EQ(b.at("exit"), "exited with 3");
  EXPECT_EQ(b.at("wait_status"), 768);
  EXPECT_FALSE(b.contains("pid"));
  EXPECT_EQ(parsed.at("groups").at(1).at("path"), "sense");
  EXPECT_EQ(parsed.at("groups").at(1).at("trouble"), 1);
}

TEST_F(ProcmanSheriffTest, FollowPrintsWholeLinesWithWhoWroteThem) {
  Outcome outcome;
  SheriffRequest request;
  request.verb = SheriffVerb::kFollow;
  SheriffVerbRun& follow = Begin(request, outcome);
  Pass(100'000);

  own.Print("a", "one\r\ntw");
  own.Print("b", "\x1b[31mred\x1b[0m \x1b[2Jgone\x07\n");
  ref.Print("", "the deputy speaks\n");
  own.Print("a", "o\nthree");
  Pass(100'000);
  follow.Interrupt();

  EXPECT_THAT(outcome.out,
              testing::ElementsAre("own/a: one",
                                   "own/b: \x1b[31mred\x1b[0m gone",
                                   "ref: the deputy speaks",
                                   "own/a: two",
                                   "own/a: three"));
  EXPECT_TRUE(outcome.is_done);
  EXPECT_EQ(follow.exit_status(), 0);
}

TEST_F(ProcmanSheriffTest, FollowOfOneTargetPrintsOnlyThat) {
  ref.is_mute = true;
  Run(SheriffVerb::kStart, Deploying({Deployed("a", "own"), Deployed("b", "own")}), {"a"});
  Outcome outcome;
  SheriffRequest request;
  request.verb = SheriffVerb::kFollow;
  request.targets = {"a"};
  Begin(request, outcome);
  Pass(100'000);

  own.Print("a", "mine\n");
  own.Print("b", "not mine\n");
  Pass(100'000);

  EXPECT_EQ(outcome.out, std::vector<std::string>{"a: mine"});
}

TEST_F(ProcmanSheriffTest, ObserveSendsNothingAndPrintsTheHistory) {
  Outcome lines;
  Outcome objects;
  SheriffRequest request;
  request.verb = SheriffVerb::kObserve;
  const SheriffVerbRun& observer = Begin(request, lines);
  request.json = true;
  Begin(request, objects);
  Pass(5'000'000);
  EXPECT_EQ(own.discoveries, 0);
  EXPECT_EQ(own.orders, 0);

  Run(SheriffVerb::kStart, Deploying({Deployed("a", "own")}), {"a"});
  Pass(100'000);

  EXPECT_THAT(lines.out, testing::Contains(HasSubstr("own a: Starting -> ")));
  EXPECT_THAT(lines.out, testing::Contains(HasSubstr("own a: ")));
  EXPECT_THAT(lines.out.front(), testing::StartsWith("2023-11-14T22:13:2"));
  std::vector<std::string> to;
  for (const std::string& line : objects.out) {
    const auto parsed = nlohmann::json::parse(line);
    if (parsed.contains("command")) to.push_back(parsed.at("to"));
  }
  EXPECT_EQ(to.front(), "starting");
  EXPECT_EQ(to.back(), "running");
  (void)observer;
}

TEST_F(ProcmanSheriffTest, AnInterruptedVerbSaysWhatGoesOn) {
  Outcome outcome;
  SheriffRequest request;
  request.verb = SheriffVerb::kStart;
  request.deployment = Deploying({Deployed("a", "own", "mute")});
  request.targets = {"a"};
  SheriffVerbRun& run = Begin(request, outcome);
  Pass(2'000'000);
  run.Interrupt();

  EXPECT_EQ(run.exit_status(), kSheriffFailed);
  EXPECT_THAT(outcome.error.back(), HasSubstr("interrupted"));
}

TEST(HasSheriffEndedTest, OnlyAProcessOfThisHostThatIsNoMoreHasEnded) {
  EXPECT_TRUE(HasSheriffEnded("here:999999999:1", "here"));
  EXPECT_FALSE(HasSheriffEnded("there:999999999:1", "here"));
  EXPECT_FALSE(HasSheriffEnded("here:1:1", "here"));
  EXPECT_FALSE(HasSheriffEnded("here:x:1", "here"));
  EXPECT_FALSE(HasSheriffEnded("here:-1:1", "here"));
  EXPECT_FALSE(HasSheriffEnded("here:", "here"));
  EXPECT_FALSE(HasSheriffEnded("", "here"));
}

}  // namespace
}  // namespace clearway
