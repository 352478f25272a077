// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
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

struct BadValue {
  const char* xml;      ///< Inside the root.
  const char* problem;  ///< Behind "site.xml:1: ".
};

class BadValueTest : public testing::TestWithParam<BadValue> {};

TEST_P(BadValueTest, HasItsExactMessage) {
  const std::vector<std::string> problems = ProblemsOf(InRoot(GetParam().xml));

  EXPECT_THAT(problems, ElementsAre(std::string("site.xml:1: ") + GetParam().problem));
}

INSTANTIATE_TEST_SUITE_P(
    EachKind,
    BadValueTest,
    testing::Values(
        BadValue{R"(<preprocessor><voxel_grid leaf_m="-1"/></preprocessor>)",
                 R"(<preprocessor><voxel_grid> leaf_m="-1": expected a number in [0.005, 2])"
                 " (default 0.05)"},
        BadValue{R"(<preprocessor><voxel_grid leaf_m="1.0x"/></preprocessor>)",
                 R"(<preprocessor><voxel_grid> leaf_m="1.0x": expected a number in [0.005, 2])"
                 " (default 0.05)"},
        BadValue{R"(<preprocessor><voxel_grid min_points="2.5"/></preprocessor>)",
                 R"(<preprocessor><voxel_grid> min_points="2.5": expected a whole number in )"
                 "[1, 100] (default 1)"},
        BadValue{R"(<preprocessor><voxel_grid min_points="101"/></preprocessor>)",
                 R"(<preprocessor><voxel_grid> min_points="101": expected a whole number in )"
                 "[1, 100] (default 1)"},
        BadValue{R"(<preprocessor><floor tilt_deg="45.01"/></preprocessor>)",
                 R"(<preprocessor><floor> tilt_deg="45.01": expected a number in [0, 45])"
                 " (default 15)"},
        BadValue{R"(<preprocessor window_ms="0.0015"/>)",
                 R"(<preprocessor> window_ms="0.0015": expected a number in [1, 1000] in steps)"
                 " of 0.001 (default 100)"},
        BadValue{R"(<preprocessor window_ms="1000.001"/>)",
                 R"(<preprocessor> window_ms="1000.001": expected a number in [1, 1000] in steps)"
                 " of 0.001 (default 100)"},
        BadValue{R"(<preprocessor deskew="yes"/>)",
                 R"(<preprocessor> deskew="yes": expected true or false (default true))"},
        BadValue{R"(<preprocessor backend="pcl"/>)",
                 R"(<preprocessor> backend="pcl": expected one of native, textbook)"
                 " (default native)"},
        BadValue{R"(<sensor name="a&#10;b"/>)",
                 R"(<sensor[0]> name="a\x0ab": expected text without control characters)"
                 R"( (default "front"))"}));

TEST(UnknownNameTest, OfAnAttributeIsToldWithTheNearestAndTheKnownOnes) {
  EXPECT_THAT(ProblemsOf(InRoot(R"(<preprocessor><voxel_grid leafm="1"/></preprocessor>)")),
              ElementsAre(R"(site.xml:1: <preprocessor><voxel_grid> has unknown attribute "leafm";)"
                          R"( did you mean "leaf_m"? known: leaf_m min_points)"));
}

TEST(UnknownNameTest, OfAnElementIsToldWithTheNearestAndTheKnownOnes) {
  EXPECT_THAT(ProblemsOf(InRoot("<preprocessr/>")),
              ElementsAre(R"(site.xml:1: <clearway> has unknown element "preprocessr";)"
                          R"( did you mean "preprocessor"? known: preprocessor sensor)"));
}

TEST(UnknownNameTest, WithoutANearNameOnlyListsTheKnownOnes) {
  EXPECT_THAT(ProblemsOf(InRoot("<sensor><banana/></sensor>")),
              ElementsAre(R"(site.xml:1: <sensor[0]> has unknown element "banana"; known: none)"));
}

