// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/sensor_stream.hpp"

#include <cmath>
#include <map>
#include <tuple>

#include <gtest/gtest.h>

#include "tests/unit/livox/simulated_sensor.hpp"

namespace clearway::core::livox {
namespace {

constexpr std::int64_t kSecond_us = 1'000'000;

std::int64_t ShotsOf(const SensorBehaviour& behaviour) {
  return behaviour.is_dual ? 48 : 96;
}

// Each shot's number, with how often its first echo is among the points.
std::map<std::int64_t, int> FirstEchoes(const StreamRun& run) {
  std::map<std::int64_t, int> count;
  for (const StreamSlice& part : run.slices) {
    const PointCloud& cloud = part.slice.cloud_sensor;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (cloud.tag[i] == 4) ++count[std::llround(cloud.x[i] * 1000.0F) - 1];
    }
  }
  return count;
}

void ExpectSound(const StreamRun& run, const StreamCounts& counts) {
  std::int64_t shots = 0;
  std::int64_t zeros = 0;
  std::int64_t lost = 0;
  std::pair<std::int64_t, int> last{-1, -1};
  for (const StreamSlice& part : run.slices) {
    const Slice& slice = part.slice;
    ASSERT_TRUE(IsValid(slice));
    const std::pair place{slice.scan_id, slice.slice_index};
    ASSERT_LT(last, place);
    last = place;
    const auto length =
        static_cast<std::int32_t>((slice.scan_end_utime - slice.scan_utime) / slice.slice_count);
    std::int32_t newest = length * slice.slice_index;
    for (const std::int32_t offset : slice.cloud_sensor.time_offset_us) {
      ASSERT_GE(offset, newest);
      newest = offset;
    }
    ASSERT_LT(newest, length * (slice.slice_index + 1));
    ASSERT_EQ(slice.scan_utime, slice.scan_id * 100'000);
    shots += slice.shots;
    zeros += slice.zero_returns;
    lost += part.lost_packets;
  }
  EXPECT_EQ(counts.shots, shots);
  EXPECT_EQ(counts.zero_returns, zeros);
  EXPECT_EQ(counts.lost_packets, lost);
  EXPECT_EQ(counts.slices, static_cast<std::int64_t>(run.slices.size()));
}

using LossCase = std::tuple<double, bool, bool, std::uint32_t>;
class SensorStreamLossTest : public testing::TestWithParam<LossCase> {};

TEST_P(SensorStreamLossTest, CountsExactlyWhatIsMissingAndKeepsAllThatCame) {
  const auto [loss, is_dual, is_exponential, seed] = GetParam();
  SimulatedSensor sensor({.drift_ppm = 50.0,
                          .is_exponential = is_exponential,
                          .loss = loss,
                          .duplicates = 0.05,
                          .is_dual = is_dual,
                          .seed = seed});
  SensorStream stream({});
  StreamRun run;

  Feed(stream, sensor.Send(5 * kSecond_us), run);
  Finish(stream, run);

  ExpectSound(run, stream.counts());
  const std::set<std::int64_t>& received = sensor.received();
  const std::int64_t span = *received.rbegin() - *received.begin() + 1;
  EXPECT_EQ(stream.counts().lost_packets, span - static_cast<std::int64_t>(received.size()));
  EXPECT_EQ(stream.counts().duplicates, sensor.num_duplicates());
  EXPECT_EQ(stream.counts().late_packets, 0);
  EXPECT_EQ(stream.counts().unfit_packets, 0);
  EXPECT_EQ(stream.counts().overflow_points, 0);
  const std::int64_t shots = ShotsOf(sensor.behaviour());
  EXPECT_EQ(stream.counts().shots, static_cast<std::int64_t>(received.size()) * shots);
  std::map<std::int64_t, int> expected;
  std::int64_t zeros = 0;
  for (const std::int64_t number : received) {
    for (std::int64_t id = number * shots; id < (number + 1) * shots; ++id) {
      if (id % 10 == 0) {
        ++zeros;
      } else {
        expected[id] = 1;
      }
    }
  }
  EXPECT_EQ(stream.counts().zero_returns, zeros);
  EXPECT_TRUE(FirstEchoes(run) == expected);
}

INSTANTIATE_TEST_SUITE_P(Mixes,
                         SensorStreamLossTest,
                         testing::Combine(testing::Values(0.0, 0.01, 0.05, 0.2),
                                          testing::Bool(),
                                          testing::Bool(),
                                          testing::Values(1U, 2U)));

using StampCase = std::tuple<double, bool, bool, std::uint32_t>;
class SensorStreamStampTest : public testing::TestWithParam<StampCase> {};

TEST_P(SensorStreamStampTest, KeepsStampsWithinAMillisecondOfTruthFromTheFirstScanOn) {
  const auto [drift_ppm, is_exponential, is_dual, seed] = GetParam();
  SimulatedSensor sensor({.drift_ppm = drift_ppm,
                          .is_exponential = is_exponential,
                          .max_delay_us = 40'000.0,
                          .is_dual = is_dual,
                          .seed = seed});
  DeviceClock clock({});
  std::int64_t worst_ns = 0;
  std::int64_t last_ns = 0;
  std::int64_t newest_true_ns = 0;

  for (const SentPacket& sent : sensor.Send(120 * kSecond_us)) {
    const DataPacket packet = *ParsePacket(sent.bytes).packet;
    const auto reading = clock.Observe(packet.header.timestamp_type,
                                       packet.header.timestamp,
                                       ShotsOf(sensor.behaviour()) * kShotPeriod_us,
                                       sent.arrival_utime);
    ASSERT_TRUE(reading.is_usable);
    if (!clock.is_settled()) continue;
    worst_ns = std::max(worst_ns, std::abs(reading.utime_ns - sent.true_ns));
    if (sent.true_ns < newest_true_ns) continue;
    ASSERT_GT(reading.utime_ns, last_ns);
    last_ns = reading.utime_ns;
    newest_true_ns = sent.true_ns;
  }

  EXPECT_LT(worst_ns, 1'000'000);
  EXPECT_NEAR(clock.drift_ppm().value_or(1e9), drift_ppm, 3.0);
  EXPECT_EQ(clock.steps() + clock.resets(), 0);
  RecordProperty("worst_us", static_cast<int>(worst_ns / 1000));
}

INSTANTIATE_TEST_SUITE_P(DriftsAndJitters,
                         SensorStreamStampTest,
                         testing::Combine(testing::Values(-50.0, 0.0, 50.0),
                                          testing::Bool(),
                                          testing::Bool(),
                                          testing::Values(1U, 2U, 3U)));

// Slices with shots, between the first and the last.
std::int64_t NumMissingScans(const StreamRun& run) {
  std::map<std::int64_t, std::int64_t> shots;
  for (const StreamSlice& part : run.slices) shots[part.slice.scan_id] += part.slice.shots;
  std::int64_t missing = 0;
  for (std::int64_t id = shots.begin()->first + 1; id < shots.rbegin()->first; ++id) {
    if (shots[id] < 9'900) ++missing;
  }
  return missing;
}

TEST(SensorStreamJumpTest, LosesNoMoreThanAScanWhenTheSensorsClockStartsAnew) {
  SimulatedSensor sensor({});
  SensorStream stream({});
  StreamRun run;

  Feed(stream, sensor.Send(3 * kSecond_us, 1'000'000'000'000), run);
  Feed(stream, sensor.Send(3 * kSecond_us, 5'000), run);
  Finish(stream, run);

  EXPECT_EQ(run.events, (std::vector{ClockEvent::kStarted, ClockEvent::kReset}));
  EXPECT_EQ(stream.clock().resets(), 1);
  EXPECT_LE(NumMissingScans(run), 1);
  EXPECT_EQ(stream.counts().lost_packets, 0);
  ExpectSound(run, stream.counts());
}

class SensorStreamHostStepTest : public testing::TestWithParam<std::int64_t> {};

TEST_P(SensorStreamHostStepTest, FollowsTheHostsClockWhenThatIsSet) {
  SimulatedSensor sensor({.drift_ppm = -30.0});
  SensorStream stream({});
  StreamRun run;
  Feed(stream, sensor.Send(5 * kSecond_us), run);
  const std::int64_t id_before = run.slices.back().slice.scan_id;
  const std::vector<SentPacket> after = sensor.Send(4 * kSecond_us, 12'000'000'123);

  Feed(stream, after, run, GetParam());

  const std::int64_t end_us = sensor.now_us() + GetParam();
  EXPECT_NEAR(static_cast<double>(run.slices.back().slice.scan_end_utime),
              static_cast<double>(end_us),
              150e3);
  EXPECT_NE(run.slices.back().slice.scan_id, id_before);
  EXPECT_EQ(stream.clock().steps(), std::abs(GetParam()) > DeviceClock::kStep_us ? 1 : 0);
  EXPECT_LT(stream.counts().unfit_packets + stream.counts().late_packets, 110);
}

INSTANTIATE_TEST_SUITE_P(Steps,
                         SensorStreamHostStepTest,
                         testing::Values(-3600 * kSecond_us,
                                         -kSecond_us,
                                         -5'000,
                                         5'000,
                                         100'000,
                                         kSecond_us,
                                         3600 * kSecond_us));

TEST(SensorStreamSourceTest, TakesPtpStampsAsTheyAreWhileTheyArePlausible) {
  for (const TimestampType type : {TimestampType::kPtp, TimestampType::kGps}) {
    SimulatedSensor sensor({.type = type, .stamp_offset_ns = 10'000'000});
    DeviceClock clock({});

    for (const SentPacket& sent : sensor.Send(kSecond_us)) {
      const DataHeader header = ParsePacket(sent.bytes).packet->header;
      const auto reading = clock.Observe(type, header.timestamp, 960, sent.arrival_utime);
      if (!clock.is_settled()) continue;
      EXPECT_NEAR(static_cast<double>(reading.utime_ns - sent.true_ns), 10e6, 1001.0);
    }

    EXPECT_EQ(clock.source(), type == TimestampType::kPtp ? TimeSource::kPtp : TimeSource::kGps);
    EXPECT_EQ(clock.implausible(), 0);
  }
}

TEST(SensorStreamSourceTest, MapsPtpStampsThatAreFarFromTheHostsClock) {
  SimulatedSensor sensor({.type = TimestampType::kPtp, .stamp_offset_ns = 37'000'000'000});
  SensorStream stream({});
  StreamRun run;

  Feed(stream, sensor.Send(2 * kSecond_us), run);
  Finish(stream, run);

  EXPECT_EQ(stream.clock().source(), TimeSource::kDevice);
  EXPECT_GT(stream.clock().implausible(), 1900);
  EXPECT_NEAR(static_cast<double>(run.slices.front().slice.scan_utime),
              static_cast<double>(kSimulationStart_us),
              101e3);
  ExpectSound(run, stream.counts());
}

TEST(SensorStreamSourceTest, GoesOverToPtpWhenTheSensorLocksAndLosesNoMoreThanAScan) {
  SimulatedSensor sensor({});
  SensorStream stream({});
  StreamRun run;
  Feed(stream, sensor.Send(3 * kSecond_us), run);
  sensor.behaviour().type = TimestampType::kPtp;

  Feed(stream, sensor.Send(3 * kSecond_us), run);
  Finish(stream, run);

  EXPECT_EQ(run.events, (std::vector{ClockEvent::kStarted, ClockEvent::kSourceChanged}));
  EXPECT_EQ(stream.clock().source(), TimeSource::kPtp);
  EXPECT_LE(NumMissingScans(run), 1);
  ExpectSound(run, stream.counts());
}

TEST(SensorStreamSourceTest, CountsOnOverThePulsesThatStampsStartAnewWith) {
  SimulatedSensor sensor({.loss = 0.05, .type = TimestampType::kPps, .seed = 4});
  SensorStream stream({});
  StreamRun run;

  Feed(stream, sensor.Send(5 * kSecond_us), run);
  Finish(stream, run);

  const std::set<std::int64_t>& received = sensor.received();
  EXPECT_EQ(
      stream.counts().lost_packets,
      *received.rbegin() - *received.begin() + 1 - static_cast<std::int64_t>(received.size()));
  EXPECT_EQ(stream.clock().resets() + stream.clock().steps(), 0);
  ExpectSound(run, stream.counts());
}

TEST(SensorStreamSourceTest, FallsBackToArrivalWhenGpsStampsStateNoMoment) {
  SimulatedSensor sensor({.jitter_us = 100.0});
  SensorStream stream({});
  StreamRun run;
  std::vector<SentPacket> packets = sensor.Send(2 * kSecond_us);
  for (SentPacket& sent : packets) {
    sent.bytes[8] = static_cast<std::byte>(TimestampType::kGps);
    Store(std::span(sent.bytes), 10, std::uint64_t{0});
  }

  Feed(stream, packets, run);
  Finish(stream, run);

  EXPECT_EQ(stream.clock().source(), TimeSource::kHost);
  EXPECT_EQ(stream.counts().shots, static_cast<std::int64_t>(packets.size()) * 96);
  EXPECT_EQ(stream.counts().lost_packets, 0);
  ExpectSound(run, stream.counts());
}

TEST(SensorStreamSilenceTest, SendsEmptySlicesOnlyWithinAStream) {
  SimulatedSensor sensor({.jitter_us = 100.0});
  SensorStream stream({});
  StreamRun run;
  std::vector<SentPacket> packets = sensor.Send(kSecond_us);
  packets.erase(packets.begin() + 500, packets.begin() + 600);

  Feed(stream, packets, run);
  Finish(stream, run);

  std::int64_t empty = 0;
  for (const StreamSlice& part : run.slices) empty += part.slice.shots == 0 ? 1 : 0;
  EXPECT_GE(empty, 8);
  EXPECT_LE(empty, 9);
  EXPECT_EQ(stream.counts().lost_packets, 100);
  EXPECT_GT(run.slices.back().slice.shots, 0);
  EXPECT_FALSE(stream.NextDue());
  ExpectSound(run, stream.counts());
}

TEST(SensorStreamSilenceTest, CountsALongSilenceAsAPauseAndNotAsLoss) {
  SimulatedSensor sensor({});
  SensorStream stream({});
  StreamRun run;
  Feed(stream, sensor.Send(kSecond_us, 0), run);
  sensor.Wait(30 * kSecond_us);

  Feed(stream, sensor.Send(kSecond_us, 30'999'360'000), run);
  Finish(stream, run);

  EXPECT_EQ(stream.counts().pauses, 1);
  EXPECT_EQ(stream.counts().lost_packets, 0);
  EXPECT_LT(run.slices.size(), 210U);
  ExpectSound(run, stream.counts());
}

TEST(SensorStreamLateTest, CountsALatePacketAsLateAndItsLossStays) {
  SimulatedSensor sensor({.jitter_us = 100.0});
  SensorStream stream({});
  StreamRun run;
  std::vector<SentPacket> packets = sensor.Send(kSecond_us);
  SentPacket late = packets[500];
  late.arrival_utime += 60'000;
  packets.erase(packets.begin() + 500);
  const auto place = std::find_if(packets.begin(), packets.end(), [&](const SentPacket& other) {
    return other.arrival_utime > late.arrival_utime;
  });
  packets.insert(place, {late, late});

  Feed(stream, packets, run);
  Finish(stream, run);

  EXPECT_EQ(stream.counts().late_packets, 1);
  EXPECT_EQ(stream.counts().duplicates, 1);
  EXPECT_EQ(stream.counts().lost_packets, 1);
  ExpectSound(run, stream.counts());
}

TEST(SensorStreamLateTest, LeavesOutASingleWildStamp) {
  SimulatedSensor sensor({});
  SensorStream stream({});
  StreamRun run;
  std::vector<SentPacket> packets = sensor.Send(kSecond_us);
  for (const std::size_t i : {300U, 400U, 500U}) {
    Store(std::span(packets[i].bytes), 10, std::uint64_t{1} << (20U + i / 25U));
  }

  Feed(stream, packets, run);
  Finish(stream, run);

  EXPECT_EQ(stream.counts().unfit_packets, 3);
  EXPECT_EQ(stream.counts().lost_packets, 3);
  EXPECT_LT(run.slices.size(), 105U);
  ExpectSound(run, stream.counts());
}

TEST(SensorStreamTimeTest, LetsNoSliceLeaveLaterThanItsGrace) {
  SimulatedSensor sensor({.loss = 0.2, .seed = 9});
  const StreamConfig config;
  SensorStream stream(config);
  StreamRun settled;
  Feed(stream, sensor.Send(kSecond_us / 2, 0), settled);

  for (const SentPacket& sent : sensor.Send(3 * kSecond_us, 500'160'000)) {
    while (stream.NextDue() && *stream.NextDue() <= sent.arrival_utime) {
      const std::int64_t now = *stream.NextDue();
      for (const StreamSlice& part : stream.Take(now)) {
        const std::int64_t end_us =
            part.slice.scan_utime + (part.slice.slice_index + 1) * config.slice_us;
        EXPECT_LE(now, end_us + config.slice_grace_us);
      }
    }
    stream.Add(*ParsePacket(sent.bytes).packet, sent.arrival_utime);
  }
}

TEST(SensorStreamTimeTest, MakesSlicesShorterWhereTheyWouldNotHoldDualReturn) {
  SimulatedSensor sensor({.is_dual = true});
  SensorStream stream({.max_points = 700, .clock = {}});
  StreamRun run;

  Feed(stream, sensor.Send(kSecond_us), run);
  Finish(stream, run);

  EXPECT_GT(run.slices.front().slice.slice_count, 28);
  EXPECT_EQ(stream.counts().overflow_points, 0);
  for (const StreamSlice& part : run.slices) {
    EXPECT_TRUE(part.is_dual);
    EXPECT_LE(part.slice.cloud_sensor.size(), 700U);
  }
}

}  // namespace
}  // namespace clearway::core::livox
