// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/options.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_data.hpp"

namespace clearway::graph {
namespace {

using testing::HasSubstr;

Options DefaultFile() {
  Options options;
  options.config_path = test::SourceFolder() / "config" / "default.xml";
  return options;
}

TEST(LoadConfigTest, TheUrlOfTheCommandLineIsThatOfBothBuses) {
  Options options = DefaultFile();
  options.lcm_url = "udpm://239.255.76.68:7700";

  const GraphConfig config = LoadConfig(options).root;

  EXPECT_EQ(config.buses.local.url, "udpm://239.255.76.68:7700");
  EXPECT_EQ(config.buses.shared.url, "udpm://239.255.76.68:7700");
}

TEST(LoadConfigTest, WithoutAUrlTheFileHasTheWord) {
  const GraphConfig config = LoadConfig(DefaultFile()).root;

  EXPECT_EQ(config.buses.local.url, process::BusConfig{}.url);
}

TEST(LoadConfigTest, TheUrlWinsOverASetOfTheSameValue) {
  Options options = DefaultFile();
  options.overrides = {"buses.local.url=udpm://239.255.76.67:7001",
                       "buses.shared.url=udpm://239.255.76.67:7001"};
  options.lcm_url = "udpm://239.255.76.67:7002";

  const GraphConfig config = LoadConfig(options).root;

  EXPECT_EQ(config.buses.local.url, options.lcm_url);
  EXPECT_EQ(config.buses.shared.url, options.lcm_url);
}

TEST(LoadConfigTest, SetChangesOneValueAndItsOrigin) {
  Options options = DefaultFile();
  options.overrides = {"preprocessor.voxel_grid.leaf_m=0.125"};

  const auto loaded = LoadConfig(options);

  EXPECT_EQ(loaded.root.preprocessor.voxel_grid.leaf_m, 0.125);
  EXPECT_THAT(config::Print(loaded), HasSubstr("preprocessor.voxel_grid.leaf_m = 0.125  # --set"));
}

TEST(LoadConfigTest, AllProblemsOfFileAndCommandLineAreToldAtOnce) {
  Options options = DefaultFile();
  options.overrides = {"preprocessor.voxel_grid.leaf_m=-1", "no.such=1"};

  try {
    (void)LoadConfig(options);
    FAIL() << "loaded";
  } catch (const config::ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("leaf_m"));
    EXPECT_THAT(error.what(), HasSubstr("no"));
  }
}

TEST(LoadConfigTest, AMissingFileIsAConfigErrorThatNamesIt) {
  Options options;
  options.config_path = "/no/such/site.xml";

  try {
    (void)LoadConfig(options);
    FAIL() << "loaded";
  } catch (const config::ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/no/such/site.xml"));
  }
}

// A program with the common options whose body does what the test says.
int RunProgram(std::vector<std::string> arguments, const std::function<int(const Options&)>& body) {
  arguments.insert(arguments.begin(), "clearway-test");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  CLI::App app("A test", "clearway-test");
  Options options;
  AddOptions(app, options);
  return GuardedMain(
      app, options, static_cast<int>(argv.size()), argv.data(), [&] { return body(options); });
}

TEST(GuardedMainTest, TheOptionsReachTheBodyAndItsStatusComesBack) {
  const int status =
      RunProgram({"--config", "a.xml", "--set", "a=1", "--set", "b=2", "--channel-prefix", "X_"},
                 [](const Options& options) {
                   EXPECT_EQ(options.config_path, "a.xml");
                   EXPECT_EQ(options.overrides, (std::vector<std::string>{"a=1", "b=2"}));
                   EXPECT_EQ(options.channel_prefix, "X_");
                   EXPECT_FALSE(options.check_config);
                   return 5;
                 });

  EXPECT_EQ(status, 5);
}

TEST(GuardedMainTest, EachKindOfTroubleHasItsExitStatus) {
  const auto good = [](const Options&) { return kExitOk; };

  EXPECT_EQ(RunProgram({"--help"}, good), kExitOk);
  EXPECT_EQ(RunProgram({"--version"}, good), kExitOk);
  EXPECT_EQ(RunProgram({}, good), kExitUsage) << "--config is required";
  EXPECT_EQ(RunProgram({"--config", "a.xml", "--no-such"}, good), kExitUsage);
  EXPECT_EQ(RunProgram({"--config", "/no/such.xml"},
                       [](const Options& options) {
                         (void)LoadConfig(options);
                         return kExitOk;
                       }),
            kExitConfig);
  EXPECT_EQ(RunProgram({"--config", "a.xml"},
                       [](const Options&) -> int { throw std::runtime_error("broken"); }),
            kExitFailure);
}

}  // namespace
}  // namespace clearway::graph