TEST(ProblemsTest, OfOneFileAreToldTogetherInTheOrderOfItsLines) {
  const std::string xml = R"(<?xml version="1.0"?>
<clearway version="2" spede_mps="1">
  <sensor x_m="11"/>
  <preprocessor deskew="1">
    loose
    <voxel_grid leaf_m="nan"
                min_points=""/>
    <voxel_grid/>
  </preprocessor>
  <stop_guard/>
</clearway>)";

  EXPECT_THAT(
      ProblemsOf(xml),
      ElementsAre(
          R"(site.xml:2: <clearway> version="2": expected "1")",
          R"(site.xml:2: <clearway> has unknown attribute "spede_mps"; did you mean "speed_mps"?)"
          " known: speed_mps",
          R"(site.xml:3: <sensor[0]> x_m="11": expected a number in [-10, 10] (default 0))",
          R"(site.xml:4: <preprocessor> deskew="1": expected true or false (default true))",
          R"(site.xml:5: <preprocessor> contains "loose": expected only elements and comments;)"
          " values are attributes",
          R"(site.xml:6: <preprocessor><voxel_grid> leaf_m="nan": expected a number in [0.005, 2])"
          " (default 0.05)",
          R"(site.xml:7: <preprocessor><voxel_grid> min_points="": expected a whole number in )"
          "[1, 100] (default 1)",
          "site.xml:8: <preprocessor> has <voxel_grid> again: expected at most one, the first is"
          " at line 6",
          R"(site.xml:10: <clearway> has unknown element "stop_guard"; known: preprocessor sensor)"));
}

TEST(ConfigErrorTest, SaysAllProblemsLineByLine) {
  const ConfigError error({"one", "two"});

  EXPECT_STREQ(error.what(), "one\ntwo");
}

TEST(RulesTest, AreToldWithTheLineOfTheElement) {
  EXPECT_THAT(ProblemsOf("<clearway version=\"1\">\n<preprocessor>\n<floor lo_m=\"0.5\"/>"
                         "</preprocessor></clearway>"),
              ElementsAre("site.xml:3: <preprocessor><floor>: lo_m must be below hi_m"));
}

TEST(RulesTest, OfAnElementThatTheFileLacksAreToldAsDefault) {
  EXPECT_THAT(ProblemsOf(InRoot(""), {"preprocessor.floor.lo_m=0.5"}),
              ElementsAre("site.xml:default: <preprocessor><floor>: lo_m must be below hi_m"));
}

TEST(RulesTest, HoldAtTheRootAndOverListItems) {
  EXPECT_THAT(ProblemsOf(InRoot("<sensor/><sensor/>")),
              ElementsAre("site.xml:1: <clearway>: two neighbouring sensors have the name front"));
}

TEST(RulesTest, AreNotJudgedOnRefusedValuesButAreElsewhere) {
  // lo_m = 0.5 breaks the rule only with the default of the refused hi_m.
  EXPECT_THAT(
      ProblemsOf(InRoot(R"(<preprocessor><floor lo_m="0.5" hi_m="x"/></preprocessor>)")),
      ElementsAre(R"(site.xml:1: <preprocessor><floor> hi_m="x": expected a number in [-1, 1])"
                  " (default 0.1)"));
  EXPECT_THAT(ProblemsOf(InRoot(R"(<preprocessor><floor lo_m="0.5"/><voxel_grid x=""/>)"
                                "</preprocessor>"))
                  .size(),
              2U);
}

/// A default outside the bounds stands for "must be given".
struct RequiredRoot {
  double wheel_m = std::numeric_limits<double>::quiet_NaN();

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("wheel_m", self.wheel_m, 0.01, 1.0, "Radius of a wheel.");
  }
};

TEST(RequiredValueTest, IsAskedForWhenMissing) {
  EXPECT_THAT(ProblemsOf<RequiredRoot>("<clearway version=\"1\"/>"),
              ElementsAre("site.xml:1: <clearway> needs the attribute wheel_m: expected a number in"
                          " [0.01, 1] (no default)"));
}

TEST(RequiredValueTest, IsToldOnceWhenBadAndNotAtAllWhenGiven) {
  EXPECT_THAT(ProblemsOf<RequiredRoot>(R"(<clearway version="1" wheel_m="2"/>)"),
              ElementsAre(R"(site.xml:1: <clearway> wheel_m="2": expected a number in [0.01, 1])"
                          " (no default)"));
  EXPECT_THAT(ProblemsOf<RequiredRoot>(R"(<clearway version="1" wheel_m="0.2"/>)"), IsEmpty());
  EXPECT_THAT(ProblemsOf<RequiredRoot>(R"(<clearway version="1"/>)", {"wheel_m=0.2"}), IsEmpty());
}

}  // namespace
}  // namespace clearway::config
