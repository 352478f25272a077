// SPDX-License-Identifier: BSD-3-Clause
#include "tools/replay/compare_detections.hpp"

#include <functional>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/lcm_log.hpp"
#include "common/io/read_error.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::replay {
namespace {

using testing::HasSubstr;

detection_t MakeDetection(std::int32_t id) {
  detection_t detection{};
  detection.id = id;
  detection.points = 20 + id;
  detection.centroid[0] = 1.5F + static_cast<float>(id);
  detection.length_m = 0.4F;
  detection.hull_n = 3;
  detection.hull_x = {1.0F, 2.0F, 1.5F};
  detection.hull_y = {0.0F, 0.0F, 1.0F};
  return detection;
}

detections_t MakeScan(std::int64_t scan_id, std::int32_t num_detections = 3) {
  detections_t scan{};
  scan.session = 7;
  scan.scan_id = scan_id;
  scan.scan_utime = 1'700'000'000'000'000 + scan_id * 100'000;
  scan.utime = scan.scan_utime + 100'000;
  scan.slice_count = 1;
  scan.points_in = 500;
  for (std::int32_t i = 0; i < num_detections; ++i) scan.detections.push_back(MakeDetection(i));
  scan.n = num_detections;
  return scan;
}

std::pair<detections_t, detections_t> CutInTwo(const detections_t& scan) {
  detections_t first = scan;
  detections_t second = scan;
  first.slice_count = second.slice_count = 2;
  second.slice_index = 1;
  second.sequence = scan.sequence + 1;
  first.detections.resize(1);
  second.detections.erase(second.detections.begin());
  first.n = 1;
  second.n = scan.n - 1;
  return {first, second};
}

DetectionsOfRun RunOf(const std::vector<detections_t>& slices) {
  DetectionsOfRun run("run");
  for (const detections_t& slice : slices) run.Add(slice);
  return run;
}

TEST(CompareDetectionsTest, TheSameScansOfAnotherRunAgree) {
  detections_t other = MakeScan(1);
  other.session = 99;
  other.sequence = 1000;
  other.processing_us = 4321;
  other.map_epoch = 17;

  const Comparison comparison =
      Compare(RunOf({MakeScan(1), MakeScan(2)}), RunOf({other, MakeScan(2)}));

  EXPECT_TRUE(comparison.agrees());
  EXPECT_EQ(comparison.equal, 2U);
  EXPECT_EQ(comparison.detections, 6U);
  EXPECT_EQ(comparison.first_difference, "");
}

TEST(CompareDetectionsTest, SlicingOrderAndRepetitionDoNotMatter) {
  const auto [first, second] = CutInTwo(MakeScan(1));

  const Comparison comparison =
      Compare(RunOf({second, first, second}), RunOf({MakeScan(2), MakeScan(1)}));

  EXPECT_EQ(comparison.equal, 1U);
  EXPECT_EQ(comparison.different, 0U);
  EXPECT_EQ(comparison.invalid, 0U);
}

TEST(CompareDetectionsTest, NothingToCompareIsNoAgreement) {
  EXPECT_FALSE(Compare(RunOf({}), RunOf({})).agrees());
}

TEST(CompareDetectionsTest, AScanWithoutDetectionsIsCompared) {
  EXPECT_TRUE(Compare(RunOf({MakeScan(1, 0)}), RunOf({MakeScan(1, 0)})).agrees());
  EXPECT_FALSE(Compare(RunOf({MakeScan(1, 0)}), RunOf({MakeScan(1, 1)})).agrees());
}

TEST(CompareDetectionsTest, ScansOfOneRunOnlyAreCountedAndDoNotAgree) {
  const Comparison comparison =
      Compare(RunOf({MakeScan(1), MakeScan(2), MakeScan(3)}), RunOf({MakeScan(2), MakeScan(4)}));

  EXPECT_EQ(comparison.equal, 1U);
  EXPECT_EQ(comparison.only_in_run, 2U);
  EXPECT_EQ(comparison.only_in_reference, 1U);
  EXPECT_FALSE(comparison.agrees());
}

TEST(CompareDetectionsTest, IncompleteScansOfEitherSideAreCountedApart) {
  const auto [first, second] = CutInTwo(MakeScan(1));
  detections_t gap = MakeScan(2);
  gap.scan_state = detections_t::SCAN_INCOMPLETE;
  gap.points_in = 3;

  const Comparison comparison =
      Compare(RunOf({second, MakeScan(2), MakeScan(3)}), RunOf({MakeScan(1), gap, MakeScan(3)}));

  EXPECT_EQ(comparison.incomplete, 2U);
  EXPECT_EQ(comparison.equal, 1U);
  EXPECT_TRUE(comparison.agrees());
}

TEST(CompareDetectionsTest, SlicesThatContradictAreCountedAsInvalid) {
  detections_t beyond = MakeScan(1);
  beyond.slice_index = 1;
  detections_t other_count = MakeScan(2);
  other_count.slice_count = 5;

  const Comparison comparison =
      Compare(RunOf({MakeScan(1), beyond}), RunOf({MakeScan(1), MakeScan(2), other_count}));

  EXPECT_EQ(comparison.invalid, 2U);
}

TEST(CompareDetectionsTest, TwoGraphsInOneLogAreRefused) {
  detections_t other = MakeScan(1);
  other.session = 8;

  EXPECT_THROW(static_cast<void>(Compare(RunOf({MakeScan(1)}), RunOf({MakeScan(1), other}))),
               io::ReadError);
}

TEST(CompareDetectionsTest, TheFirstDifferenceNamesScanDetectionFieldAndBothValues) {
  detections_t other = MakeScan(2);
  other.detections[1].centroid[2] = 0.25F;
  detections_t later = MakeScan(3);
  later.points_in = 0;

  const Comparison comparison =
      Compare(RunOf({MakeScan(1), MakeScan(2), MakeScan(3)}), RunOf({MakeScan(1), other, later}));

  EXPECT_EQ(comparison.different, 2U);
  EXPECT_EQ(comparison.first_difference,
            "scan 2 at 1700000000200000 us: detection 1: centroid[2] 0, reference 0.25");
}

struct Change {
  const char* field;
  std::function<void(detections_t&)> apply;
};

class CompareDetectionsFieldTest : public testing::TestWithParam<Change> {};

TEST_P(CompareDetectionsFieldTest, AnotherValueIsADifference) {
  detections_t changed = MakeScan(1);
  GetParam().apply(changed);

  const Comparison comparison = Compare(RunOf({MakeScan(1)}), RunOf({changed}));

  EXPECT_EQ(comparison.different, 1U);
  EXPECT_FALSE(comparison.agrees());
  EXPECT_THAT(comparison.first_difference, HasSubstr(std::string(GetParam().field) + " "));
}

INSTANTIATE_TEST_SUITE_P(
    EveryField,
    CompareDetectionsFieldTest,
    testing::Values(
        Change{"scan_id", [](auto& m) { ++m.scan_id; }},
        Change{"utime", [](auto& m) { ++m.utime; }},
        Change{"floor_state", [](auto& m) { ++m.floor_state; }},
        Change{"map_state", [](auto& m) { ++m.map_state; }},
        Change{"points_in", [](auto& m) { ++m.points_in; }},
        Change{"number of detections", [](auto& m) { m.n = 2, m.detections.pop_back(); }},
        Change{"id", [](auto& m) { ++m.detections[0].id; }},
        Change{"track_id", [](auto& m) { ++m.detections[0].track_id; }},
        Change{"points", [](auto& m) { ++m.detections[0].points; }},
        Change{"points_below_floor", [](auto& m) { ++m.detections[0].points_below_floor; }},
        Change{"centroid[1]", [](auto& m) { m.detections[0].centroid[1] = -0.0F; }},
        Change{"nearest[0]", [](auto& m) { m.detections[0].nearest[0] = 1e-40F; }},
        Change{"z_min", [](auto& m) { m.detections[0].z_min = 1.0F; }},
        Change{"z_max", [](auto& m) { m.detections[0].z_max = 1.0F; }},
        Change{"center[1]", [](auto& m) { m.detections[0].center[1] = 1.0F; }},
        Change{"length_m", [](auto& m) { m.detections[0].length_m = 0.40000004F; }},
        Change{"width_m", [](auto& m) { m.detections[0].width_m = 1.0F; }},
        Change{"yaw_rad", [](auto& m) { m.detections[0].yaw_rad = 1.0F; }},
        Change{"yaw_confidence", [](auto& m) { m.detections[0].yaw_confidence = 1.0F; }},
        Change{"velocity[1]", [](auto& m) { m.detections[0].velocity[1] = 1.0F; }},
        Change{"velocity_variance", [](auto& m) { m.detections[0].velocity_variance = 1.0F; }},
        Change{"kind", [](auto& m) { ++m.detections[0].kind; }},
        Change{"number of hull_x", [](auto& m) { m.detections[0].hull_x.pop_back(); }},
        Change{"hull_x[2]", [](auto& m) { m.detections[0].hull_x[2] = 1.0F; }},
        Change{"hull_y[0]", [](auto& m) { m.detections[0].hull_y[0] = 1.0F; }}));

TEST(ReadDetectionsTest, TakesThoseOfItsPrefixAndCountsWhatDoesNotDecode) {
  const test::TestFolder folder;
  const auto file = folder.path() / "run.log";
  {
    io::LcmLogWriter log(file);
    const std::string channel = messages::channels::kDetections.name;
    log.Write(1, "A_" + channel, messages::Encode(MakeScan(1)));
    log.Write(2, channel, messages::Encode(MakeScan(2)));
    log.Write(3, "A_" + channel, std::vector<std::byte>(5));
  }

  const DetectionsOfRun detections = ReadDetections(file, "A_");

  EXPECT_EQ(detections.invalid(), 1U);
  ASSERT_EQ(detections.Scans().size(), 1U);
  EXPECT_EQ(detections.Scans().begin()->second.whole.scan_id, 1);
}

}  // namespace
}  // namespace clearway::replay
