// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/sensor_stream.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "common/core/livox/held_packets.hpp"
#include "common/core/livox/packet_ledger.hpp"
#include "common/core/livox/slice_buffer.hpp"
#include "common/core/livox/slice_grid.hpp"

namespace clearway::core::livox {
namespace {

constexpr std::int64_t kNsPerUs = 1000;
constexpr std::int64_t kMaxUtime = 4'000'000'000'000'000;  // The year 2096.
constexpr std::int64_t kNoSlice = -1;
constexpr std::int64_t kForever_ns = std::int64_t{1} << 62;
// More slices than this without a packet are passed over.
constexpr std::int64_t kMaxOpen = 256;
// Shots are placed on whole microseconds.
constexpr std::int64_t kRounding_ns = 1000;

}  // namespace

struct SensorStream::State {
  struct Open {
    SliceBuffer buffer;
    bool is_dual = false;
    std::int64_t end_ns = 0;  // On the ledger's clock, as mapped when it was opened.
    TimeSource source = TimeSource::kUnknown;
  };

  explicit State(const StreamConfig& stream_config)
      : config(stream_config),
        grid(config.scan_period_us, config.slice_us, config.max_points),
        clock(config.clock) {}

  void Break(std::int64_t arrival_utime);
  void Hold(const DataPacket& packet, std::uint64_t device_ns, bool is_reordered);
  void Release();
  void StartOrder(std::uint64_t device_ns);
  void Insert(const DataPacket& packet, const DeviceClock::Reading& reading, bool is_reordered);
  void Place(const DataPacket& packet, std::int64_t utime);
  void MakeRoom(std::int64_t first, std::int64_t last, std::int64_t stamp_ns);
  void OpenUntil(std::int64_t slice);
  void CloseAll();
  [[nodiscard]] std::int64_t Stamp(std::uint64_t device_ns) const {
    return static_cast<std::int64_t>(device_ns - base_device_ns);
  }
  [[nodiscard]] std::int64_t EndStamp(std::int64_t slice) const {
    return Stamp(clock.ToDevice(grid.Start_us(slice + 1) * kNsPerUs));
  }
  [[nodiscard]] bool IsWhole(std::int64_t end_ns) const {
    return !ledger.empty() && ledger.accounted_ns() >= end_ns - kRounding_ns;
  }
  [[nodiscard]] std::int64_t DueAt(std::int64_t slice) const {
    return grid.Start_us(slice + 1) + config.slice_grace_us + clock.lag_us();
  }
  void Emit(Open& part, std::int64_t slice, std::int64_t lost);
  void Drop(std::size_t num_gone);

