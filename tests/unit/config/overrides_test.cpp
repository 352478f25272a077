// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config.hpp"
#include "tests/unit/config/parse_problems.hpp"

namespace clearway::config {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

sample::Root ParseWith(const std::string& xml, const std::vector<std::string>& overrides) {
  return Parse<sample::Root>(xml, "site.xml", overrides).root;
}

TEST(OverridesTest, ReachRootNestedElementsAndListItems) {
  const sample::Root root = ParseWith(InRoot("<sensor/><sensor name=\"back\"/>"),
                                      {"speed_mps=2",
                                       "preprocessor.voxel_grid.leaf_m = 0.1 ",
                                       "preprocessor.backend=textbook",
                                       "sensor[1].x_m=-1.5"});

  EXPECT_EQ(root.speed_mps, 2.0);
  EXPECT_EQ(root.preprocessor.voxel_grid.leaf_m, 0.1);
  EXPECT_EQ(root.preprocessor.backend, sample::Backend::kTextbook);
  EXPECT_EQ(root.sensors.at(0).x_m, 0.0);
  EXPECT_EQ(root.sensors.at(1).x_m, -1.5);
}

TEST(OverridesTest, ReachTheDefaultItemsOfAList) {
  EXPECT_EQ(ParseWith(InRoot(""), {"sensor[0].x_m=1"}).sensors.at(0).x_m, 1.0);
}

TEST(OverridesTest, BeatTheFileAndTheLastOneWins) {
  EXPECT_EQ(ParseWith(R"(<clearway version="1" speed_mps="1"/>)", {"speed_mps=2", "speed_mps=3"})
                .speed_mps,
            3.0);
}

TEST(OverridesTest, TakeTextPlainOrInQuotes) {
  EXPECT_EQ(ParseWith(InRoot(""), {"sensor[0].name=a=b"}).sensors.at(0).name, "a=b");
  EXPECT_EQ(ParseWith(InRoot(""), {R"(sensor[0].name=" a \"b\" ")"}).sensors.at(0).name,
            " a \"b\" ");
  EXPECT_EQ(ParseWith(InRoot(""), {"sensor[0].name="}).sensors.at(0).name, "");
}

TEST(OverridesTest, MendABadValueOfTheFile) {
  EXPECT_THAT(ProblemsOf(R"(<clearway version="1" speed_mps="fast"/>)", {"speed_mps=2"}),
              IsEmpty());
}

TEST(OverridesTest, MendABrokenRuleOfTheFile) {
  EXPECT_THAT(ProblemsOf(InRoot(R"(<preprocessor><floor lo_m="0.5"/></preprocessor>)"),
                         {"preprocessor.floor.hi_m=0.6"}),
              IsEmpty());
}

TEST(OverridesTest, MendOnlyTheirOwnValue) {
  EXPECT_THAT(
      ProblemsOf(InRoot(R"(<sensor x_m="a"/><sensor name="b" x_m="c"/>)"), {"sensor[0].x_m=1"}),
      ElementsAre(R"(site.xml:1: <sensor[1]> x_m="c": expected a number in [-10, 10])"
                  " (default 0)"));
}

struct BadOverride {
  const char* text;
  const char* problem;  ///< Behind "--set <text>: ".
};

class BadOverrideTest : public testing::TestWithParam<BadOverride> {};

TEST_P(BadOverrideTest, HasItsExactMessage) {
  EXPECT_THAT(ProblemsOf(InRoot("<sensor/>"), {GetParam().text}),
              ElementsAre(std::string("--set ") + GetParam().text + ": " + GetParam().problem));
}

INSTANTIATE_TEST_SUITE_P(
    EachKind,
    BadOverrideTest,
    testing::Values(
        BadOverride{"preprocessor.voxel_grid.leaf_m=-1",
                    "expected a number in [0.005, 2] (default 0.05)"},
        BadOverride{"preprocessor.voxel_grid.leaf_m", "expected element.attribute=value"},
        BadOverride{"preprocessor.voxelgrid.leaf_m=1",
                    R"(<preprocessor> has unknown element "voxelgrid"; did you mean "voxel_grid"?)"
                    " known: voxel_grid floor"},
        BadOverride{"preprocessor.voxel_grid.leaf=1",
                    R"(<preprocessor><voxel_grid> has unknown attribute "leaf"; did you mean)"
                    R"( "leaf_m"? known: leaf_m min_points)"},
        BadOverride{"=1", R"(<clearway> has unknown attribute ""; known: speed_mps)"},
        BadOverride{"version=1", R"(<clearway> has unknown attribute "version"; known: speed_mps)"},
        BadOverride{"sensor.x_m=1", "<sensor> is a list: write sensor[0] for its first element"},
        BadOverride{"sensor[1].x_m=1", "there is no sensor[1]: number of <sensor> elements is 1"},
        BadOverride{"sensor[-1].x_m=1",
                    R"(<clearway> has unknown element "sensor[-1]"; did you mean "sensor"?)"
                    " known: preprocessor sensor"},
        BadOverride{"preprocessor[0].deskew=true",
                    "<preprocessor> is not a list: write it without an index"},
        BadOverride{"sensor[0].name=\"a",
                    R"(expected text without control characters (default "front"))"}));

TEST(OverridesTest, StandBehindTheProblemsOfTheFile) {
  EXPECT_THAT(ProblemsOf(R"(<clearway version="1" speed_mps="fast"/>)", {"a=1"}),
              ElementsAre(R"(site.xml:1: <clearway> speed_mps="fast": expected a number in [0, 5])"
                          " (default 1.5)",
                          R"(--set a=1: <clearway> has unknown attribute "a"; known: speed_mps)"));
}

}  // namespace
}  // namespace clearway::config
