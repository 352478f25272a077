// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/report.hpp"

#include <numbers>

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
  evaluation.map_filter = {
      .scans = 2,
      .scans_incomplete = 5,
      .scans_not_filtered = 6,
      .scans_missing_removed = 7,
      .counts = {.statics = {80, 60}, .statics_in_band = {64, 60}, .objects = {10, 1}},
      .pose_error = PoseDifference{.distance_m = 0.5, .turn_rad = std::numbers::pi / 4.0}};
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

TEST(JsonReportTest, TheMapFilterIsAListWithOneEntry) {
  const auto json = nlohmann::json::parse(FormatJson(FullEvaluation()));

  EXPECT_EQ(json.at("map_filter"), nlohmann::json::parse(R"([{
      "pose_error_m": 0.5, "pose_error_deg": 45.0, "removal": 0.75, "removal_in_band": 0.9375,
      "leak": 0.25, "leaked_per_scan": 10.0, "swallow": 0.1, "scans": 2, "scans_incomplete": 5,
      "scans_not_filtered": 6, "scans_missing_removed_points": 7, "objects": 3, "found": 2,
      "centre_error_m": 0.25, "detections_per_scan": 1.5}])"));
}

TEST(JsonReportTest, WhatTheMapFilterWasNotMeasuredByIsAbsent) {
  Evaluation evaluation;
  evaluation.map_filter = MapFilterSummary{.scans_not_filtered = 3};
  EXPECT_FALSE(nlohmann::json::parse(FormatJson(evaluation)).contains("map_filter"));

  evaluation.map_filter->scans = 1;
  const auto json = nlohmann::json::parse(FormatJson(evaluation)).at("map_filter").at(0);

  for (const char* name : {"pose_error_m",
                           "pose_error_deg",
                           "removal",
                           "removal_in_band",
                           "leak",
                           "swallow",
                           "found",
                           "centre_error_m"}) {
    EXPECT_FALSE(json.contains(name)) << name;
  }
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
  EXPECT_THAT(table, HasSubstr("static points removed                  60 of 80 (75.0 %)"));
  EXPECT_THAT(table, HasSubstr("object points swallowed                 1 of 10 (10.0 %)"));
  EXPECT_THAT(table, HasSubstr("scans missing REMOVED_POINTS            7"));
  EXPECT_THAT(FormatTable({}), Not(HasSubstr("error")));
  EXPECT_THAT(FormatTable({}), Not(HasSubstr("map filter")));
}

}  // namespace
}  // namespace clearway::evaluate
