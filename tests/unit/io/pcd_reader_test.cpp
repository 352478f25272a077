// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/pcd_reader.hpp"

#include <cmath>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/io/pcd_maker.hpp"

namespace clearway::io {
namespace {

using test::Encode;
using test::PcdRecipe;
using test::Render;
using testing::ElementsAre;

core::PointCloud Parse(const PcdRecipe& recipe, double intensity_scale = 1.0) {
  return ParsePcd(Render(recipe), "scan.pcd", intensity_scale).cloud;
}

void ExpectTwoPoints(const core::PointCloud& cloud) {
  EXPECT_THAT(cloud.x, ElementsAre(1.0F, 4.0F));
  EXPECT_THAT(cloud.y, ElementsAre(2.0F, 5.0F));
  EXPECT_THAT(cloud.z, ElementsAre(3.0F, 6.0F));
}

std::string SixFloats() {
  std::string bytes;
  for (const double value : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0}) bytes += Encode(value, 'F', 4);
  return bytes;
}

class PcdVersionTest : public testing::TestWithParam<std::string> {};

TEST_P(PcdVersionTest, IsRead) {
  ExpectTwoPoints(Parse({.version = GetParam()}));
}

INSTANTIATE_TEST_SUITE_P(All,
                         PcdVersionTest,
                         testing::Values("",
                                         "VERSION .5",
                                         "VERSION .6",
                                         "VERSION .7",
                                         "VERSION 0.5",
                                         "VERSION 0.6",
                                         "VERSION 0.7"));

TEST(PcdReader, ReadsLineEndsOfWindows) {
  ExpectTwoPoints(Parse({.line_end = "\r\n", .body = "1 2 3\r\n4 5 6"}));
  ExpectTwoPoints(Parse({.data = "DATA binary", .line_end = "\r\n", .body = SixFloats()}));
}

TEST(PcdReader, PassesOverCommentsEmptyLinesAndTabs) {
  ExpectTwoPoints(Parse({.fields = "# a comment\n\n  FIELDS\tx  y z ",
                         .body = "# first\n\n\t1  2\t3 \n  # second\n4 5 6\n\n"}));
}

TEST(PcdReader, ReadsARowThatIsGluedToTheDataLine) {
  ExpectTwoPoints(Parse({.data = "DATA ascii1 2 3", .body = "4 5 6\n"}));
  ExpectTwoPoints(Parse({.data = "DATA ascii -7 8 9", .body = "1 2 3\n4 5 6\n"}));
}

TEST(PcdReader, DoesWithoutWhatTheFormatLetsOut) {
  ExpectTwoPoints(Parse({.count = "", .viewpoint = ""}));
  ExpectTwoPoints(Parse({.width = "", .height = ""}));
  ExpectTwoPoints(Parse({.points = ""}));
  ExpectTwoPoints(Parse({.size = "", .type = "", .count = ""}));
  ExpectTwoPoints(Parse({.fields = "COLUMNS x y z"}));
}

TEST(PcdReader, TakesPointsForTheCountWhereTheGridDiffers) {
  ExpectTwoPoints(Parse({.width = "WIDTH 0", .height = "HEIGHT 0"}));
  ExpectTwoPoints(Parse({.width = "WIDTH 7"}));
  PcdRecipe binary{.width = "WIDTH 0", .height = "HEIGHT 0", .data = "DATA binary"};
  binary.body = SixFloats();
  ExpectTwoPoints(Parse(binary));
  binary.width = "WIDTH 3";
  binary.height = "HEIGHT 1";
  ExpectTwoPoints(Parse(binary));
}

TEST(PcdReader, ReadsAnEmptyCloud) {
  for (const char* data : {"DATA ascii", "DATA binary", "DATA binary_compressed"}) {
    PcdRecipe recipe{.width = "WIDTH 0", .points = "POINTS 0", .data = data, .body = ""};
    EXPECT_EQ(Parse(recipe).size(), 0U) << data;

    recipe.line_end = "\n";
    std::string without_last_line_end = Render(recipe);
    without_last_line_end.pop_back();
    EXPECT_EQ(ParsePcd(without_last_line_end, "scan.pcd").cloud.size(), 0U) << data;
  }
}

TEST(PcdReader, ReadsAnEmptyCompressedCloudThatStatesItsSizes) {
  PcdRecipe recipe{.width = "WIDTH 0", .points = "POINTS 0", .data = "DATA binary_compressed"};
  recipe.body = std::string(8, '\0');

  EXPECT_EQ(Parse(recipe).size(), 0U);
}

TEST(PcdReader, AcceptsZeroPaddingAfterTheData) {
  const std::string padding(4000, '\0');
  ExpectTwoPoints(Parse({.body = "1 2 3\n4 5 6\n" + padding}));
  ExpectTwoPoints(Parse({.data = "DATA binary", .body = SixFloats() + padding}));
  ExpectTwoPoints(Parse({.data = "DATA binary", .body = SixFloats() + padding + "\n"}));
  std::string by_field;
  for (const double value : {1.0, 4.0, 2.0, 5.0, 3.0, 6.0}) by_field += Encode(value, 'F', 4);
  const std::string body = test::CompressedBody(test::CompressLzf(by_field), by_field.size());
  ExpectTwoPoints(Parse({.data = "DATA binary_compressed", .body = body + padding + "\r\n"}));
}

TEST(PcdReader, ReadsCompressedDataThatWereStoredUnpacked) {
  std::string by_field;
  for (const double value : {1.0, 4.0, 2.0, 5.0, 3.0, 6.0}) by_field += Encode(value, 'F', 4);

  ExpectTwoPoints(Parse(
      {.data = "DATA binary_compressed", .body = test::CompressedBody(by_field, by_field.size())}));
}

TEST(PcdReader, KeepsPointsThatAreNotFinite) {
  const core::PointCloud cloud = Parse({.body = "nan -nan NaN\ninf -inf +1e2\n"});

  ASSERT_EQ(cloud.size(), 2U);
  EXPECT_TRUE(std::isnan(cloud.x[0]) && std::isnan(cloud.y[0]) && std::isnan(cloud.z[0]));
  EXPECT_EQ(cloud.x[1], std::numeric_limits<float>::infinity());
  EXPECT_EQ(cloud.y[1], -std::numeric_limits<float>::infinity());
  EXPECT_EQ(cloud.z[1], 100.0F);
}

TEST(PcdReader, MakesCoordinatesBeyondAFloatInfinite) {
  const core::PointCloud cloud = Parse({.body = "1e300 -1e39 0\n4 5 6\n"});

  EXPECT_EQ(cloud.x[0], std::numeric_limits<float>::infinity());
  EXPECT_EQ(cloud.y[0], -std::numeric_limits<float>::infinity());
}

TEST(PcdReader, ScalesRoundsAndClampsTheIntensity) {
  PcdRecipe recipe{.fields = "FIELDS x y z intensity",
                   .size = "SIZE 4 4 4 4",
                   .type = "TYPE F F F F",
                   .count = "COUNT 1 1 1 1",
                   .width = "WIDTH 6",
                   .points = "POINTS 6",
                   .body = "0 0 0 0.5\n0 0 0 0.25\n0 0 0 -1\n0 0 0 300\n0 0 0 nan\n0 0 0 7\n"};

  EXPECT_THAT(Parse(recipe).intensity, ElementsAre(1, 0, 0, 255, 0, 7));
  EXPECT_THAT(Parse(recipe, 255.0).intensity, ElementsAre(128, 64, 0, 255, 0, 255));
}

TEST(PcdReader, TakesIntensityBeforeReflectivityAndItsFirstValue) {
  PcdRecipe recipe{.fields = "FIELDS reflectivity x y z intensity",
                   .size = "SIZE 2 4 4 4 4",
                   .type = "TYPE U F F F F",
                   .count = "COUNT 1 1 1 1 2",
                   .body = "10 1 2 3 20 30\n11 4 5 6 21 31\n"};
  EXPECT_THAT(Parse(recipe).intensity, ElementsAre(20, 21));

  recipe.fields = "FIELDS reflectivity x y z other";
  EXPECT_THAT(Parse(recipe).intensity, ElementsAre(10, 11));
  ExpectTwoPoints(Parse(recipe));
}

TEST(PcdReader, PassesOverPaddingOfNoBytes) {
  // As in recordings of Ouster sensors.
  PcdRecipe recipe{.fields = "FIELDS x y z _ ring _",
                   .size = "SIZE 4 4 4 1 2 1",
                   .type = "TYPE F F F U U U",
                   .count = "COUNT 1 1 1 0 1 2",
                   .data = "DATA binary"};
  const std::string bytes = SixFloats();
  recipe.body = bytes.substr(0, 12) + "ri__" + bytes.substr(12) + "ri__";

  ExpectTwoPoints(Parse(recipe));
}

TEST(PcdReader, LetsUnneededFieldsBeAnything) {
  PcdRecipe recipe{.fields = "FIELDS label x y z label half",
                   .size = "SIZE 8 4 4 4 1 2",
                   .type = "TYPE U F F F I F",
                   .count = "COUNT 1 1 1 1 1 1",
                   .body = "car 1 2 3 - 1e999\nman 4 5 6 ? x\n"};

  ExpectTwoPoints(Parse(recipe));
}

TEST(PcdReader, OffersViewpointAndGrid) {
  const PcdFile file = ParsePcd(
      Render({.width = "WIDTH 1", .height = "HEIGHT 2", .viewpoint = "VIEWPOINT 1 2 3 0.5 4 5 6"}),
      "scan.pcd");
  const PcdFile odd = ParsePcd(Render({.width = "WIDTH 0", .viewpoint = ""}), "scan.pcd");

  EXPECT_THAT(file.viewpoint.translation_m, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(file.viewpoint.rotation_wxyz, ElementsAre(0.5, 4.0, 5.0, 6.0));
  EXPECT_EQ(file.width, 1U);
  EXPECT_EQ(file.height, 2U);
  EXPECT_EQ(odd.viewpoint, PcdViewpoint());
  EXPECT_EQ(odd.width, 2U);
  EXPECT_EQ(odd.height, 1U);
}

}  // namespace
}  // namespace clearway::io
