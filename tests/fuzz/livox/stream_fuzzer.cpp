// SPDX-License-Identifier: BSD-3-Clause
// Any sequence of stamps, types, arrivals and moments at which slices are taken: slices are valid,
// ascend, and add up to what is counted; wild stamps make no flood of them.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "common/core/livox/sensor_stream.hpp"

namespace {

using namespace clearway::core::livox;

void Require(bool holds) {
  if (!holds) std::abort();
}

class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  [[nodiscard]] bool empty() const { return at_ >= size_; }
  std::uint8_t Byte() { return empty() ? std::uint8_t{0} : data_[at_++]; }
  std::uint64_t Number() {
    std::uint64_t value = 0;
    for (int i = 0; i < 8; ++i) value = value << 8U | Byte();
    return value;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
};

// What the sensor and the network do next.
struct World {
  std::uint64_t stamp_ns = 1'000'000'000;
  std::int64_t arrival_utime = 1'700'000'000'000'000;
  std::uint8_t type = 0;
  std::uint8_t data_type = 2;
  std::size_t shots = 96;
};

struct Sums {
  std::int64_t slices = 0;
  std::int64_t shots = 0;
  std::int64_t zero_returns = 0;
  std::int64_t lost_packets = 0;
};

void Collect(SensorStream& stream, std::int64_t now_utime, Sums& sums) {
  std::pair<std::int64_t, int> last{-1, -1};
  for (const StreamSlice& part : stream.Take(now_utime)) {
    Require(IsValid(part.slice));
    const std::pair place{part.slice.scan_id, part.slice.slice_index};
    // Ids may only begin again after a jump of more than a scan.
    Require(place > last || place.first < last.first);
    last = place;
    std::int32_t newest = 0;
    for (const std::int32_t offset : part.slice.cloud_sensor.time_offset_us) {
      Require(offset >= newest && offset < 100'000);
      newest = offset;
    }
    Require(part.lost_packets >= 0);
    ++sums.slices;
    sums.shots += part.slice.shots;
    sums.zero_returns += part.slice.zero_returns;
    sums.lost_packets += part.lost_packets;
  }
}

void Send(SensorStream& stream, const World& world) {
  static constexpr std::array<std::byte, kMaxDataPacketBytes> kPayload = [] {
    std::array<std::byte, kMaxDataPacketBytes> bytes{};
    for (std::size_t i = 0; i < bytes.size() / 2; ++i) bytes[i] = std::byte{1};
    return bytes;
  }();
  const DataLayout layout = *LayoutOf(world.data_type);
  const DataPacket packet{.header = {.timestamp_type = static_cast<TimestampType>(world.type),
                                     .data_type = static_cast<DataType>(world.data_type),
                                     .timestamp = world.stamp_ns},
                          .layout = layout,
                          .payload = ByteView(kPayload).first(world.shots * layout.shot_bytes),
                          .shots = world.shots};
  stream.Add(packet, world.arrival_utime);
}

void Step(SensorStream& stream, World& world, Input& input, Sums& sums) {
  switch (input.Byte() % 8) {
    case 0:  // Many packets as they should be.
    case 1:
      for (int i = input.Byte(); i > 0; --i) {
        const auto duration_us = static_cast<std::int64_t>(world.shots) * kShotPeriod_us;
        Send(stream, world);
        world.stamp_ns += static_cast<std::uint64_t>(duration_us * 1000);
        world.arrival_utime += duration_us;
        if (i % 8 == 0) Collect(stream, world.arrival_utime, sums);
      }
      break;
    case 2:  // A gap, a late packet or a copy.
      world.stamp_ns += static_cast<std::uint64_t>((input.Byte() - 128) * 960'000);
      break;
    case 3:
      world.arrival_utime += (input.Byte() - 128) * 10'000;
      break;
    case 4:
      world.stamp_ns = input.Number();
      break;
    case 5:
      world.arrival_utime = static_cast<std::int64_t>(input.Number());
      break;
    case 6:
      world.type = input.Byte() % 6;
      world.data_type = input.Byte() % 6;
      world.shots = 1 + input.Byte() % LayoutOf(world.data_type)->shots_in_packet;
      break;
    default:
      Collect(stream, static_cast<std::int64_t>(input.Number()), sums);
      break;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  SensorStream stream({});
  World world;
  Sums sums;
  for (int steps = 0; steps < 200 && !input.empty(); ++steps) Step(stream, world, input, sums);
  for (int rounds = 0; stream.NextDue(); ++rounds) {
    Require(rounds < 100'000);
    Collect(stream, *stream.NextDue(), sums);
  }

  const StreamCounts& counts = stream.counts();
  Require(counts.slices == sums.slices && counts.shots == sums.shots);
  Require(counts.zero_returns == sums.zero_returns && counts.lost_packets == sums.lost_packets);
  Require(counts.zero_returns <= counts.shots && counts.overflow_points >= 0);
  Require(counts.duplicates + counts.late_packets + counts.unfit_packets <= counts.packets);
  // A second of empty slices for each packet at the most.
  Require(counts.slices <= 110 * (counts.packets + 1));
  return 0;
}
