// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace clearway::evaluate {
namespace {

using testing::HasSubstr;
using testing::Not;

Evaluation FullEvaluation() {
  Evaluation evaluation;
  evaluation.scans_missing_slices = 4;
  Summary& summary = evaluation.summary;
  summary.recall = {{.min_m = 2.0, .max_m = 5.0, .objects = 3, .any_evidence = 2, .separated = 1}};
  summary.scans = 2;
  summary.objects = 3;
  summary.within_radius = 2;
  summary.detections_per_scan = 1.5;
  summary.splits = 0;
  summary.merges = 1;
  summary.centre_error_m = 0.25;
  summary.centre_error_p99_m = 0.5;
  summary.nearest_error_m = 0.125;
  summary.yaw_error_deg = 3.0;
  return evaluation;
}

TEST(JsonReportTest, HasTheStableNames) {
  const auto json = nlohmann::json::parse(FormatJson(FullEvaluation()));

  EXPECT_EQ(
      json.at("recall"),
      nlohmann::json::parse(
          R"([{"min_m": 2.0, "max_m": 5.0, "objects": 3, "any_evidence": 2, "separated": 1}])"));
  EXPECT_EQ(json.at("within_radius"),
            nlohmann::json::parse(R"({"radius_m": 0.3, "objects": 3, "found": 2})"));
  EXPECT_EQ(json.at("centre_error_m"), 0.25);
  EXPECT_EQ(json.at("centre_error_p99_m"), 0.5);
  EXPECT_EQ(json.at("nearest_error_m"), 0.125);
  EXPECT_EQ(json.at("yaw_error_deg"), 3.0);
  EXPECT_EQ(json.at("splits"), 0);
  EXPECT_EQ(json.at("merges"), 1);
  EXPECT_EQ(json.at("scans"), 2);
  EXPECT_EQ(json.at("detections_per_scan"), 1.5);
  EXPECT_EQ(json.at("scans_missing_slices"), 4);
}

TEST(JsonReportTest, WhatWasNotMeasuredIsAbsent) {
  Evaluation evaluation;
  evaluation.summary.scans = 1;

  const auto json = nlohmann::json::parse(FormatJson(evaluation));

  for (const char* name : {"recall",
                           "within_radius",
                           "centre_error_m",
                           "centre_error_p99_m",
                           "nearest_error_m",
                           "yaw_error_deg",
                           "splits",
                           "merges",
                           "detections_per_scan",
                           "false_per_scan",
                           "floor",
                           "map_filter"}) {
    EXPECT_FALSE(json.contains(name)) << name;
  }
}

TEST(TableReportTest, ShowsWhatWasMeasuredAndWhatWasLeftOut) {
  const std::string table = FormatTable(FullEvaluation());

  EXPECT_THAT(table, HasSubstr("found within 0.30 m                     2 of 3 (66.7 %)"));
  EXPECT_THAT(table, HasSubstr("scans with missing slices               4"));
  EXPECT_THAT(FormatTable({}), Not(HasSubstr("error")));
}

}  // namespace
}  // namespace clearway::evaluate
