// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/labels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/io/read_error.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/io/temporary_folder.hpp"

namespace clearway::evaluate {
namespace {

using testing::AllOf;
using testing::HasSubstr;

nlohmann::json GoodBox() {
  return {{"x", 1.5},
          {"y", -2.0},
          {"z", 0.25},
          {"l", 4.0},
          {"w", 2},
          {"h", 1.5},
          {"yaw", 0.5},
          {"n", 17},
          {"cls", "Car"},
          {"truncation", 0.0}};
}

std::string WithBox(const nlohmann::json& box) {
  return nlohmann::json{{"000042", {GoodBox(), box}}}.dump();
}

class LabelsTest : public testing::Test {
 protected:
  /// What the reader says about a file with this content; empty when it reads it.
  [[nodiscard]] std::string ErrorOf(const std::string& content) const {
    return ErrorOfPath(folder_.Write("boxes.json", content));
  }

  [[nodiscard]] static std::string ErrorOfPath(const std::filesystem::path& path) {
    try {
      static_cast<void>(ReadLabels(path));
    } catch (const io::ReadError& error) {
      return error.what();
    }
    return "";
  }

  test::TemporaryFolder folder_;
};

TEST_F(LabelsTest, AFileHoldsTheBoxesOfManyScans) {
  const auto file = folder_.Write(
      "boxes.json",
      nlohmann::json{{"1.25", {GoodBox()}}, {"1.35", nlohmann::json::array()}}.dump());

  const Labels labels = ReadLabels(file);

  ASSERT_EQ(labels.size(), 2U);
  EXPECT_TRUE(labels.at("1.35").empty());
  const Box& box = labels.at("1.25").at(0);
  EXPECT_TRUE(box.T_F_box.translation().isApprox(Eigen::Vector3d(1.5, -2.0, 0.25)));
  EXPECT_NEAR(Yaw(box), 0.5, 1e-12);
  EXPECT_EQ(box.size_m, Eigen::Vector3d(4.0, 2.0, 1.5));
  EXPECT_EQ(box.kind, "Car");
  EXPECT_EQ(box.points, 17);
}

TEST_F(LabelsTest, AFolderHoldsAFileForEachScan) {
  folder_.Write("boxes/000001.json", nlohmann::json::array({GoodBox(), GoodBox()}).dump());
  folder_.Write("boxes/7.25.json", "[]");
  folder_.Write("boxes/README.md", "not a label");

  const Labels labels = ReadLabels(folder_.path() / "boxes");

  ASSERT_EQ(labels.size(), 2U);
  EXPECT_EQ(labels.at("000001").size(), 2U);
  EXPECT_TRUE(labels.at("7.25").empty());
}

struct BadField {
  const char* name;
  nlohmann::json value;
  const char* allowed;
};

class BadFieldTest : public LabelsTest, public testing::WithParamInterface<BadField> {};

TEST_P(BadFieldTest, IsRefusedWithFileKeyBoxFieldAndWhatIsAllowed) {
  nlohmann::json box = GoodBox();
  box[GetParam().name] = GetParam().value;

  EXPECT_THAT(ErrorOf(WithBox(box)),
              AllOf(HasSubstr("boxes.json"),
                    HasSubstr("000042"),
                    HasSubstr("box 1"),
                    HasSubstr("field \"" + std::string(GetParam().name) + "\""),
                    HasSubstr(GetParam().value.dump()),
                    HasSubstr(std::string("expected ") + GetParam().allowed)));
}

INSTANTIATE_TEST_SUITE_P(Fields,
                         BadFieldTest,
                         testing::Values(BadField{"x", "1.5", "a number in [-10000.0, 10000.0]"},
                                         BadField{"y", 1e300, "a number in"},
                                         BadField{"z", nullptr, "a number in"},
                                         BadField{"l", 0.0, "a number in [0.001, 1000.0]"},
                                         BadField{"w", -1, "a number in [0.001, 1000.0]"},
                                         BadField{"h", true, "a number in [0.001, 1000.0]"},
                                         BadField{"yaw", 90, "a number in [-6.28"},
                                         BadField{"n", -1, "a whole number in [0, 1000000000]"},
                                         BadField{"n", 2.5, "a whole number in"},
                                         BadField{"n", 10000000000, "a whole number in"},
                                         BadField{"cls", 3, "a text"}),
                         [](const auto& test) {
                           return std::string(test.param.name) + "_" + std::to_string(test.index);
                         });

class MissingFieldTest : public LabelsTest, public testing::WithParamInterface<const char*> {};

TEST_P(MissingFieldTest, IsRefusedWithFileKeyBoxAndField) {
  nlohmann::json box = GoodBox();
  box.erase(GetParam());

  EXPECT_THAT(ErrorOf(WithBox(box)),
              AllOf(HasSubstr("boxes.json"),
                    HasSubstr("000042"),
                    HasSubstr("box 1"),
                    HasSubstr("field \"" + std::string(GetParam()) + "\" is missing; expected a")));
}

INSTANTIATE_TEST_SUITE_P(Fields,
                         MissingFieldTest,
                         testing::Values("x", "y", "z", "l", "w", "h", "yaw", "n", "cls"),
                         [](const auto& test) { return std::string(test.param); });

TEST_F(LabelsTest, WhatIsNotJsonIsRefused) {
  EXPECT_THAT(ErrorOf("{\"a\": [1,"), AllOf(HasSubstr("boxes.json"), HasSubstr("is not JSON")));
  EXPECT_THAT(ErrorOf("{\"a\": [{\"x\": 1e999}]}"), HasSubstr("is not JSON"));
  EXPECT_THAT(ErrorOf(""), HasSubstr("boxes.json"));
  EXPECT_THAT(ErrorOf("\xff\xfe"), HasSubstr("is not JSON"));
}

TEST_F(LabelsTest, AnotherStructureIsRefused) {
  EXPECT_THAT(ErrorOf("[]"), AllOf(HasSubstr("expected one object"), HasSubstr("folder")));
  EXPECT_THAT(ErrorOf("{\"7\": {}}"), AllOf(HasSubstr("7"), HasSubstr("expected a list of boxes")));
  EXPECT_THAT(ErrorOf("{\"7\": [3]}"), AllOf(HasSubstr("box 0"), HasSubstr("expected an object")));
}

TEST_F(LabelsTest, AKeyThatStandsTwiceIsRefused) {
  EXPECT_THAT(ErrorOf("{\"7\": [], \"8\": [], \"7\": []}"),
              AllOf(HasSubstr("boxes.json"), HasSubstr("7"), HasSubstr("stands twice")));
}

TEST_F(LabelsTest, NoLabelsAtAllAreRefused) {
  std::filesystem::create_directories(folder_.path() / "empty");

  EXPECT_THAT(ErrorOf("{}"), HasSubstr("holds no labels"));
  EXPECT_THAT(ErrorOfPath(folder_.path() / "empty"), HasSubstr("holds no labels"));
  EXPECT_THAT(ErrorOfPath(folder_.path() / "absent.json"), HasSubstr("absent.json"));
}

TEST_F(LabelsTest, AFileOfManyScansInAFolderIsRefusedByName) {
  folder_.Write("boxes/boxes.json", "{\"7\": []}");

  EXPECT_THAT(ErrorOfPath(folder_.path() / "boxes"),
              AllOf(HasSubstr("boxes.json"), HasSubstr("expected a list of boxes")));
}

TEST(RealLabelsTest, AllLoad) {
  for (const char* relative : {"indoor_people/consecutive/boxes.json",
                               "indoor_people/sparse/boxes.json",
                               "kitti_tracking/boxes.json",
                               "kitti_object/boxes"}) {
    const auto path = test::TestData(relative);
    if (!path) GTEST_SKIP() << test::MissingData(relative);
    EXPECT_FALSE(ReadLabels(*path).empty()) << relative;
  }
}

}  // namespace
}  // namespace clearway::evaluate
