// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/scan/slice_cutter.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

namespace clearway::core {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;
constexpr std::int64_t kPeriod_us = 100'000;

// A scan in which each point can be told by its intensity and tag; of ten shots one is a zero
// return, one NaN and one infinite.
ScanToCut RandomScan(std::size_t size, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> metres(-50.0F, 50.0F);
  ScanToCut scan{
      .scan_id = 7, .utime_start = kStart, .utime_end = kStart + kPeriod_us, .cloud_sensor = {}};
  for (std::size_t i = 0; i < size; ++i) {
    Eigen::Vector3f point(metres(random), metres(random), metres(random));
    const auto kind = random() % 10;
    if (kind == 0) point.setZero();
    if (kind == 1) point.y() = std::numeric_limits<float>::quiet_NaN();
    if (kind == 2) point.z() = std::numeric_limits<float>::infinity();
    scan.cloud_sensor.Add(
        point, static_cast<std::uint8_t>(i % 256), static_cast<std::uint8_t>(i / 256 % 256));
  }
  return scan;
}

bool IsZeroReturn(const PointCloud& cloud, std::size_t i) {
  return cloud.x[i] == 0.0F && cloud.y[i] == 0.0F && cloud.z[i] == 0.0F;
}

// NaN compares by its bits.
std::vector<std::uint32_t> Bits(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits(values.size());
  if (!values.empty()) std::memcpy(bits.data(), values.data(), values.size() * sizeof(float));
  return bits;
}

PointCloud Together(const std::vector<Slice>& slices) {
  PointCloud cloud;
  for (const Slice& slice : slices) cloud.Append(slice.cloud_sensor);
  return cloud;
}

class SliceCutterTest : public testing::TestWithParam<std::tuple<std::size_t, int, int>> {
 protected:
  const ScanToCut scan_ = RandomScan(std::get<0>(GetParam()), 99);
  const SliceCut cut_{.max_points = std::get<1>(GetParam()), .min_slices = std::get<2>(GetParam())};
  const std::vector<Slice> slices_ = CutIntoSlices(scan_, cut_);
};

TEST_P(SliceCutterTest, EveryPointIsInExactlyOneSliceInOrder) {
  PointCloud expected;
  for (std::size_t i = 0; i < scan_.cloud_sensor.size(); ++i) {
    if (!IsZeroReturn(scan_.cloud_sensor, i)) expected.AddFrom(scan_.cloud_sensor, i);
  }

  const PointCloud together = Together(slices_);

  EXPECT_EQ(Bits(together.x), Bits(expected.x));
  EXPECT_EQ(Bits(together.y), Bits(expected.y));
  EXPECT_EQ(Bits(together.z), Bits(expected.z));
  EXPECT_EQ(together.intensity, expected.intensity);
  EXPECT_EQ(together.tag, expected.tag);
}

TEST_P(SliceCutterTest, ShotsArePointsAndZeroReturns) {
  std::int64_t shots = 0;
  for (const Slice& slice : slices_) {
    EXPECT_EQ(slice.shots,
              slice.zero_returns + static_cast<std::int64_t>(slice.cloud_sensor.size()));
    shots += slice.shots;
  }
  EXPECT_EQ(shots, static_cast<std::int64_t>(scan_.cloud_sensor.size()));
}

TEST_P(SliceCutterTest, KeepsBothBoundsAndMakesNoMoreSlicesThanTheyAsk) {
  const std::size_t size = scan_.cloud_sensor.size();
  const auto max_points = static_cast<std::size_t>(cut_.max_points);
  const std::size_t for_points = size / max_points + (size % max_points > 0 ? 1 : 0);
  EXPECT_EQ(slices_.size(),
            std::max<std::size_t>(for_points, static_cast<std::size_t>(cut_.min_slices)));
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  std::int64_t most = 0;
  for (const Slice& slice : slices_) {
    EXPECT_LE(slice.cloud_sensor.size(), max_points);
    least = std::min(least, slice.shots);
    most = std::max(most, slice.shots);
  }
  EXPECT_LE(most - least, 1) << "slices are of equal size";
}

TEST_P(SliceCutterTest, SlicesAreNumberedValidAndOfTheScan) {
  for (std::size_t k = 0; k < slices_.size(); ++k) {
    const Slice& slice = slices_[k];
    EXPECT_EQ(slice.slice_index, static_cast<int>(k));
    EXPECT_EQ(slice.slice_count, static_cast<int>(slices_.size()));
    EXPECT_EQ(slice.scan_id, 7);
    EXPECT_EQ(slice.scan_utime, kStart);
    EXPECT_EQ(slice.scan_end_utime, kStart + kPeriod_us);
    EXPECT_TRUE(IsValid(slice));
  }
}

TEST_P(SliceCutterTest, WithoutTimesThePointsAreSpreadOverTheScan) {
  std::int32_t last = 0;
  for (const Slice& slice : slices_) {
    const auto count = static_cast<std::int64_t>(slices_.size());
    for (const std::int32_t offset : slice.cloud_sensor.time_offset_us) {
      EXPECT_GE(offset, last);
      EXPECT_LT(offset, kPeriod_us);
      // A point's time lies in its slice's share of the scan, give or take one shot's time.
      const std::int64_t shot_us =
          kPeriod_us / static_cast<std::int64_t>(scan_.cloud_sensor.size()) + 1;
      EXPECT_GE(offset + shot_us, kPeriod_us * slice.slice_index / count);
      EXPECT_LE(offset - shot_us, kPeriod_us * (slice.slice_index + 1) / count);
      last = offset;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(SizesAndBounds,
                         SliceCutterTest,
                         testing::Values(std::tuple(0, 3000, 10),
                                         std::tuple(0, 1, 1),
                                         std::tuple(1, 3000, 10),
                                         std::tuple(1, 1, 1),
                                         std::tuple(37, 1, 1),
                                         std::tuple(37, 1, 40),
                                         std::tuple(1000, 100, 10),
                                         std::tuple(1001, 100, 10),
                                         std::tuple(999, 100, 10),
                                         std::tuple(1000, 5000, 1),
                                         std::tuple(4096, 1, 1),
                                         std::tuple(20'000, 3000, 3),
                                         std::tuple(20'000, 63, 10)));

TEST(SliceCutterTimesTest, TimesThatTheCloudBringsAreKept) {
  ScanToCut scan = RandomScan(500, 3);
  for (std::size_t i = 0; i < scan.cloud_sensor.size(); ++i) {
    scan.cloud_sensor.time_offset_us[i] = static_cast<std::int32_t>((i * 7919) % 100'000);
  }
  std::vector<std::int32_t> expected;
  for (std::size_t i = 0; i < scan.cloud_sensor.size(); ++i) {
    if (!IsZeroReturn(scan.cloud_sensor, i)) {
      expected.push_back(scan.cloud_sensor.time_offset_us[i]);
    }
  }

  const auto slices = CutIntoSlices(scan, {.max_points = 60, .min_slices = 3});

  EXPECT_EQ(Together(slices).time_offset_us, expected);
}

TEST(SliceCutterTimesTest, AnEmptyScanGivesEmptySlicesOfNoShots) {
  const auto slices = CutIntoSlices(RandomScan(0, 1), {.max_points = 10, .min_slices = 4});

  ASSERT_EQ(slices.size(), 4U);
  for (const Slice& slice : slices) {
    EXPECT_TRUE(slice.cloud_sensor.empty());
    EXPECT_EQ(slice.shots, 0);
    EXPECT_EQ(slice.zero_returns, 0);
  }
}

TEST(SliceCutterTimesTest, ACoveredSensorGivesSlicesOfZeroReturnsOnly) {
  ScanToCut scan = RandomScan(0, 1);
  for (int i = 0; i < 100; ++i) scan.cloud_sensor.Add(Eigen::Vector3f::Zero());

  const auto slices = CutIntoSlices(scan, {.max_points = 30, .min_slices = 1});

  std::int64_t zero_returns = 0;
  for (const Slice& slice : slices) zero_returns += slice.zero_returns;
  EXPECT_EQ(zero_returns, 100);
  EXPECT_TRUE(Together(slices).empty());
}

}  // namespace
}  // namespace clearway::core
