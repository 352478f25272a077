// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config.hpp"
#include "tests/unit/config/parse_problems.hpp"

namespace clearway::config {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

TEST(PrintTest, ShowsEachValueInOrderWithItsOrigin) {
  const std::vector<std::string> overrides = {"preprocessor.window_ms=50.5"};
  const auto result = Parse<sample::Root>(
      "<clearway version=\"1\">\n<preprocessor>\n<floor tilt_deg=\"10\"/></preprocessor>"
      "<sensor name='a \"b\"'/></clearway>",
      "site.xml",
      overrides);

  EXPECT_EQ(Print(result),
            "speed_mps = 1.5  # default\n"
            "preprocessor.backend = native  # default\n"
            "preprocessor.voxel_grid.leaf_m = 0.05  # default\n"
            "preprocessor.voxel_grid.min_points = 1  # default\n"
            "preprocessor.deskew = true  # default\n"
            "preprocessor.window_ms = 50.5  # --set\n"
            "preprocessor.floor.tilt_deg = 10  # site.xml:3\n"
            "preprocessor.floor.lo_m = -0.1  # default\n"
            "preprocessor.floor.hi_m = 0.1  # default\n"
            "sensor[0].name = \"a \\\"b\\\"\"  # site.xml:3\n"
            "sensor[0].x_m = 0  # default\n"
            "sensor[0].yaw_deg = 0  # default\n");
}

TEST(ToXmlTest, WritesACompleteFile) {
  EXPECT_EQ(ToXml(sample::Root{}),
            R"(<?xml version="1.0" encoding="UTF-8"?>
<clearway version="1"
          speed_mps="1.5">
  <preprocessor backend="native"
                deskew="true"
                window_ms="100">
    <voxel_grid leaf_m="0.05"
                min_points="1"/>
    <floor tilt_deg="15"
           lo_m="-0.1"
           hi_m="0.1"/>
  </preprocessor>
  <sensor name="front"
          x_m="0"
          yaw_deg="0"/>
</clearway>
)");
}

TEST(ToXmlTest, WithHelpExplainsEachAttributeByItsDefaultAndIsStillLegal) {
  sample::Root root;
  root.preprocessor.voxel_grid.leaf_m = 0.1;
  root.sensors.push_back({.name = "--", .x_m = 1.0, .yaw_rad = 0.0});

  const std::string xml = ToXml(root, {.with_help = true});

  EXPECT_THAT(xml, HasSubstr(R"(
    <!-- Thinning of the cloud.
         leaf_m: Side of a cubic cell [m]. Allowed: a number in [0.005, 2] (default 0.05)
         min_points: Least points - - a cell | voxel. Allowed: a whole number in [1, 100]
         (default 1) -->
    <voxel_grid leaf_m="0.1"
)"));
  EXPECT_EQ(Parse<sample::Root>(xml, "help.xml").root, root);
}

TEST(DigestTest, DoesNotDependOnLayoutNorOnGivenDefaults) {
  const std::string first = R"(<clearway version="1"><preprocessor deskew="false" window_ms="50"/>)"
                            R"(<sensor x_m="1" name="a"/></clearway>)";
  const std::string second = R"(
<!-- another layout -->
<clearway speed_mps="1.50" version="1">
  <sensor name="a"   x_m="1.0e0"/>
  <preprocessor window_ms="50.000" deskew="false"> <floor/> </preprocessor>
</clearway>)";

  EXPECT_EQ(Digest(Parse<sample::Root>(first, "a.xml").root),
            Digest(Parse<sample::Root>(second, "b.xml").root));
}

TEST(DigestTest, DiffersOnAnyChangeOfAValue) {
  std::vector<std::string> digests = {Digest(sample::Root{})};
  for (const char* const text : {"speed_mps=1.6",
                                 "preprocessor.backend=textbook",
                                 "preprocessor.voxel_grid.leaf_m=0.06",
                                 "preprocessor.voxel_grid.min_points=2",
                                 "preprocessor.deskew=false",
                                 "preprocessor.window_ms=100.001",
                                 "preprocessor.floor.tilt_deg=15.1",
                                 "sensor[0].name=back"}) {
    const std::vector<std::string> overrides = {text};
    digests.push_back(Digest(Parse<sample::Root>(InRoot(""), "a.xml", overrides).root));
  }
  digests.push_back(Digest(Parse<sample::Root>(InRoot("<sensor/><sensor name='b'/>"), "a").root));

  for (std::size_t i = 0; i < digests.size(); ++i) {
    EXPECT_THAT(digests[i], MatchesRegex("[0-9a-f]{16}"));
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(digests[i], digests[j]) << i << " " << j;
  }
}

struct OneNumber {
  int a = 1;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Integer("a", self.a, 0, 9, "A digit.");
  }
};

TEST(DigestTest, IsTheSameInEveryReleaseAndOnEveryMachine) {
  // FNV-1a, 64 bits, of the four bytes 'a', 0, '1', 0, computed apart from this code.
  EXPECT_EQ(Digest(OneNumber{}), "ac4d51820e249a1d");
}

TEST(ReferenceTest, HasARowForEachAttribute) {
  const std::string text = Reference(sample::Root{});

  EXPECT_THAT(text, HasSubstr(R"(
## `<preprocessor><voxel_grid>`

Thinning of the cloud.

| attribute | type and range | default | unit | meaning |
|---|---|---|---|---|
| `leaf_m` | a number in [0.005, 2] | `0.05` | m | Side of a cubic cell [m]. |
| `min_points` | a whole number in [1, 100] | `1` | - | Least points -- a cell \| voxel. |
)"));
  EXPECT_THAT(text, HasSubstr("## `<sensor> (any number)`"));
  EXPECT_THAT(text,
              HasSubstr("| `window_ms` | a number in [1, 1000] in steps of 0.001 | `100` |"
                        " ms | Time of a scan. |"));
}

}  // namespace
}  // namespace clearway::config
