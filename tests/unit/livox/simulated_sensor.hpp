// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "common/core/livox/data_packet.hpp"
#include "common/core/livox/sensor_stream.hpp"

namespace clearway::core::livox {

/// How a simulated sensor and its network behave.
struct SensorBehaviour {
  double drift_ppm = 0.0;  ///< The sensor's clock is faster by this.
  double jitter_us = 5000.0;
  bool is_exponential = false;  ///< Else uniform in [0, jitter_us].
  double loss = 0.0;
  double duplicates = 0.0;
  double max_delay_us = 12'000.0;  ///< Of any packet: below the grace time of a slice.
  bool is_dual = false;
  TimestampType type = TimestampType::kNoSync;
  std::int64_t stamp_offset_ns = 0;  ///< PTP and GPS: ahead of the host by this.
  std::uint32_t seed = 1;
};

/// A packet on its way.
struct SentPacket {
  std::int64_t arrival_utime = 0;
  std::int64_t true_ns = 0;  ///< Host time of the first shot.
  std::int64_t number = 0;
  Bytes bytes;
};

inline constexpr std::int64_t kSimulationStart_us = 1'700'000'000'034'567;

/// The packets of a sensor in order of arrival. Each shot can be told by its number: it stands in
/// x [mm] of the first echo. Every tenth shot does not return, a seventh of the second echoes is
/// absent.
class SimulatedSensor {
 public:
  explicit SimulatedSensor(const SensorBehaviour& behaviour)
      : behaviour_(behaviour), random_(behaviour.seed) {}

  /// Sends what is sent until `duration_us` after now; the sensor's clock shows `uptime_ns` at
  /// first.
  std::vector<SentPacket> Send(std::int64_t duration_us, std::int64_t uptime_ns = 7'000'000'123) {
    std::vector<SentPacket> sent;
    const std::int64_t shots = behaviour_.is_dual ? 48 : 96;
    const double device_rate = 1.0 + behaviour_.drift_ppm * 1e-6;
    const std::int64_t count = duration_us / (shots * kShotPeriod_us);
    const std::int64_t begin_ns = now_ns_;
    for (std::int64_t i = 0; i < count; ++i) {
      const std::int64_t since_device_ns = i * shots * kShotPeriod_us * 1000;
      const auto true_ns =
          begin_ns + static_cast<std::int64_t>(static_cast<double>(since_device_ns) / device_rate);
      const std::int64_t number = num_sent_++;
      if (Chance(behaviour_.loss)) continue;
      received_.insert(number);
      SentPacket packet{.arrival_utime = Arrival(true_ns, shots),
                        .true_ns = true_ns,
                        .number = number,
                        .bytes = Pack(uptime_ns + since_device_ns, true_ns, number, shots)};
      if (Chance(behaviour_.duplicates)) {
        SentPacket copy = packet;
        copy.arrival_utime = Arrival(true_ns, shots);
        sent.push_back(copy);
        ++num_duplicates_;
      }
      sent.push_back(std::move(packet));
    }
    now_ns_ =
        begin_ns + static_cast<std::int64_t>(
                       static_cast<double>(count * shots * kShotPeriod_us * 1000) / device_rate);
    std::stable_sort(sent.begin(), sent.end(), [](const SentPacket& a, const SentPacket& b) {
      return a.arrival_utime < b.arrival_utime;
    });
    return sent;
  }
  void Wait(std::int64_t duration_us) { now_ns_ += duration_us * 1000; }

  [[nodiscard]] std::int64_t num_sent() const { return num_sent_; }
  [[nodiscard]] std::int64_t num_duplicates() const { return num_duplicates_; }
  [[nodiscard]] const std::set<std::int64_t>& received() const { return received_; }
  [[nodiscard]] SensorBehaviour& behaviour() { return behaviour_; }
  [[nodiscard]] std::int64_t now_us() const { return now_ns_ / 1000; }

 private:
  bool Chance(double p) { return std::uniform_real_distribution<>(0.0, 1.0)(random_) < p; }

  std::int64_t Arrival(std::int64_t true_ns, std::int64_t shots) {
    double delay_us = std::uniform_real_distribution<>(0.0, behaviour_.jitter_us)(random_);
    if (behaviour_.is_exponential) {
      delay_us = std::exponential_distribution<>(1.0 / behaviour_.jitter_us)(random_);
    }
    delay_us = std::min(delay_us, behaviour_.max_delay_us);
    return true_ns / 1000 + shots * kShotPeriod_us + static_cast<std::int64_t>(delay_us);
  }

  [[nodiscard]] Bytes Pack(std::int64_t uptime_ns,
                           std::int64_t true_ns,
                           std::int64_t number,
                           std::int64_t shots) const {
    std::vector<WirePoint> points;
    for (std::int64_t shot = 0; shot < shots; ++shot) {
      const std::int64_t id = number * shots + shot;
      const bool returns = id % 10 != 0;
      const auto x = static_cast<std::int32_t>(id + 1);
      points.push_back(returns ? WirePoint{x, 1, 2, 3, 4} : WirePoint{});
      if (!behaviour_.is_dual) continue;
      points.push_back(returns && id % 7 != 0 ? WirePoint{x, 5, 6, 7, 8} : WirePoint{});
    }
    DataHeader header{
        .timestamp_type = behaviour_.type,
        .data_type = behaviour_.is_dual ? DataType::kDualCartesian : DataType::kExtendedCartesian};
    header.timestamp = static_cast<std::uint64_t>(uptime_ns);
    const std::int64_t absolute_ns = true_ns + behaviour_.stamp_offset_ns;
    if (behaviour_.type == TimestampType::kPtp) {
      header.timestamp = static_cast<std::uint64_t>(absolute_ns);
    }
    if (behaviour_.type == TimestampType::kGps) header.timestamp = ToGpsTimestamp(absolute_ns);
    if (behaviour_.type == TimestampType::kPps) header.timestamp %= 1'000'000'000;
    return PackPacket(header, points);
  }

  SensorBehaviour behaviour_;
  std::mt19937 random_;
  std::int64_t now_ns_ = kSimulationStart_us * 1000;
  std::int64_t num_sent_ = 0;
  std::int64_t num_duplicates_ = 0;
  std::set<std::int64_t> received_;
};

/// What a stream made of packets.
struct StreamRun {
  std::vector<StreamSlice> slices;
  std::vector<ClockEvent> events;  ///< Without kNone.
};

/// Gives the packets to the stream as a driver does: each at its time, slices taken after each.
inline void Feed(SensorStream& stream,
                 const std::vector<SentPacket>& packets,
                 StreamRun& run,
                 std::int64_t host_step_us = 0) {
  const auto take = [&](std::int64_t now) {
    for (StreamSlice& slice : stream.Take(now)) run.slices.push_back(std::move(slice));
  };
  for (const SentPacket& sent : packets) {
    const std::int64_t now = sent.arrival_utime + host_step_us;
    while (stream.NextDue() && *stream.NextDue() < now) take(*stream.NextDue());
    const ParsedPacket parsed = ParsePacket(sent.bytes);
    const ClockEvent event = stream.Add(*parsed.packet, now);
    if (event != ClockEvent::kNone) run.events.push_back(event);
    take(now);
  }
}

/// Lets all that waits go.
inline void Finish(SensorStream& stream, StreamRun& run) {
  while (stream.NextDue()) {
    for (StreamSlice& slice : stream.Take(*stream.NextDue())) run.slices.push_back(slice);
  }
}

}  // namespace clearway::core::livox
