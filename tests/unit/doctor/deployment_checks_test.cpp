// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/deployment_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/procman/pmd_reader.hpp"

namespace clearway::doctor {
namespace {

using core::procman::AllowList;
using core::procman::AllowRule;
using core::procman::Deployment;
using core::procman::ExecLine;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Deployment DeploymentOf(const std::vector<std::string>& execs,
                        const std::string& deputy = "robot") {
  Deployment deployment;
  deployment.file = "a.pmd";
  for (const std::string& exec : execs) {
    core::procman::DeployedCommand command;
    command.spec.id = "c" + std::to_string(deployment.commands.size());
    command.spec.exec = exec;
    command.deputy = deputy;
    command.line = 10 + static_cast<int>(deployment.commands.size());
    deployment.commands.push_back(command);
  }
  return deployment;
}

// All programs named clearway-... are there, and any file.
HostView GoodHost() {
  HostView host;
  host.variable = [](const std::string& name) {
    return name == "CLEARWAY_CONFIG" ? std::optional<std::string>("/etc/g.xml") : std::nullopt;
  };
  host.search_path = "/own:/usr/bin";
  host.find_program = [](const std::string& name) {
    return name.starts_with("clearway-") ? std::optional<std::filesystem::path>("/own/" + name)
                                         : std::nullopt;
  };
  host.read_config = [](const std::string&, bool) {
    return NamedConfig{.is_readable = true, .digest = {}, .problems = {}};
  };
  host.host_file = "/etc/clearway/deputy.xml";
  host.allowed.emplace(std::vector<AllowRule>{
      {.program = "clearway-clusterer", .arguments = "--config /etc/g.xml", .environment = ""},
      {.program = "clearway-x", .arguments = "...", .environment = "*"}});
  return host;
}

Findings CheckOne(const std::string& exec, const HostView& host = GoodHost()) {
  return CheckCommands(DeploymentOf({exec}), "robot", host);
}

constexpr char kGood[] =
    "CLEARWAY_STATUS_CHANNEL=CLUSTERER_STATUS CLEARWAY_RESTART_UNHEALTHY=5 "
    "clearway-clusterer --config ${CLEARWAY_CONFIG}";

TEST(Commands, ThatCanRunAreOneFinding) {
  const Findings findings =
      CheckCommands(DeploymentOf({kGood, "clearway-x a b"}), "robot", GoodHost());

  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, State::kOk) << findings[0].text;
  EXPECT_THAT(findings[0].text, HasSubstr("the 2 commands"));
}

TEST(Commands, OfOtherHostsAreNotLookedAt) {
  const Findings findings =
      CheckCommands(DeploymentOf({"nonsense"}, "laptop"), "robot", GoodHost());

  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, State::kWarning);
  EXPECT_THAT(findings[0].text, HasSubstr("it names laptop"));
}

TEST(Commands, AMissingProgramIsNamedWithWhereItWasLookedFor) {
  HostView host = GoodHost();
  host.allowed.emplace(
      std::vector<AllowRule>{{.program = "nope", .arguments = "", .environment = ""}});

  const Findings findings = CheckOne("nope", host);

  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, State::kProblem);
  EXPECT_EQ(findings[0].text, "a.pmd:10: \"c0\": no program \"nope\" in /own:/usr/bin");
}

TEST(Commands, ThatAreRefusedGetTheLineThatAllowsThem) {
  const Findings findings = CheckOne(
      "LCM_DEFAULT_URL=u CLEARWAY_STATUS_CHANNEL=CLUSTERER_STATUS "
      "clearway-clusterer --config ${CLEARWAY_CONFIG}");

  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, State::kProblem);
  EXPECT_THAT(findings[0].text, HasSubstr("LCM_DEFAULT_URL=u"));
  EXPECT_THAT(findings[0].mend,
              ElementsAre("# in /etc/clearway/deputy.xml, below <clearway>: "
                          "<allow program=\"clearway-clusterer\" arguments=\"--config /etc/g.xml\" "
                          "environment=\"LCM_DEFAULT_URL=u\"/>"));
}

TEST(Commands, WithoutAHostsFileAreWarnedOfOnce) {
  HostView host = GoodHost();
  host.allowed.reset();

  const Findings findings = CheckCommands(DeploymentOf({kGood, "clearway-x"}), "robot", host);

  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, State::kWarning);
  EXPECT_THAT(findings[0].text, HasSubstr("there is no /etc/clearway/deputy.xml"));
}

TEST(Commands, WithAnotherProgramsStatusWouldNeverBeReady) {
  const Findings findings =
      CheckOne("CLEARWAY_STATUS_CHANNEL=CLUSTRER_STATUS clearway-clusterer --config /etc/g.xml");

  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, State::kProblem);
  EXPECT_THAT(findings[0].mend,
              ElementsAre("# in a.pmd: CLEARWAY_STATUS_CHANNEL=CLUSTERER_STATUS"));
}

TEST(Commands, OfOthersMayHaveAStatusOfTheirOwn) {
  EXPECT_EQ(CheckOne("CLEARWAY_STATUS_CHANNEL=MINE clearway-x")[0].state, State::kWarning);
  EXPECT_EQ(CheckOne("CLEARWAY_STATUS_CHANNEL=PLAY_STATUS clearway-x")[0].state, State::kOk);
}

