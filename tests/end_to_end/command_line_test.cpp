// SPDX-License-Identifier: BSD-3-Clause
// What every program says and returns when it is asked, or asked for something that cannot be.
#include "tests/support/command_line.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/graph_listener.hpp"
#include "tests/support/live_buses.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::test {
namespace {

using testing::HasSubstr;

constexpr int kOk = 0;
constexpr int kUsage = 64;
constexpr int kFailure = 70;
constexpr int kConfig = 78;

// Problems of different kinds: a value out of bounds, one that is no number, unknown names of an
// attribute and of an element, and a rule between fields.
constexpr char kBadConfig[] = R"(<?xml version="1.0"?>
<clearway version="1">
  <buses><local ttl="1"/></buses>
  <vehicle><sensor name="front" x_m="abc"/></vehicle>
  <preprocessor><voxel_grid leaf_m="-1" laef_m="2"/></preprocessor>
  <nonsense/>
</clearway>
)";
const std::vector<std::string> kProblems{"bad.xml:3: <buses>: the local bus must have ttl",
                                         "bad.xml:4: <vehicle><sensor[0]> x_m=\"abc\"",
                                         "bad.xml:5: <preprocessor><voxel_grid> leaf_m=\"-1\"",
                                         "bad.xml:5: <preprocessor><voxel_grid> has unknown "
                                         "attribute \"laef_m\"; did you mean \"leaf_m\"?",
                                         "bad.xml:6: <clearway> has unknown element \"nonsense\""};

std::size_t NumLines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

class ProgramTest : public testing::TestWithParam<const char*> {
 protected:
  // The program with all that it requires, so that only what the test adds is wrong.
  [[nodiscard]] std::vector<std::string> Command(const std::string& config) const {
    std::vector<std::string> command{Program(GetParam()), "--config", config};
    if (GetParam() == std::string("play")) {
      command = With(command, {"--input", ShippedConfig("lab_scene.xml")});
    }
    if (GetParam() == std::string("run")) {
      command = With(command, {"--output", folder_.path() / "output"});
    }
    return command;
  }
  ProgramResult Run(const std::vector<std::string>& command) {
    return RunProgram(command, folder_.path());
  }

  TestFolder folder_;
};

TEST_P(ProgramTest, TellsAllProblemsOfABadConfigurationAndStartsNothing) {
  const std::string url = TestUrl(17400);
  GraphListener listener(url);
  const std::string bad = folder_.Write("bad.xml", kBadConfig);

  const ProgramResult result = Run(With(Command(bad), {"--lcm-url", url}));

  EXPECT_EQ(result.exit_status, kConfig);
  for (const std::string& problem : kProblems) EXPECT_THAT(result.err, HasSubstr(problem));
  EXPECT_EQ(NumLines(result.err), kProblems.size()) << result.err;
  EXPECT_EQ(result.out, "");
  listener.Await([&] { return listener.num_messages > 0; }, 300'000);
  EXPECT_EQ(listener.num_messages, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "output"));
}

TEST_P(ProgramTest, TellsTheProblemsOfOverridesToo) {
  const ProgramResult result = Run(With(Command(ShippedConfig("lab_standing.xml")),
                                        {"--set",
                                         "stop_guard.permit_rate_hz=1",
                                         "--set",
                                         "clusterer.clustering.tolerance=1",
                                         "--lcm-url",
                                         "tcpq://localhost:7700"}));

  EXPECT_EQ(result.exit_status, kConfig);
  EXPECT_THAT(result.err, HasSubstr("permit_rate_hz"));
  EXPECT_THAT(result.err, HasSubstr("did you mean \"tolerance_m\"?"));
  EXPECT_THAT(result.err, HasSubstr("tcpq://localhost:7700"));
}

TEST_P(ProgramTest, AMissingConfigurationFileIsAConfigurationError) {
  const ProgramResult result = Run(Command(folder_.path() / "nowhere.xml"));

  EXPECT_EQ(result.exit_status, kConfig);
  EXPECT_THAT(result.err, HasSubstr("nowhere.xml"));
  EXPECT_EQ(NumLines(result.err), 1U) << result.err;
}

TEST_P(ProgramTest, WrongOptionsAreUsageErrors) {
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{
           {"--no-such-option"},
           {"--log-level", "loud"},
           {"--set"},
           {"extra_word"},
           // Where a program has these, the number is refused; elsewhere the option is.
           {"--scene-seconds", "nan"},
           {"--settle", "nan"},
           {"--for", "nan"}}) {
    const ProgramResult result = Run(With(Command(ShippedConfig("lab_standing.xml")), wrong));

    EXPECT_EQ(result.exit_status, kUsage) << wrong.front();
    EXPECT_THAT(result.err, HasSubstr("--help")) << wrong.front();
    EXPECT_EQ(result.out, "");
  }
}

TEST_P(ProgramTest, EveryShippedConfigurationIsSound) {
  std::size_t num_configs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SourceFolder() / "config")) {
    if (entry.path().extension() != ".xml") continue;
    std::ifstream stream(entry.path());
    const std::string text(std::istreambuf_iterator<char>(stream), {});
    if (text.find("<scene>") != std::string::npos) continue;
    ++num_configs;

    const ProgramResult result = Run(With(Command(entry.path()), {"--check-config"}));

    EXPECT_EQ(result.exit_status, kOk) << entry.path() << ": " << result.err;
    EXPECT_EQ(result.out + result.err, "");
  }
  EXPECT_GE(num_configs, 5U);
}