  StreamConfig config;
  SliceGrid grid;
  DeviceClock clock;
  PacketLedger ledger;
  HeldPackets held;
  std::int64_t held_since = 0;
  StreamCounts counts;
  std::uint64_t base_device_ns = 0;    // Stamp of the ledger's zero.
  std::uint64_t newest_device_ns = 0;  // Of what arrived since then.
  std::int64_t next = kNoSlice;        // The oldest slice that has not gone.
  std::vector<Open> open;              // Slices next, next + 1, ...; the rest are spare.
  std::size_t num_open = 0;
  std::vector<StreamSlice> ready;
  bool is_dual = false;
};

// The clock begins anew: what is open belongs to what was before.
void SensorStream::State::Break(std::int64_t arrival_utime) {
  CloseAll();
  counts.unfit_packets += static_cast<std::int64_t>(held.size());
  held.Clear();
  held_since = arrival_utime;
}

void SensorStream::State::Hold(const DataPacket& packet,
                               std::uint64_t device_ns,
                               bool is_reordered) {
  held.Push(packet, device_ns, is_reordered);
  if (held.full()) clock.Settle();
  if (clock.is_settled()) Release();
}

// The time of what was held is known now.
void SensorStream::State::Release() {
  const std::vector<const HeldPackets::Held*> order = held.InOrder();
  StartOrder(order.front()->device_ns);
  for (const HeldPackets::Held* packet : order) {
    Insert(packet->packet,
           {.utime_ns = clock.ToHost(packet->device_ns),
            .device_ns = packet->device_ns,
            .is_device_stamp = clock.source() != TimeSource::kHost},
           packet->is_reordered);
  }
  held.Clear();
}

void SensorStream::State::StartOrder(std::uint64_t device_ns) {
  ledger.Clear();
  base_device_ns = device_ns;
  const std::int64_t utime = clock.ToHost(device_ns) / kNsPerUs;
  const std::int64_t slice = grid.SliceAt(std::max<std::int64_t>(0, utime));
  if (next == kNoSlice || slice >= next || next - slice > grid.count()) {
    next = slice;
  } else {
    ledger.Close(EndStamp(next - 1));
  }
}

void SensorStream::State::Insert(const DataPacket& packet,
                                 const DeviceClock::Reading& reading,
                                 bool is_reordered) {
  const std::int64_t stamp_ns = Stamp(reading.device_ns);
  const std::int64_t duration_us = static_cast<std::int64_t>(packet.shots) * kShotPeriod_us;
  const std::int64_t utime = reading.utime_ns / kNsPerUs;
  if (reading.utime_ns < 0 || utime > kMaxUtime) {
    ++counts.unfit_packets;
    return;
  }
  if (reading.is_device_stamp) {
    const PacketVerdict verdict = ledger.Judge(stamp_ns);
    if (verdict == PacketVerdict::kDuplicate) {
      ++counts.duplicates;
      return;
    }
    if (verdict == PacketVerdict::kLate) {
      ++counts.late_packets;
      ledger.Add(stamp_ns, duration_us * kNsPerUs);
      return;
    }
  } else if (ledger.IsClosed(stamp_ns)) {
    ++counts.late_packets;
    return;
  }
  if (is_reordered) ++counts.reordered;
  MakeRoom(grid.SliceAt(utime), grid.SliceAt(utime + duration_us), stamp_ns);
  if (reading.is_device_stamp) {
    ledger.Add(stamp_ns, duration_us * kNsPerUs);
  } else {
    ledger.AddUnstamped(stamp_ns, duration_us * kNsPerUs);
  }
  Place(packet, utime);
}

// What is far from all that is open lets that go first.
void SensorStream::State::MakeRoom(std::int64_t first, std::int64_t last, std::int64_t stamp_ns) {
  const bool is_pause =
      !ledger.empty() && stamp_ns - ledger.newest_end_ns() > kMaxGap_us * kNsPerUs;
  if (!is_pause && last - next < kMaxOpen) return;
  CloseAll();
  next = std::max(next, first);
  if (!is_pause) return;
  ledger.SkipTo(stamp_ns);
  ++counts.pauses;
}

void SensorStream::State::OpenUntil(std::int64_t slice) {
  while (next + static_cast<std::int64_t>(num_open) <= slice) {
    if (num_open == open.size()) {
      open.push_back({.buffer = SliceBuffer(static_cast<std::size_t>(config.max_points))});
    }
    open[num_open].buffer.Clear();
    open[num_open].is_dual = is_dual;
    open[num_open].end_ns = EndStamp(next + static_cast<std::int64_t>(num_open));
    open[num_open].source = clock.source();
    ++num_open;
  }
}

// Puts each shot into its slice.
void SensorStream::State::Place(const DataPacket& packet, std::int64_t utime) {
  std::array<Point, kMaxPointsInPacket> points;
  DecodePoints(packet, points);
  const std::size_t echoes = packet.layout.echoes;
  is_dual = echoes == 2;
  // The mapping is slewed, so that a shot just after a border may lie just before it afterwards.
  utime = std::max(utime, grid.Start_us(next));
  for (std::size_t shot = 0; shot < packet.shots;) {
    const std::int64_t slice = grid.SliceAt(utime);
    const std::int64_t until_end =
        (grid.Start_us(slice + 1) - utime + kShotPeriod_us - 1) / kShotPeriod_us;
    const std::size_t n = std::min(packet.shots - shot, static_cast<std::size_t>(until_end));
    OpenUntil(slice);
    Open& part = open[static_cast<std::size_t>(slice - next)];
    part.is_dual = is_dual;
    part.source = clock.source();
    const std::int64_t zeros_before = part.buffer.zero_returns();
    const std::int64_t overflow_before = part.buffer.overflow_points();
    part.buffer.Add(std::span(points).subspan(shot * echoes, n * echoes),
                    echoes,
                    static_cast<std::int32_t>(utime - grid.ScanStart_us(slice)));
    counts.shots += static_cast<std::int64_t>(n);
    counts.zero_returns += part.buffer.zero_returns() - zeros_before;
    counts.overflow_points += part.buffer.overflow_points() - overflow_before;
    shot += n;
    utime += static_cast<std::int64_t>(n) * kShotPeriod_us;
  }
}

void SensorStream::State::Emit(Open& part, std::int64_t slice, std::int64_t lost) {
  StreamSlice out;
  out.slice.scan_id = grid.ScanOf(slice);
  out.slice.scan_utime = grid.ScanStart_us(slice);
  out.slice.scan_end_utime = out.slice.scan_utime + config.scan_period_us;
  out.slice.slice_index = static_cast<int>(grid.IndexInScan(slice));
  out.slice.slice_count = static_cast<int>(grid.count());
  out.slice.shots = part.buffer.shots();
  out.slice.zero_returns = part.buffer.zero_returns();
  out.slice.cloud_sensor = part.buffer.Cloud();
  out.lost_packets = lost;
  out.time_source = part.source;
  out.is_dual = part.is_dual;
  ready.push_back(std::move(out));
  counts.lost_packets += lost;
  ++counts.slices;
}

// The first `num_gone` open slices have left; their memory becomes spare.
void SensorStream::State::Drop(std::size_t num_gone) {
  std::rotate(open.begin(),
              open.begin() + static_cast<std::ptrdiff_t>(num_gone),
              open.begin() + static_cast<std::ptrdiff_t>(num_open));
  num_open -= num_gone;
  next += static_cast<std::int64_t>(num_gone);
}

// Lets all open slices go as they are.
void SensorStream::State::CloseAll() {
  for (std::size_t i = 0; i < num_open; ++i) {
    const std::int64_t until_ns = i + 1 == num_open ? kForever_ns : open[i].end_ns;
    const std::int64_t lost = ledger.DeclareLost(until_ns);
    Emit(open[i], next + static_cast<std::int64_t>(i), lost);
  }
  Drop(num_open);
}

SensorStream::SensorStream(const StreamConfig& config) : state_(std::make_unique<State>(config)) {}
SensorStream::~SensorStream() = default;

ClockEvent SensorStream::Add(const DataPacket& packet, std::int64_t arrival_utime) {
  State& state = *state_;
  ++state.counts.packets;
  if (packet.shots == 0 || arrival_utime < 0 || arrival_utime > kMaxUtime) {
    ++state.counts.unfit_packets;
    return ClockEvent::kNone;
  }
  const DeviceClock::Reading reading =
      state.clock.Observe(packet.header.timestamp_type,
                          packet.header.timestamp,
                          static_cast<std::int64_t>(packet.shots) * kShotPeriod_us,
                          arrival_utime);
  if (!reading.is_usable) {
    ++state.counts.unfit_packets;
    return reading.event;
  }
  const bool begins = reading.event != ClockEvent::kNone && !state.clock.is_settled();
  if (begins) state.Break(arrival_utime);
  const bool is_reordered =
      !begins && static_cast<std::int64_t>(reading.device_ns - state.newest_device_ns) < 0;
  if (!is_reordered) state.newest_device_ns = reading.device_ns;
  if (!state.clock.is_settled() || !state.held.empty()) {
    state.Hold(packet, reading.device_ns, is_reordered);
  } else {
    state.Insert(packet, reading, is_reordered);
  }
  return reading.event;
}

std::vector<StreamSlice> SensorStream::Take(std::int64_t now_utime) {
  State& state = *state_;
  if (!state.held.empty() && now_utime >= state.held_since + DeviceClock::kMaxSettle_us) {
    state.clock.Settle();
    state.Release();
  }
  std::size_t num_gone = 0;
  for (; num_gone < state.num_open; ++num_gone) {
    State::Open& part = state.open[num_gone];
    const std::int64_t slice = state.next + static_cast<std::int64_t>(num_gone);
    const std::int64_t end_ns = state.EndStamp(slice);
    std::int64_t lost = 0;
    if (!state.IsWhole(end_ns)) {
      if (now_utime < state.DueAt(slice)) break;
      lost = state.ledger.DeclareLost(end_ns);
      if (!state.IsWhole(end_ns)) state.ledger.Close(end_ns);
    }
    state.Emit(part, slice, lost);
  }
  state.Drop(num_gone);
  return std::exchange(state.ready, {});
}

std::optional<std::int64_t> SensorStream::NextDue() const {
  const State& state = *state_;
  if (!state.ready.empty()) return 0;
  if (!state.held.empty()) return state.held_since + DeviceClock::kMaxSettle_us;
  if (state.num_open == 0) return std::nullopt;
  if (state.IsWhole(state.EndStamp(state.next))) return state.grid.Start_us(state.next + 1);
  return state.DueAt(state.next);
}

void SensorStream::Restart() {
  State& state = *state_;
  state.clock.Restart();
  state.ledger.Clear();
  state.counts.unfit_packets += static_cast<std::int64_t>(state.held.size());
  state.held.Clear();
  state.ready.clear();
  state.num_open = 0;
}

const StreamCounts& SensorStream::counts() const {
  return state_->counts;
}

const DeviceClock& SensorStream::clock() const {
  return state_->clock;
}

}  // namespace clearway::core::livox
