// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/graph_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::doctor {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Here kHere{.host = "robot", .deputy = "robot", .version = "1.0", .deputy_config = {}};
const ConfigFacts kConfig{.path = "/etc/clearway/graph.xml",
                          .problems = {},
                          .digest = "aa",
                          .effective_digest = "aa"};

HeardProcess Process(const std::string& host, std::int32_t pid, const std::string& digest = "aa") {
  return {"CLUSTERER_STATUS", host, pid, "1.0", digest};
}

HeardDeputy Deputy(const std::string& id, const std::string& digest = "aa") {
  return {.id = id,
          .is_ours = true,
          .host = id,
          .version = "1.0",
          .config_digest = digest,
          .problem = {},
          .pids = {}};
}

TEST(Traffic, SilenceIsGood) {
  const Findings findings = CheckTraffic({}, kHere);

  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, State::kOk);
}

TEST(Traffic, TheGraphOfADeputyIsGood) {
  Heard heard{.channels = {"CLUSTERER_STATUS"}, .processes = {Process("robot", 7)}, .deputies = {}};
  heard.deputies = {Deputy("robot")};
  heard.deputies[0].pids = {7};

  EXPECT_EQ(CheckTraffic(heard, kHere)[0].state, State::kOk);
  heard.deputies[0].host = "laptop";
  EXPECT_EQ(CheckTraffic(heard, kHere)[0].state, State::kWarning) << "7 is another process there";
}

TEST(Traffic, AGraphThatNoDeputyStartedWouldBeTheFirstOfTwo) {
  const Heard heard{
      .channels = {"CLUSTERER_STATUS"}, .processes = {Process("robot", 7)}, .deputies = {}};

  const Findings findings = CheckTraffic(heard, kHere);

  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, State::kWarning);
  EXPECT_THAT(findings[0].text, HasSubstr("CLUSTERER_STATUS from process 7 on robot"));
  EXPECT_THAT(findings[0].mend, ElementsAre("sudo kill 7"));
}

TEST(Traffic, TwoGraphsAreNamedBoth) {
  Heard heard{.channels = {"CLUSTERER_STATUS"},
              .processes = {Process("laptop", 5), Process("robot", 7)},
              .deputies = {Deputy("laptop"), Deputy("robot")}};
  heard.deputies[0].pids = {5};
  heard.deputies[1].pids = {7};

  const Findings findings = CheckTraffic(heard, kHere);

  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, State::kWarning);
  EXPECT_THAT(findings[0].text,
              AllOf(HasSubstr("process 5 on laptop"), HasSubstr("process 7 on robot")));
  EXPECT_THAT(findings[0].mend, ElementsAre("sudo kill 7"));
}

TEST(Traffic, APlayerWithoutAStatusIsFoundByItsData) {
  const Heard heard{.channels = {"LIDAR_POINTS", "MINE"}, .processes = {}, .deputies = {}};

  const Findings findings = CheckTraffic(heard, kHere);

  EXPECT_EQ(findings[0].state, State::kWarning);
  EXPECT_THAT(findings[0].text, HasSubstr("LIDAR_POINTS"));
}

TEST(Traffic, OtherChannelsAreNobodysBusiness) {
  EXPECT_EQ(CheckTraffic({.channels = {"MINE"}, .processes = {}, .deputies = {}}, kHere)[0].state,
            State::kOk);
}

TEST(Config, EveryProblemIsAFinding) {
  ConfigFacts config = kConfig;
  config.problems = {"graph.xml:1: a", "graph.xml:2: b"};

  const Findings findings = CheckConfig(config);

  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[1].state, State::kProblem);
  EXPECT_EQ(findings[1].text, "graph.xml:2: b");
  EXPECT_EQ(CheckConfig({})[0].state, State::kNotChecked);
  EXPECT_EQ(CheckConfig(kConfig)[0].state, State::kOk);
}

TEST(Digests, AHostThatDiffersIsNamedWithTheCopyThatMendsIt) {
  const Heard heard{
      .channels = {}, .processes = {}, .deputies = {Deputy("laptop", "bb"), Deputy("robot")}};

  const Findings findings = CheckDigests(heard, kConfig, kHere);

  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].state, State::kProblem);
  EXPECT_THAT(findings[0].text,
              HasSubstr("deputy \"laptop\" on laptop has another configuration: "
                        "digest bb instead of aa"));
  EXPECT_THAT(findings[0].mend,
              ElementsAre("scp /etc/clearway/graph.xml root@laptop:/etc/clearway/graph.xml"));
  EXPECT_EQ(findings[1].state, State::kOk);
}

TEST(Digests, NoCommandIsMadeOfWhatIsNoHostsName) {
  for (const char* host : {"-oProxyCommand=reboot", "a;reboot", ""}) {
    Heard heard{
        .channels = {}, .processes = {Process(host, 1, "bb")}, .deputies = {Deputy("x", "bb")}};
    heard.deputies[0].host = host;

    for (const Finding& finding : CheckDigests(heard, kConfig, kHere)) {
      EXPECT_THAT(finding.mend, IsEmpty()) << host;
    }
  }
}

