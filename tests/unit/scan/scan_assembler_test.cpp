// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/scan/scan_assembler.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::int64_t kScan_us = 100'000;
constexpr std::int64_t kEpoch_us = 1'600'000'000'000'000;
constexpr std::int64_t kGrace_us = ScanAssemblerConfig{}.grace_us;

// Slice `index` of scan `id`: one point whose x tells the index, whose y the sensor, whose z the
// id.
Slice MakeSlice(std::int64_t id, int index, int count, int sensor = 0, std::int64_t session = 1) {
  Slice slice;
  slice.sensor = sensor;
  slice.session = session;
  slice.sequence = id * count + index;
  slice.scan_id = id;
  slice.scan_utime = kEpoch_us + id * kScan_us;
  slice.scan_end_utime = slice.scan_utime + kScan_us;
  slice.slice_index = index;
  slice.slice_count = count;
  slice.shots = 10;
  slice.zero_returns = 3;
  slice.cloud_sensor.Add(
      {static_cast<float>(index), static_cast<float>(sensor), static_cast<float>(id)});
  return slice;
}

// When slice `index` of scan `id` arrives in a healthy stream.
std::int64_t ArrivalOf(std::int64_t id, int index, int count) {
  return id * kScan_us + kScan_us * (index + 1) / count;
}

std::int64_t Total(const ScanAssembler& assembler) {
  std::int64_t total = 0;
  for (std::size_t i = 0; i < kNumSliceOutcomes; ++i) {
    total += assembler.count(static_cast<SliceOutcome>(i));
  }
  return total;
}

TEST(ScanAssembler, NeedsASensor) {
  EXPECT_THROW(ScanAssembler({}, 0), std::invalid_argument);
}

TEST(ScanAssembler, EmitsAScanWithItsLastSlice) {
  ScanAssembler assembler({}, 1);

  assembler.Add(MakeSlice(5, 0, 2), 0);
  EXPECT_THAT(assembler.Poll(0), IsEmpty());
  assembler.Add(MakeSlice(5, 1, 2), 10);
  const std::vector<AssembledScan> scans = assembler.Poll(10);

  ASSERT_THAT(scans, SizeIs(1));
  EXPECT_TRUE(scans[0].complete);
  EXPECT_EQ(scans[0].scan_id, 5);
  EXPECT_EQ(scans[0].utime_start, kEpoch_us + 5 * kScan_us);
  EXPECT_EQ(scans[0].utime_end, kEpoch_us + 6 * kScan_us);
  EXPECT_EQ(scans[0].shots, 20);
  EXPECT_EQ(scans[0].zero_returns, 6);
  EXPECT_EQ(assembler.NextDeadline(), std::nullopt);
}

TEST(ScanAssembler, EmitsAnEmptyScanToo) {
  ScanAssembler assembler({}, 1);
  Slice slice = MakeSlice(5, 0, 1);
  slice.cloud_sensor.Clear();

  assembler.Add(slice, 0);
  const std::vector<AssembledScan> scans = assembler.Poll(0);

  ASSERT_THAT(scans, SizeIs(1));
  EXPECT_TRUE(scans[0].complete);
  EXPECT_TRUE(scans[0].sensors[0].cloud_sensor.empty());
}

