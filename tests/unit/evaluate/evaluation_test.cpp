// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/evaluation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/lcm_log.hpp"
#include "common/io/read_error.hpp"
#include "common/messages/detections.hpp"
#include "common/messages/encoding.hpp"
#include "common/messages/pose.hpp"
#include "tests/unit/evaluate/scenes.hpp"
#include "tests/unit/io/temporary_folder.hpp"

namespace clearway::evaluate {
namespace {

using testing::DoubleNear;
using testing::HasSubstr;
using testing::Optional;

constexpr char kBoxAtFive[] =
    R"([{"x": 5, "y": 0, "z": -0.5, "l": 1, "w": 1, "h": 1, "yaw": 0, "n": 50, "cls": "Person"}])";

/// A recording of three scans a.bin, b.bin, c.bin at 10 Hz, with a log beside it.
class EvaluationTest : public testing::Test {
 protected:
  EvaluationTest() {
    for (const char* name : {"a.bin", "b.bin", "c.bin"}) {
      folder_.Write(std::string("scans/velodyne/") + name, std::string(16, '\0'));
    }
    config_.vehicle.sensors.front() = {.name = "top", .x_m = 1.0, .y_m = 0.0, .z_m = 1.0};
  }

  static std::int64_t UtimeOf(int scan) { return io::kFirstScanUtime + 100'000 * scan; }

  /// Writes what the graph publishes for a scan with one obstacle.
  static void WriteScan(io::LcmLogWriter& log, int scan, const Eigen::Vector2f& centre_vehicle) {
    Scene scene;
    test::AddDetection(scene, test::MakePatch(centre_vehicle, 0.8F, 5));
    obstacle_points_t points{};
    points.utime = EndOf(scan);
    points.map_state = obstacle_points_t::MAP_FILTERED;
    points.scan_utime = UtimeOf(scan);
    points.slice_count = 1;
    points.n = static_cast<std::int32_t>(scene.points.size());
    points.x = scene.points.x;
    points.y = scene.points.y;
    points.z = scene.points.z;
    points.intensity = scene.points.intensity;
    points.flags = scene.points.tag;
    const std::vector detections{messages::ToLcm(scene.detections[0], 0, 0)};
    log.Write(1, "OBSTACLE_POINTS", messages::Encode(points));
    for (const detections_t& slice : messages::ToDetections(points, detections, 58000)) {
      log.Write(2, "DETECTIONS", messages::Encode(slice));
    }
  }

  static std::int64_t EndOf(int scan) { return UtimeOf(scan) + 100'000; }

  /// Writes that the map filter removed three points: two of the box kBoxAtFive, one far from it.
  static void WriteRemoved(io::LcmLogWriter& log, int scan) {
    removed_points_t removed{};
    removed.utime = EndOf(scan);
    removed.slice_count = 1;
    removed.n = 3;
    removed.x = {6.0F, 6.1F, 9.0F};
    removed.y = {0.0F, 0.0F, 0.0F};
    removed.z = {0.4F, 0.4F, 3.0F};
    removed.reason.assign(3, removed_points_t::REASON_MAP);
    log.Write(3, "REMOVED_POINTS", messages::Encode(removed));
  }

  [[nodiscard]] EvaluationInput Input() const {
    return {.log = folder_.path() / "run.lcm",
            .labels = folder_.path() / "boxes",
            .input = folder_.path() / "scans",
            .channel_prefix = ""};
  }

  test::TemporaryFolder folder_;
  graph::GraphConfig config_;
};

TEST_F(EvaluationTest, LabelsComeToTheVehicleFrameByTheFirstSensor) {
  folder_.Write("boxes/b.json", kBoxAtFive);
  {  // 5 m before the sensor, which stands 1 m before the vehicle's origin.
    io::LcmLogWriter log(Input().log);
    WriteScan(log, 1, {6.1F, 0.0F});
  }

  const Evaluation evaluation = Evaluate(Input(), config_, {});

  EXPECT_EQ(evaluation.summary.scans, 1U);
  ASSERT_EQ(evaluation.summary.recall.size(), 1U);
  EXPECT_EQ(evaluation.summary.recall[0].separated, 1U);
  EXPECT_THAT(evaluation.summary.centre_error_m, Optional(DoubleNear(0.1, 1e-5)));
}

TEST_F(EvaluationTest, ScansAndLabelsWithoutACounterpartAreCounted) {
  folder_.Write("boxes/a.json", kBoxAtFive);
  folder_.Write("boxes/c.json", kBoxAtFive);
  {
    io::LcmLogWriter log(Input().log);
    for (const int scan : {0, 1, 77}) WriteScan(log, scan, {6.0F, 0.0F});
  }

  const Evaluation evaluation = Evaluate(Input(), config_, {});

  EXPECT_EQ(evaluation.summary.scans, 1U);
  EXPECT_EQ(evaluation.scans_unlabelled, 2U);
  EXPECT_EQ(evaluation.labels_not_in_log, 1U);
}

TEST_F(EvaluationTest, TheMapFilterIsScoredByWhatItRemoved) {
  folder_.Write("boxes/a.json", kBoxAtFive);
  folder_.Write("boxes/b.json", kBoxAtFive);
  {
    io::LcmLogWriter log(Input().log);
    const Eigen::Isometry3d T_map_vehicle(Eigen::Translation3d(0.3, 0.0, 0.0));
    log.Write(0, "POSE", messages::Encode(messages::ToPose(EndOf(1), T_map_vehicle)));
    for (const int scan : {0, 1}) WriteScan(log, scan, {6.0F, 0.0F});
    WriteRemoved(log, 1);
  }
  EvaluationInput input = Input();
  input.T_map_reference = Eigen::Isometry3d::Identity();
  config_.preprocessor.map_filter.z_max_m = 2.5;

  const Evaluation evaluation = Evaluate(input, config_, {});

  EXPECT_EQ(evaluation.summary.scans, 2U);
  ASSERT_TRUE(evaluation.map_filter.has_value());
  const MapFilterSummary& map_filter = *evaluation.map_filter;
  EXPECT_EQ(map_filter.scans, 1U);
  EXPECT_EQ(map_filter.scans_missing_removed, 1U);
  EXPECT_EQ(map_filter.counts.objects.points, 27U) << "a patch of 5 x 5 and two removed points";
  EXPECT_EQ(map_filter.counts.objects.removed, 2U);
  EXPECT_EQ(map_filter.counts.statics.points, 1U);
  EXPECT_EQ(map_filter.counts.statics.removed, 1U);
  EXPECT_EQ(map_filter.counts.statics_in_band.points, 0U);
  ASSERT_TRUE(map_filter.pose_error.has_value());
  EXPECT_THAT(map_filter.pose_error->distance_m, DoubleNear(0.3, 1e-9));
}

TEST_F(EvaluationTest, WithoutRemovedPointsTheMapFilterIsNotScored) {
  folder_.Write("boxes/a.json", kBoxAtFive);
  {
    io::LcmLogWriter log(Input().log);
    WriteScan(log, 0, {6.0F, 0.0F});
  }

  EXPECT_FALSE(Evaluate(Input(), config_, {}).map_filter.has_value());
}

TEST_F(EvaluationTest, ALogOfAnotherRecordingIsRefused) {
  folder_.Write("boxes/a.json", kBoxAtFive);
  {
    io::LcmLogWriter log(Input().log);
    WriteScan(log, 77, {6.0F, 0.0F});
  }

  try {
    static_cast<void>(Evaluate(Input(), config_, {}));
    FAIL() << "scored a scan that is not of the recording";
  } catch (const io::ReadError& error) {
    EXPECT_THAT(error.what(), HasSubstr("run.lcm: no scan can be scored"));
  }
}

TEST_F(EvaluationTest, ScansOfACutFileAreLabelledByTheirNumber) {
  io::RecordingConfig recording;
  recording.points_per_scan = 1;
  folder_.Write("cut/long.v2.bin", std::string(48, '\0'));

  ScanNames names(folder_.path() / "cut", recording);

  EXPECT_EQ(names.KeyOf(UtimeOf(0)), "long.v2#0");
  EXPECT_EQ(names.KeyOf(UtimeOf(2)), "long.v2#2");
  EXPECT_EQ(names.KeyOf(UtimeOf(3)), "");
}

}  // namespace
}  // namespace clearway::evaluate