TEST(Digests, ThisHostsOwnDeputyGetsTheFileCopied) {
  Here here = kHere;
  here.deputy_config = "/etc/clearway/other.xml";
  const Heard heard{.channels = {}, .processes = {}, .deputies = {Deputy("robot", "bb")}};

  EXPECT_THAT(CheckDigests(heard, kConfig, here)[0].mend,
              ElementsAre("sudo cp /etc/clearway/graph.xml /etc/clearway/other.xml"));
}

TEST(Digests, WithoutAConfigurationDeputiesAreComparedWithEachOther) {
  const Heard heard{
      .channels = {}, .processes = {}, .deputies = {Deputy("a", "bb"), Deputy("b", "cc")}};

  const Findings findings = CheckDigests(heard, {}, kHere);

  EXPECT_EQ(findings[0].state, State::kOk);
  EXPECT_EQ(findings[1].state, State::kProblem);
  EXPECT_THAT(findings[1].text, HasSubstr("digest cc instead of bb"));
}

TEST(Digests, UnreadableIsAProblemAndNoneIsAWarning) {
  const Heard heard{.channels = {},
                    .processes = {},
                    .deputies = {Deputy("a", "unreadable"), Deputy("robot", "")}};

  const Findings findings = CheckDigests(heard, {}, kHere);

  EXPECT_EQ(findings[0].state, State::kProblem);
  EXPECT_THAT(findings[0].text, HasSubstr("cannot use its configuration"));
  EXPECT_EQ(findings[1].state, State::kWarning);
  EXPECT_THAT(findings[1].mend, ElementsAre("sudoedit /etc/clearway/deputy.xml"));
}

TEST(Digests, ProcessesWithAnotherOneAreWarnedOf) {
  ConfigFacts config = kConfig;
  config.effective_digest = "with-url";
  const Heard heard{.channels = {},
                    .processes = {Process("robot", 1),
                                  Process("robot", 2, "with-url"),
                                  Process("robot", 3, "old")},
                    .deputies = {}};

  const Findings findings = CheckDigests(heard, config, kHere);

  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, State::kWarning);
  EXPECT_THAT(findings[0].text, HasSubstr("process 3"));
}

TEST(Digests, WithNobodyToCompareWithAreNotChecked) {
  EXPECT_EQ(CheckDigests({}, kConfig, kHere)[0].state, State::kNotChecked);
}

TEST(Versions, ThatDifferAreProblems) {
  Heard heard{
      .channels = {}, .processes = {Process("robot", 1)}, .deputies = {Deputy("a"), Deputy("b")}};
  EXPECT_EQ(CheckVersions(heard, kHere)[0].state, State::kOk);
  heard.deputies[1].version = "0.9";
  heard.processes[0].version = "1.1";

  const Findings findings = CheckVersions(heard, kHere);

  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].state, State::kProblem);
  EXPECT_THAT(findings[0].text, HasSubstr("deputy \"b\" on b is version 0.9, this program is 1.0"));
  EXPECT_THAT(findings[1].text, HasSubstr("process 1 on robot is version 1.1"));
}

TEST(Versions, OfADeputyThatTellsNoneIsAWarning) {
  Heard heard{.channels = {}, .processes = {}, .deputies = {Deputy("a")}};
  heard.deputies[0].is_ours = false;

  EXPECT_EQ(CheckVersions(heard, kHere)[0].state, State::kWarning);
  EXPECT_EQ(CheckVersions({}, kHere)[0].state, State::kNotChecked);
}

TEST(Deputies, OfTheDeploymentThatWereNotHeardAreStarted) {
  const Heard heard{.channels = {}, .processes = {}, .deputies = {Deputy("other")}};

  const Findings findings = CheckDeputies(heard, {"laptop", "robot", "other"}, kHere);

  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].state, State::kWarning);
  EXPECT_THAT(findings[0].mend, ElementsAre("ssh laptop sudo systemctl start clearway-deputy"));
  EXPECT_THAT(findings[1].mend, ElementsAre("sudo systemctl start clearway-deputy"));
}

TEST(Deputies, SayWhatIsWrongWithThem) {
  Heard heard{.channels = {}, .processes = {}, .deputies = {Deputy("robot")}};
  heard.deputies[0].problem = "the disk is full";

  const Findings findings = CheckDeputies(heard, {"robot"}, kHere);

  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, State::kWarning);
  EXPECT_THAT(findings[0].text, HasSubstr("the disk is full"));
  heard.deputies[0].problem.clear();
  EXPECT_EQ(CheckDeputies(heard, {"robot"}, kHere)[0].state, State::kOk);
}

}  // namespace
}  // namespace clearway::doctor