TEST(Commands, RestartAfterWholeSecondsOnly) {
  for (const char* seconds : {"0", "1.5", "", "86401", "5s"}) {
    const Findings findings =
        CheckOne(std::string("CLEARWAY_RESTART_UNHEALTHY=") + seconds + " clearway-x");
    EXPECT_EQ(findings[0].state, State::kProblem) << seconds;
  }
}

TEST(Commands, ProblemsOfAConfigurationAreToldOnceForAll) {
  HostView host = GoodHost();
  host.allowed.emplace(std::vector<AllowRule>{
      {.program = "clearway-clusterer", .arguments = "...", .environment = ""}});
  host.read_config = [](const std::string& file, bool is_of_graph) {
    EXPECT_TRUE(is_of_graph);
    EXPECT_EQ(file, "/etc/g.xml");
    return NamedConfig{.is_readable = true, .digest = {}, .problems = {"g.xml:1: a", "g.xml:2: b"}};
  };

  const Findings findings =
      CheckCommands(DeploymentOf({kGood, "clearway-clusterer --config=/etc/g.xml"}), "robot", host);

  ASSERT_EQ(findings.size(), 2U);
  EXPECT_THAT(findings[0].text, HasSubstr("g.xml:1: a"));
  EXPECT_THAT(findings[1].text, HasSubstr("g.xml:2: b"));
}

TEST(Commands, AMissingConfigurationIsAProblem) {
  HostView host = GoodHost();
  host.read_config = [](const std::string&, bool) { return NamedConfig{}; };

  EXPECT_THAT(CheckOne(kGood, host)[0].text, HasSubstr("--config /etc/g.xml cannot be read"));
  EXPECT_THAT(CheckOne(kGood, host)[0].mend, IsEmpty());
  host.graph_config = "config/lab.xml";
  EXPECT_THAT(CheckOne(kGood, host)[0].mend,
              ElementsAre("sudo install -D -m 644 config/lab.xml /etc/g.xml"));
}

TEST(Commands, OfOtherProgramsMayHaveConfigurationsOfAnotherKind) {
  HostView host = GoodHost();
  host.read_config = [](const std::string&, bool is_of_graph) {
    EXPECT_FALSE(is_of_graph);
    return NamedConfig{.is_readable = true, .digest = {}, .problems = {}};
  };

  EXPECT_EQ(CheckOne("clearway-x --config /etc/other.yaml", host)[0].state, State::kOk);
}

TEST(Commands, ARelativeConfigurationIsWarnedOf) {
  EXPECT_EQ(CheckOne("clearway-x --config a.xml")[0].state, State::kWarning);
}

TEST(Commands, AVariableThatIsNotSetIsNamed) {
  const Findings findings = CheckOne("clearway-x --input ${CLEARWAY_INPUT}");

  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, State::kProblem);
  EXPECT_THAT(findings[0].text, HasSubstr("CLEARWAY_INPUT is not set"));
}

TEST(Commands, ThatCannotBeReadAreProblems) {
  EXPECT_EQ(CheckOne("clearway-x 'open")[0].state, State::kProblem);
}

TEST(Sensor, IsLiveWhereADriverRunsHere) {
  const Deployment deployment =
      DeploymentOf({"clearway-clusterer", "A=b /opt/clearway-livox-driver -x"});

  EXPECT_TRUE(HasLiveSensor(deployment, "robot"));
  EXPECT_FALSE(HasLiveSensor(deployment, "laptop"));
  EXPECT_FALSE(HasLiveSensor(DeploymentOf({"echo clearway-livox-driver"}), "robot"));
}

// Whatever the words are, the rule allows them and no others.
TEST(AllowElement, AllowsExactlyTheCommand) {
  const std::vector<std::vector<std::string>> lines = {
      {"p"},
      {"p", "--config", "/etc/a b.xml"},
      {"p", "*", "?", "...", ""},
      {"p", "it's \"quoted\" \\ back", "<&>", "$HOME", "[a-z]"},
      {"p q", "a\tb"}};
  for (const auto& arguments : lines) {
    const ExecLine line{.environment = {{"A", "x *"}, {"B", ""}}, .arguments = arguments};

    const std::string element = AllowElement(line);

    const auto attribute = [&element](const std::string& name) {
      const std::size_t at = element.find(' ' + name + "=\"");
      if (at == std::string::npos) return std::string();
      const std::size_t begin = at + name.size() + 3;
      std::string text = element.substr(begin, element.find('"', begin) - begin);
      for (const auto& [from, to] : {std::pair<std::string, std::string>{"&quot;", "\""},
                                     {"&lt;", "<"},
                                     {"&#9;", "\t"},
                                     {"&amp;", "&"}}) {
        for (std::size_t i = 0; (i = text.find(from, i)) != std::string::npos; i += to.size()) {
          text.replace(i, from.size(), to);
        }
      }
      return text;
    };
    const AllowRule rule{.program = attribute("program"),
                         .arguments = attribute("arguments"),
                         .environment = attribute("environment")};
    EXPECT_THAT(rule.Validate(), IsEmpty()) << element;
    EXPECT_EQ(AllowList({rule}).WhyRefused(line), "") << element;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
      ExecLine other = line;
      other.arguments[i] += 'x';
      EXPECT_NE(AllowList({rule}).WhyRefused(other), "") << element << " argument " << i;
    }
    ExecLine other = line;
    other.environment[0].second = "x y";
    EXPECT_NE(AllowList({rule}).WhyRefused(other), "") << element;
  }
}

}  // namespace
}  // namespace clearway::doctor