TEST_P(ProgramTest, PrintsTheConfigurationInForceAndWhereItComesFrom) {
  const ProgramResult result =
      Run(With(Command(ShippedConfig("lab_standing.xml")),
               {"--print-config", "--set", "preprocessor.voxel_grid.leaf_m=0.1"}));

  EXPECT_EQ(result.exit_status, kOk) << result.err;
  EXPECT_THAT(result.out, testing::ContainsRegex("preprocessor.voxel_grid.leaf_m = 0.1 .*--set"));
  EXPECT_THAT(result.out, testing::ContainsRegex("vehicle.stationary = true .*lab_standing.xml:"));
  EXPECT_THAT(result.out, testing::ContainsRegex("stop_guard.permit_rate_hz = 50 .*default"));
}

TEST_P(ProgramTest, AnswersHelpAndVersion) {
  const ProgramResult help = Run({Program(GetParam()), "--help"});
  const ProgramResult version = Run({Program(GetParam()), "--version"});

  EXPECT_EQ(help.exit_status, kOk);
  for (const char* option : {"--config",
                             "--set",
                             "--lcm-url",
                             "--channel-prefix",
                             "--check-config",
                             "--print-config",
                             "--log-level",
                             "--version",
                             "--help"}) {
    EXPECT_THAT(help.out, HasSubstr(option));
  }
  EXPECT_EQ(version.exit_status, kOk);
  EXPECT_THAT(version.out, testing::ContainsRegex("^[0-9]+\\.[0-9]+\\.[0-9]+\n$"));
}

TEST_P(ProgramTest, WithoutANetworkOneMessageSaysWhatToDo) {
  const ProgramResult result =
      Run(With({"unshare", "--net"}, With(Command(ShippedConfig("lab_standing.xml")), {})));

  EXPECT_EQ(result.exit_status, kFailure);
  EXPECT_THAT(result.err, HasSubstr("ip route add 224.0.0.0/4 dev lo"));
}

INSTANTIATE_TEST_SUITE_P(Programs,
                         ProgramTest,
                         testing::Values("preprocessor", "clusterer", "stop-guard", "play", "run"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase(name, '-');
                           return name;
                         });

class RecordingErrorTest : public testing::Test {
 protected:
  ProgramResult Play(const std::vector<std::string>& arguments) {
    return RunProgram(With({Program("play"),
                            "--config",
                            ShippedConfig("lab_standing.xml"),
                            "--lcm-url",
                            TestUrl(17401)},
                           arguments),
                      folder_.path());
  }
  TestFolder folder_;
};

TEST_F(RecordingErrorTest, AMissingRecordingIsToldInOneLine) {
  const std::string missing = folder_.path() / "missing";

  const ProgramResult play = Play({"--input", missing});
  const ProgramResult run = RunProgram({Program("run"),
                                        "--config",
                                        ShippedConfig("lab_standing.xml"),
                                        "--output",
                                        folder_.path() / "output",
                                        "--input",
                                        missing},
                                       folder_.path());

  for (const ProgramResult& result : {play, run}) {
    EXPECT_EQ(result.exit_status, kFailure);
    EXPECT_THAT(result.err, HasSubstr(missing));
    EXPECT_THAT(result.err, HasSubstr("no such file or folder"));
    EXPECT_EQ(NumLines(result.err), 1U) << result.err;
  }
}

TEST_F(RecordingErrorTest, AFolderWithoutScansIsToldInOneLine) {
  std::filesystem::create_directories(folder_.path() / "empty");

  const ProgramResult result = Play({"--input", folder_.path() / "empty"});

  EXPECT_EQ(result.exit_status, kFailure);
  EXPECT_THAT(result.err, HasSubstr("empty"));
  EXPECT_EQ(NumLines(result.err), 1U) << result.err;
}

TEST_F(RecordingErrorTest, AScanThatCannotBeReadIsLeftOutAndTheExitStatusSaysSo) {
  const auto scans = folder_.path() / "scans";
  std::filesystem::create_directories(scans);
  const std::string point(16, '\0');
  std::ofstream(scans / "1.bin") << point << point;
  std::ofstream(scans / "2.bin") << "not a multiple of 16";
  std::ofstream(scans / "3.bin") << point;

  const ProgramResult result = Play({"--input", scans, "--to-log", folder_.path() / "some.log"});

  EXPECT_EQ(result.exit_status, kFailure);
  EXPECT_THAT(result.err, HasSubstr("2.bin"));
  EXPECT_THAT(result.err, HasSubstr("played 2 of 3 scans"));
}

TEST_F(RecordingErrorTest, AnInputWithoutAConfigurationSaysWhereThoseAre) {
  const ProgramResult result =
      RunProgram({Program("run"), "--input", folder_.path()}, folder_.path());

  EXPECT_NE(result.exit_status, kOk);
  EXPECT_THAT(result.err, HasSubstr("--config"));
  EXPECT_THAT(result.err, HasSubstr("/config"));
}

}  // namespace
}  // namespace clearway::test