TEST(ScanAssembler, EmitsAnIncompleteScanWhenItsGraceIsOver) {
  ScanAssembler assembler({}, 1);
  assembler.Add(MakeSlice(5, 0, 3), 0);
  assembler.Add(MakeSlice(5, 2, 3), 20'000);

  EXPECT_EQ(assembler.NextDeadline(), 20'000 + kGrace_us);
  EXPECT_THAT(assembler.Poll(20'000 + kGrace_us - 1), IsEmpty());
  const std::vector<AssembledScan> scans = assembler.Poll(20'000 + kGrace_us);

  ASSERT_THAT(scans, SizeIs(1));
  EXPECT_FALSE(scans[0].complete);
  EXPECT_EQ(scans[0].missing_slices, 1);
  EXPECT_THAT(scans[0].sensors[0].cloud_sensor.x, ElementsAre(0.0F, 2.0F));
  EXPECT_EQ(assembler.Add(MakeSlice(5, 1, 3), 90'000), SliceOutcome::kLate);
}

TEST(ScanAssembler, LetsACompleteScanWaitForAnOlderOneNoLongerThanTheGrace) {
  ScanAssembler assembler({}, 1);
  assembler.Add(MakeSlice(5, 0, 10), 0);
  assembler.Add(MakeSlice(6, 0, 1), 1000);
  // The older scan keeps trickling in; it must not hold the newer one back for ever.
  std::vector<AssembledScan> scans;
  std::int64_t now = 1000;
  for (int i = 1; i < 9 && scans.empty(); ++i) {
    now += 20'000;
    assembler.Add(MakeSlice(5, i, 10), now);
    scans = assembler.Poll(now);
  }

  ASSERT_THAT(scans, SizeIs(2));
  EXPECT_EQ(scans[0].scan_id, 5);
  EXPECT_EQ(scans[1].scan_id, 6);
  EXPECT_LE(now, 1000 + kGrace_us + 20'000);
}

TEST(ScanAssembler, KeepsNoMoreScansInFlightThanAllowed) {
  ScanAssembler assembler({.max_in_flight = 3}, 1);
  for (int id = 0; id < 4; ++id) assembler.Add(MakeSlice(id, 0, 2), 0);

  const std::vector<AssembledScan> scans = assembler.Poll(0);

  ASSERT_THAT(scans, SizeIs(1));
  EXPECT_EQ(scans[0].scan_id, 0);
}

TEST(ScanAssembler, MergesSensorsByScanAndReportsTheOneThatIsMissing) {
  ScanAssembler assembler({}, 2);
  assembler.Add(MakeSlice(5, 0, 1, 0), 0);
  EXPECT_THAT(assembler.Poll(0), IsEmpty());
  assembler.Add(MakeSlice(5, 0, 1, 1), 100);
  const std::vector<AssembledScan> both = assembler.Poll(100);
  assembler.Add(MakeSlice(6, 0, 1, 1), 200);
  const std::vector<AssembledScan> one = assembler.Poll(200 + kGrace_us);

  ASSERT_THAT(both, SizeIs(1));
  EXPECT_TRUE(both[0].complete);
  EXPECT_THAT(both[0].sensors[1].cloud_sensor.y, ElementsAre(1.0F));
  ASSERT_THAT(one, SizeIs(1));
  EXPECT_FALSE(one[0].complete);
  EXPECT_THAT(one[0].missing_sensors, ElementsAre(0));
}

TEST(ScanAssembler, StopsWaitingForASensorThatIsGoneButGoesOnReportingIt) {
  ScanAssembler assembler({}, 2);
  std::int64_t now = 0;
  std::vector<std::int64_t> waits;
  for (int id = 0; id < 12; ++id) {
    now += kScan_us;
    assembler.Add(MakeSlice(id, 0, 1, 0), now);
    std::vector<AssembledScan> scans = assembler.Poll(now);
    waits.push_back(scans.empty() ? kGrace_us : 0);
    if (scans.empty()) scans = assembler.Poll(now + kGrace_us);
    ASSERT_THAT(scans, SizeIs(1));
    EXPECT_THAT(scans[0].missing_sensors, ElementsAre(1));
  }
  EXPECT_EQ(std::count(waits.begin(), waits.end(), kGrace_us), ScanAssembler::kAbsentScans);

  // It comes back.
  assembler.Add(MakeSlice(12, 0, 1, 1), now + kScan_us);
  EXPECT_THAT(assembler.Poll(now + kScan_us), IsEmpty());
  assembler.Add(MakeSlice(12, 0, 1, 0), now + kScan_us);
  EXPECT_TRUE(assembler.Poll(now + kScan_us).at(0).complete);
}

struct BadSlice {
  const char* what;
  void (*spoil)(Slice&);
  SliceOutcome outcome;
};

class ScanAssemblerBadSliceTest : public testing::TestWithParam<BadSlice> {};

TEST_P(ScanAssemblerBadSliceTest, IsCountedAndLeftOut) {
  ScanAssembler assembler({}, 1);
  assembler.Add(MakeSlice(5, 0, 3), 0);
  Slice slice = MakeSlice(5, 1, 3);
  GetParam().spoil(slice);

  EXPECT_EQ(assembler.Add(slice, 1), GetParam().outcome) << GetParam().what;
  assembler.Add(MakeSlice(5, 1, 3), 2);
  assembler.Add(MakeSlice(5, 2, 3), 3);

  const std::vector<AssembledScan> scans = assembler.Poll(3);
  ASSERT_THAT(scans, SizeIs(1));
  EXPECT_TRUE(scans[0].complete);
  EXPECT_EQ(assembler.count(GetParam().outcome), 1);
}

constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();

INSTANTIATE_TEST_SUITE_P(
    Kinds,
    ScanAssemblerBadSliceTest,
    testing::Values(
        BadSlice{"index beyond the count",
                 [](Slice& s) { s.slice_index = 3; },
                 SliceOutcome::kInvalid},
        BadSlice{"negative index", [](Slice& s) { s.slice_index = -1; }, SliceOutcome::kInvalid},
        BadSlice{"no slices", [](Slice& s) { s.slice_count = 0; }, SliceOutcome::kInvalid},
        BadSlice{"too many slices",
                 [](Slice& s) { s.slice_count = 1 << 30; },
                 SliceOutcome::kInvalid},
        BadSlice{"ends before it starts",
                 [](Slice& s) { s.scan_end_utime = 0; },
                 SliceOutcome::kInvalid},
        BadSlice{"stamp at the limit",
                 [](Slice& s) {
                   s.scan_utime = kMin;
                   s.scan_end_utime = kMax;
                 },
                 SliceOutcome::kInvalid},
        BadSlice{"negative scan id", [](Slice& s) { s.scan_id = -1; }, SliceOutcome::kInvalid},
        BadSlice{"negative shots", [](Slice& s) { s.shots = -5; }, SliceOutcome::kInvalid},
        BadSlice{"absurd zero returns",
                 [](Slice& s) { s.zero_returns = kMax; },
                 SliceOutcome::kInvalid},
        BadSlice{"unequal arrays",
                 [](Slice& s) { s.cloud_sensor.tag.clear(); },
                 SliceOutcome::kInvalid},
        BadSlice{"negative sequence", [](Slice& s) { s.sequence = -1; }, SliceOutcome::kInvalid},
        BadSlice{"other count", [](Slice& s) { s.slice_count = 4; }, SliceOutcome::kInconsistent},
        BadSlice{"other start", [](Slice& s) { s.scan_utime += 1; }, SliceOutcome::kInconsistent},
        BadSlice{"other end", [](Slice& s) { s.scan_end_utime += 1; }, SliceOutcome::kInconsistent},
        BadSlice{"sensor -1", [](Slice& s) { s.sensor = -1; }, SliceOutcome::kUnknownSensor},
        BadSlice{"sensor too high", [](Slice& s) { s.sensor = 1; }, SliceOutcome::kUnknownSensor},
        BadSlice{"the slice before again",
                 [](Slice& s) { s.slice_index = 0; },
                 SliceOutcome::kDuplicate}));

TEST(ScanAssembler, StartsAnewWithTheNewSessionOfASenderWhoseIdsJumpBack) {
  ScanAssembler assembler({}, 2);
  for (int sensor : {0, 1}) assembler.Add(MakeSlice(1000, 0, 1, sensor, 1), 0);
  ASSERT_THAT(assembler.Poll(0), SizeIs(1));
  assembler.Add(MakeSlice(1001, 0, 2, 0, 1), 10);

  assembler.Add(MakeSlice(3, 0, 1, 0, 2), 20);
  EXPECT_EQ(assembler.Add(MakeSlice(1001, 0, 2, 1, 1), 25), SliceOutcome::kForeign)
      << "of the session that has ended, although this sensor has not changed yet";
  assembler.Add(MakeSlice(3, 0, 1, 1, 2), 30);
  const std::vector<AssembledScan> scans = assembler.Poll(30);

  ASSERT_THAT(scans, SizeIs(2));
  EXPECT_EQ(scans[0].scan_id, 1001);
  EXPECT_FALSE(scans[0].complete);
  EXPECT_EQ(scans[1].scan_id, 3);
  EXPECT_TRUE(scans[1].complete);
  EXPECT_EQ(assembler.restarts(), 1);
}

TEST(ScanAssembler, FollowsALogThatIsPlayedAgain) {
  ScanAssembler assembler({}, 1);
  std::vector<std::int64_t> ids;
  for (int round = 0; round < 2; ++round) {
    for (int id = 0; id < 50; ++id) {
      const std::int64_t now = (round * 50 + id) * kScan_us;
      assembler.Add(MakeSlice(id, 0, 1), now);
      for (const AssembledScan& scan : assembler.Poll(now)) ids.push_back(scan.scan_id);
    }
  }

  EXPECT_THAT(ids, SizeIs(100));
  EXPECT_EQ(assembler.restarts(), 1);
}

TEST(ScanAssembler, FollowsAShortLogThatIsPlayedManyTimes) {
  ScanAssembler assembler({}, 1);
  std::size_t emitted = 0;
  for (int round = 0; round < 5; ++round) {
    for (int id = 0; id < 15; ++id) {  // 1.5 s: less than restart_us back.
      const std::int64_t now = (round * 15 + id) * kScan_us;
      for (int index = 0; index < 10; ++index) assembler.Add(MakeSlice(id, index, 10), now);
      emitted += assembler.Poll(now).size();
    }
  }

  // The numbering must have gone back for a few slices before that is believed.
  EXPECT_GE(emitted, 5U * 15U - 4U);
  EXPECT_EQ(assembler.restarts(), 4);
  EXPECT_EQ(assembler.count(SliceOutcome::kForeign), 0);
}

TEST(ScanAssembler, FollowsASenderWhoseIdsGoBackWhileItsNumberingGoesOn) {
  ScanAssembler assembler({}, 1);
  std::size_t emitted = 0;
  std::int64_t sequence = 0;
  for (int round = 0; round < 3; ++round) {
    for (int id = 0; id < 15; ++id) {
      Slice slice = MakeSlice(id, 0, 1);
      slice.sequence = sequence++;
      const std::int64_t now = (round * 15 + id) * kScan_us;
      assembler.Add(slice, now);
      emitted += assembler.Poll(now).size();
    }
  }

  EXPECT_EQ(emitted, 45U);
  EXPECT_EQ(assembler.restarts(), 2);
}

TEST(ScanAssembler, RecoversFromEachSliceOfAPassingPublisher) {
  ScanAssembler assembler({}, 1);
  std::set<std::int64_t> emitted;
  for (int id = 0; id < 200; ++id) {
    const std::int64_t now = id * kScan_us;
    if (id == 20 || id == 70) {
      Slice poison = MakeSlice(id, 0, 1, 0, 40 + id);
      poison.scan_id = std::int64_t{1} << 62;
      assembler.Add(poison, now);
    }
    assembler.Add(MakeSlice(id, 0, 1), now);
    for (const AssembledScan& scan : assembler.Poll(now)) emitted.insert(scan.scan_id);
  }

  // Each costs the time for which two sessions count as two publishers: 2 s.
  for (int id = 0; id < 200; ++id) {
    const bool is_shadowed = (id >= 20 && id <= 42) || (id >= 70 && id <= 92);
    EXPECT_TRUE(is_shadowed || emitted.contains(id)) << id;
  }
}

TEST(ScanAssembler, RecoversFromOneAbsurdScanId) {
  ScanAssembler assembler({}, 1);
  std::set<std::int64_t> emitted;
  for (int id = 0; id < 20; ++id) {
    const std::int64_t now = id * kScan_us;
    Slice slice = MakeSlice(id, 0, 1);
    if (id == 5) slice.scan_id = kMax;
    assembler.Add(slice, now);
    for (const AssembledScan& scan : assembler.Poll(now)) emitted.insert(scan.scan_id);
  }

  EXPECT_THAT(emitted, SizeIs(20));
}

TEST(ScanAssembler, DropsASecondPublisherAndSaysSo) {
  ScanAssembler assembler({}, 1);
  for (int id = 0; id < 20; ++id) {
    assembler.Add(MakeSlice(id, 0, 1, 0, 1), id * kScan_us);
    assembler.Add(MakeSlice(id, 0, 1, 0, 2), id * kScan_us + 1);
    (void)assembler.Poll(id * kScan_us + 1);
  }

  EXPECT_EQ(assembler.count(SliceOutcome::kForeign), 19);
  EXPECT_EQ(assembler.sequence_counts(0).foreign, 19);
}

class ScanAssemblerTrafficTest : public testing::TestWithParam<unsigned> {};

// Random drops, repeats and delays; every slice is accounted for exactly once.
TEST_P(ScanAssemblerTrafficTest, AccountsForEverySliceExactlyOnce) {
  std::mt19937 random(GetParam());
  constexpr int kScans = 60;
  constexpr int kSlices = 10;
  constexpr int kSensors = 2;
  std::vector<std::pair<std::int64_t, Slice>> traffic;
  std::uniform_int_distribution<std::int64_t> delay(0, 60'000);
  for (int id = 0; id < kScans; ++id) {
    for (int sensor = 0; sensor < kSensors; ++sensor) {
      for (int index = 0; index < kSlices; ++index) {
        if (random() % 20 == 0) continue;
        const int copies = random() % 10 == 0 ? 2 : 1;
        for (int copy = 0; copy < copies; ++copy) {
          traffic.emplace_back(ArrivalOf(id, index, kSlices) + delay(random),
                               MakeSlice(id, index, kSlices, sensor));
        }
      }
    }
  }
  std::stable_sort(traffic.begin(), traffic.end(), [](const auto& a, const auto& b) {
    return a.first < b.first;
  });
  ScanAssembler assembler({}, kSensors);
  std::map<std::tuple<int, int, int>, int> accepted;  // By scan, sensor and slice.
  std::map<std::tuple<int, int, int>, int> emitted;
  std::int64_t last_id = -1;
  const auto take = [&](std::int64_t now) {
    for (const AssembledScan& scan : assembler.Poll(now)) {
      EXPECT_GT(scan.scan_id, last_id);
      last_id = scan.scan_id;
      int num_points = 0;
      for (int sensor = 0; sensor < kSensors; ++sensor) {
        const PointCloud& cloud = scan.sensors[static_cast<std::size_t>(sensor)].cloud_sensor;
        EXPECT_TRUE(std::is_sorted(cloud.x.begin(), cloud.x.end())) << "in order of the slices";
        for (std::size_t i = 0; i < cloud.size(); ++i) {
          EXPECT_EQ(static_cast<std::int64_t>(cloud.z[i]), scan.scan_id);
          ++emitted[{static_cast<int>(scan.scan_id), sensor, static_cast<int>(cloud.x[i])}];
          ++num_points;
        }
      }
      EXPECT_EQ(scan.shots, 10 * num_points);
      EXPECT_EQ(scan.missing_slices + num_points,
                (kSensors - static_cast<int>(scan.missing_sensors.size())) * kSlices);
      EXPECT_EQ(scan.complete, num_points == kSensors * kSlices);
    }
  };

  for (const auto& [now, slice] : traffic) {
    take(now);
    if (assembler.Add(slice, now) == SliceOutcome::kAccepted) {
      ++accepted[{static_cast<int>(slice.scan_id), slice.sensor, slice.slice_index}];
    }
    take(now);
  }
  take(traffic.back().first + 10 * kGrace_us);

  EXPECT_EQ(Total(assembler), static_cast<std::int64_t>(traffic.size()));
  EXPECT_EQ(emitted, accepted);
  for (const auto& [key, times] : emitted) EXPECT_EQ(times, 1);
  EXPECT_EQ(assembler.NextDeadline(), std::nullopt);
  EXPECT_EQ(assembler.restarts(), 0);
}

TEST_P(ScanAssemblerTrafficTest, GivesTheSameScanForEveryOrderOfItsSlices) {
  std::mt19937 random(GetParam());
  std::vector<Slice> slices;
  for (int i = 0; i < 12; ++i) slices.push_back(MakeSlice(4, i, 12));
  std::shuffle(slices.begin(), slices.end(), random);
  ScanAssembler assembler({}, 1);

  for (const Slice& slice : slices) assembler.Add(slice, 0);
  const std::vector<AssembledScan> scans = assembler.Poll(0);

  ASSERT_THAT(scans, SizeIs(1));
  EXPECT_THAT(scans[0].sensors[0].cloud_sensor.x,
              ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11));
}

// Nonsense of every kind: nothing crashes, the totals add up, and the stream is taken up again.
TEST_P(ScanAssemblerTrafficTest, SurvivesNonsense) {
  std::mt19937_64 random(GetParam());
  const auto any = [&]() -> std::int64_t {
    switch (random() % 5) {
      case 0:
        return kMax;
      case 1:
        return kMin;
      case 2:
        return static_cast<std::int64_t>(random());
      default:
        return static_cast<std::int64_t>(random() % 20) - 2;
    }
  };
  ScanAssembler assembler({}, 2);
  std::int64_t now = 0;
  for (int i = 0; i < 5000; ++i) {
    Slice slice;
    slice.sensor = static_cast<int>(random() % 4) - 1;
    slice.session = any();
    slice.sequence = any();
    slice.scan_id = any();
    slice.scan_utime = any();
    slice.scan_end_utime = any();
    slice.slice_index = static_cast<int>(any());
    slice.slice_count = static_cast<int>(any());
    slice.shots = any();
    now += static_cast<std::int64_t>(random() % 30'000);
    assembler.Add(slice, now);
    if (i % 3 == 0) (void)assembler.Poll(now);
  }
  EXPECT_EQ(Total(assembler), 5000);

  std::set<std::int64_t> emitted;
  now += 10'000'000;
  for (int id = 0; id < 20; ++id, now += kScan_us) {
    for (int sensor : {0, 1}) assembler.Add(MakeSlice(id, 0, 1, sensor, 99), now);
    for (const AssembledScan& scan : assembler.Poll(now)) {
      if (scan.utime_start >= kEpoch_us && scan.complete) emitted.insert(scan.scan_id);
    }
  }
  EXPECT_GE(emitted.size(), 15U);
}

INSTANTIATE_TEST_SUITE_P(Seeds, ScanAssemblerTrafficTest, testing::Range(1U, 21U));

}  // namespace
}  // namespace clearway::core
