// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/map/map_yaml.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/io/map/refusal.hpp"

namespace clearway::io {
namespace {

using test::RefusalOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

using Lines = std::vector<std::pair<std::string, std::string>>;

Lines GoodLines() {
  return {{"image", "a.pgm"},
          {"resolution", "0.05"},
          {"origin", "[-1.5, 2, 0.1]"},
          {"negate", "0"},
          {"occupied_thresh", "0.65"},
          {"free_thresh", "0.196"},
          {"mode", "scale"}};
}

std::string Join(const Lines& lines) {
  std::string text;
  for (const auto& [key, value] : lines) text += key + ": " + value + "\n";
  return text;
}

// The good file with one value changed.
std::string With(const std::string& key, const std::string& value) {
  Lines lines = GoodLines();
  for (auto& line : lines) {
    if (line.first == key) line.second = value;
  }
  return Join(lines);
}

std::string Refusal(const std::string& text) {
  return RefusalOf([&] { return ParseMapYaml(text, "m.yaml"); });
}

TEST(MapYaml, ReadsEveryKey) {
  const MapDescription map = ParseMapYaml(Join(GoodLines()), "m.yaml");

  EXPECT_EQ(map.image, "a.pgm");
  EXPECT_EQ(map.image_line, 1U);
  EXPECT_EQ(map.resolution_m, 0.05);
  EXPECT_THAT(map.origin, ElementsAre(-1.5, 2.0, 0.1));
  EXPECT_FALSE(map.negate);
  EXPECT_EQ(map.occupied_threshold, 0.65);
  EXPECT_EQ(map.free_threshold, 0.196);
  EXPECT_EQ(map.mode, MapMode::kScale);
  EXPECT_THAT(map.ignored_keys, IsEmpty());
}

TEST(MapYaml, WithoutAModeAMapIsTrinary) {
  Lines lines = GoodLines();
  lines.pop_back();

  EXPECT_EQ(ParseMapYaml(Join(lines), "m.yaml").mode, MapMode::kTrinary);
}

TEST(MapYaml, ReadsWhatNav2Reads) {
  EXPECT_TRUE(ParseMapYaml(With("negate", "1"), "m").negate);
  EXPECT_TRUE(ParseMapYaml(With("negate", "true"), "m").negate);
  EXPECT_FALSE(ParseMapYaml(With("negate", "False"), "m").negate);
  EXPECT_EQ(ParseMapYaml(With("mode", "\"Raw\""), "m").mode, MapMode::kRaw);
  EXPECT_EQ(ParseMapYaml(With("resolution", "\"1e-1\""), "m").resolution_m, 0.1);
  EXPECT_EQ(ParseMapYaml(With("resolution", "0.0522 # [m/pix]"), "m").resolution_m, 0.0522);
  EXPECT_THAT(ParseMapYaml(With("origin", "\n  - 1.\n  - -2.\n  - +.5"), "m").origin,
              ElementsAre(1.0, -2.0, 0.5));
  EXPECT_EQ(ParseMapYaml(With("image", "\"a # b: c.png\""), "m").image, "a # b: c.png");
  EXPECT_EQ(ParseMapYaml("{image: a, resolution: 1, origin: [0,0,0], negate: 0, "
                         "occupied_thresh: 1, free_thresh: 0}",
                         "m")
                .occupied_threshold,
            1.0);
}

TEST(MapYaml, ThresholdsMayBeEqual) {
  Lines lines = GoodLines();
  lines[4].second = lines[5].second = "0.5";

  const MapDescription map = ParseMapYaml(Join(lines), "m.yaml");

  EXPECT_EQ(map.occupied_threshold, map.free_threshold);
}

TEST(MapYaml, NotesKeysThatItDoesNotKnow) {
  const MapDescription map =
      ParseMapYaml("cost: {a: [1, 2]}\n" + Join(GoodLines()) + "Resolution: 3\n", "m.yaml");

  EXPECT_THAT(map.ignored_keys, ElementsAre("cost", "Resolution"));
}

struct BadValue {
  std::string key;
  std::string value;
  std::string message;
};

TEST(MapYaml, SaysWhereAValueIsWrongAndWhatIsAllowed) {
  const std::string resolution = ": expected a number above 0";
  const std::string share = ": expected a number from 0 to 1";
  const std::string origin = ": expected a list of 3 numbers: x [m], y [m], yaw [rad]";
  const std::string negate = ": expected 0, 1, true or false";
  const std::string mode = ": expected trinary, scale or raw";
  const std::string image = ": expected the name of an image";
  const std::vector<BadValue> cases = {
      {"image", "", "m.yaml:1: image (nothing)" + image},
      {"image", "\"\"", "m.yaml:1: image \"\"" + image},
      {"image", "[a, b]", "m.yaml:1: image (a list of 2)" + image},
      {"image", "\"a\\nb\"", "m.yaml:1: image \"a\\x0ab\"" + image},
      {"resolution", "0", "m.yaml:2: resolution \"0\"" + resolution},
      {"resolution", "-0.05", "m.yaml:2: resolution \"-0.05\"" + resolution},
      {"resolution", ".nan", "m.yaml:2: resolution \".nan\"" + resolution},
      {"resolution", "nan", "m.yaml:2: resolution \"nan\"" + resolution},
      {"resolution", ".inf", "m.yaml:2: resolution \".inf\"" + resolution},
      {"resolution", "inf", "m.yaml:2: resolution \"inf\"" + resolution},
      {"resolution", "1e999", "m.yaml:2: resolution \"1e999\"" + resolution},
      {"resolution", "0,05", "m.yaml:2: resolution \"0,05\"" + resolution},
      {"resolution", "{a: 1}", "m.yaml:2: resolution (a map)" + resolution},
      {"origin", "[0, 0]", "m.yaml:3: origin (a list of 2)" + origin},
      {"origin", "[0, 0, 0, 0]", "m.yaml:3: origin (a list of 4)" + origin},
      {"origin", "0 0 0", "m.yaml:3: origin \"0 0 0\"" + origin},
      {"origin", "[0, x, 0]", "m.yaml:3: origin, number 2, \"x\"" + origin},
      {"origin", "[0, 0, .inf]", "m.yaml:3: origin, number 3, \".inf\"" + origin},
      {"origin", "[[1], 0, 0]", "m.yaml:3: origin, number 1, (a list of 1)" + origin},
      {"negate", "2", "m.yaml:4: negate \"2\"" + negate},
      {"negate", "maybe", "m.yaml:4: negate \"maybe\"" + negate},
      {"negate", "[]", "m.yaml:4: negate (a list of 0)" + negate},
      {"occupied_thresh", "1.5", "m.yaml:5: occupied_thresh \"1.5\"" + share},
      {"occupied_thresh", "65%", "m.yaml:5: occupied_thresh \"65%\"" + share},
      {"free_thresh", "-0.1", "m.yaml:6: free_thresh \"-0.1\"" + share},
      {"free_thresh",
       "0.7",
       "m.yaml:6: free_thresh \"0.7\": expected at most occupied_thresh, which is \"0.65\""},
      {"mode", "binary", "m.yaml:7: mode \"binary\"" + mode},
      {"mode", "", "m.yaml:7: mode (nothing)" + mode},
  };
  for (const BadValue& bad : cases) {
    EXPECT_EQ(Refusal(With(bad.key, bad.value)), bad.message);
  }
}

TEST(MapYaml, NamesEveryKeyThatIsMissing) {
  EXPECT_EQ(Refusal("{}"),
            "m.yaml: key \"image\" is missing: expected the name of an image\n"
            "m.yaml: key \"resolution\" is missing: expected a number above 0\n"
            "m.yaml: key \"origin\" is missing: expected a list of 3 numbers: x [m], y [m], yaw "
            "[rad]\n"
            "m.yaml: key \"negate\" is missing: expected 0, 1, true or false\n"
            "m.yaml: key \"occupied_thresh\" is missing: expected a number from 0 to 1\n"
            "m.yaml: key \"free_thresh\" is missing: expected a number from 0 to 1");
}

TEST(MapYaml, ReportsAllProblemsAtOnce) {
  Lines lines = GoodLines();
  lines[1].second = "-1";
  lines[3].second = "x";
  lines.emplace_back("image", "b.pgm");

  EXPECT_EQ(Refusal(Join(lines)),
            "m.yaml:8: key \"image\" is there already in line 1: expected it once\n"
            "m.yaml:2: resolution \"-1\": expected a number above 0\n"
            "m.yaml:4: negate \"x\": expected 0, 1, true or false");
}

TEST(MapYaml, RefusesWhatIsNoMapOfKeysAndValues) {
  const std::string allowed = ": expected a map of keys and values";
  EXPECT_EQ(Refusal(""), "m.yaml:1: the document is (nothing)" + allowed);
  EXPECT_EQ(Refusal("hello"), "m.yaml:1: the document is \"hello\"" + allowed);
  EXPECT_EQ(Refusal("\n- 1\n- 2\n"), "m.yaml:2: the document is (a list of 2)" + allowed);
  EXPECT_THAT(Refusal("image: [1, 2\n"), StartsWith("m.yaml:2: is not YAML: "));
  EXPECT_THAT(Refusal("image: *nowhere\n"), StartsWith("m.yaml:1: is not YAML: "));
  EXPECT_THAT(Refusal("\xff\xfe\x01\x02\x80"), StartsWith("m.yaml:"));
  EXPECT_THAT(Refusal("? [a, b]\n: c\n"),
              StartsWith("m.yaml:1: key (a list of 2): expected a word\n"));
}

TEST(MapYaml, DeepNestingIsRefusedWithoutHarm) {
  for (const char* opening : {"[", "{", "- ", "? ", "{a: ", "!!x "}) {
    std::string text;
    while (text.size() + 10 < kMaxMapYamlBytes) text += opening;
    EXPECT_THAT(Refusal(text), StartsWith("m.yaml:")) << opening;
  }
}

TEST(MapYaml, RefusesALongFile) {
  EXPECT_EQ(Refusal(std::string(kMaxMapYamlBytes + 1, '#')),
            "m.yaml: has 65537 bytes: expected the YAML file of a map, at most 65536");
}

}  // namespace
}  // namespace clearway::io
