// SPDX-License-Identifier: BSD-3-Clause
#include "tools/run_graph/report.hpp"

#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace clearway::run_graph {
namespace {

using testing::HasSubstr;
using testing::Not;

RunSummary FullSummary() {
  RunSummary summary;
  summary.scans_played = 10;
  summary.scans_detected = 9;
  summary.scans_incomplete = 1;
  summary.messages_lost = 3;
  summary.stages["preprocessor"] = {10, Quantiles{1.5, 2.5}};
  summary.stages["clusterer"] = {9, Quantiles{0.5, 0.75}};
  summary.stages["stop_guard"] = {10, Quantiles{0.125, 0.25}};
  summary.points_in = 1000.0;
  summary.points_voxel = 500.0;
  summary.points_floor = 100.0;
  summary.points_map = 50.0;
  summary.detections = 4.5;
  summary.scan_to_detections_ms = Quantiles{20.0, 30.0};
  summary.slice_to_permit_ms = Quantiles{1.0, 2.0};
  return summary;
}

std::set<std::string> NamesOf(const nlohmann::json& object) {
  std::set<std::string> names;
  for (const auto& [name, value] : object.items()) names.insert(name);
  return names;
}

using Names = std::set<std::string>;

const MachineUse kUse{.cpu_cores = 0.5,
                      .pss_mb = 80.0,
                      .processes = {{"stop_guard", {.cpu_cores = 0.1, .pss_mb = 9.0}}}};

TEST(ReportTest, TheJsonHasItsStableNamesAndValues) {
  const auto json = nlohmann::json::parse(FormatJson(FullSummary(), kUse));

  EXPECT_EQ(NamesOf(json),
            (Names{"scans_played",
                   "scans_detected",
                   "scans_incomplete",
                   "messages_lost",
                   "stages",
                   "points",
                   "detections",
                   "latency_ms",
                   "cpu_cores",
                   "pss_mb",
                   "processes"}));
  EXPECT_EQ(NamesOf(json["stages"]), (Names{"preprocessor", "clusterer", "stop_guard"}));
  EXPECT_EQ(NamesOf(json["stages"]["clusterer"]), (Names{"scans", "median_ms", "p99_ms"}));
  EXPECT_EQ(NamesOf(json["points"]), (Names{"in", "voxel", "floor", "map"}));
  EXPECT_EQ(NamesOf(json["latency_ms"]), (Names{"scan_to_detections", "slice_to_permit"}));
  EXPECT_EQ(NamesOf(json["latency_ms"]["slice_to_permit"]), (Names{"median", "p99"}));
  EXPECT_EQ(json["scans_played"], 10);
  EXPECT_EQ(json["messages_lost"], 3);
  EXPECT_EQ(json["stages"]["preprocessor"]["scans"], 10);
  EXPECT_EQ(json["stages"]["preprocessor"]["median_ms"], 1.5);
  EXPECT_EQ(json["stages"]["preprocessor"]["p99_ms"], 2.5);
  EXPECT_EQ(json["points"]["floor"], 100.0);
  EXPECT_EQ(json["points"]["map"], 50.0);
  EXPECT_EQ(json["detections"], 4.5);
  EXPECT_EQ(json["latency_ms"]["scan_to_detections"]["p99"], 30.0);
  EXPECT_EQ(json["cpu_cores"], 0.5);
  EXPECT_EQ(json["pss_mb"], 80.0);
}

TEST(ReportTest, WithoutAMapFilterTheJsonHasNoMap) {
  RunSummary summary = FullSummary();
  summary.points_map.reset();

  const auto json = nlohmann::json::parse(FormatJson(summary, std::nullopt));

  EXPECT_EQ(NamesOf(json["points"]), (Names{"in", "voxel", "floor"}));
  EXPECT_FALSE(json.contains("cpu_cores"));
  EXPECT_FALSE(json.contains("pss_mb"));
}

TEST(ReportTest, WhatWasNotMeasuredIsAbsentFromTheJson) {
  const auto json = nlohmann::json::parse(FormatJson(RunSummary{}, std::nullopt));

  EXPECT_EQ(
      NamesOf(json),
      (Names{"scans_played", "scans_detected", "scans_incomplete", "messages_lost", "stages"}));
  EXPECT_TRUE(json["stages"].is_object());
  EXPECT_TRUE(json["stages"].empty());
}

TEST(ReportTest, TheTableShowsWhatWasMeasured) {
  const std::string table = FormatTable(FullSummary(), kUse);

  for (const char* const text : {"scans played                   10\n",
                                 "messages lost                   3\n",
                                 "preprocessor                 1.50     2.50       10\n",
                                 "after the map                50.0\n",
                                 "slice to permit              1.00     2.00\n",
                                 "CPU cores                    0.50\n",
                                 "  stop_guard                 0.10      9.0 MB\n"}) {
    EXPECT_THAT(table, HasSubstr(text));
  }
}

TEST(ReportTest, TheTableLeavesOutWhatWasNotMeasured) {
  const std::string table = FormatTable(RunSummary{}, std::nullopt);

  EXPECT_THAT(table, HasSubstr("scans played"));
  for (const char* const text : {"after the map", "slice to permit", "CPU cores", "preprocessor"}) {
    EXPECT_THAT(table, Not(HasSubstr(text)));
  }
}

}  // namespace
}  // namespace clearway::run_graph
