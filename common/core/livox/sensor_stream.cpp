// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/sensor_stream.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

namespace clearway::core::livox {
namespace {

constexpr std::int64_t kNsPerUs = 1000;
constexpr std::int64_t kMaxPointsPerShot = 2;
// Time that goes back by more than this began anew, as ScanAssembler takes it.
constexpr std::int64_t kBeganAnew_us = 2'000'000;
// The clock settles within 0.25 s: 521 packets of dual return.
constexpr std::size_t kMaxHeld = 640;

std::int64_t FloorDiv(std::int64_t a, std::int64_t b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

// Slices of a scan: as many as slice_us asks for, more where points would not fit.
std::int64_t SlicesInScan(const StreamConfig& config) {
  const std::int64_t by_time = std::max<std::int64_t>(config.scan_period_us / config.slice_us, 1);
  const std::int64_t points = config.scan_period_us / kShotPeriod_us * kMaxPointsPerShot;
  const std::int64_t capacity = std::max(config.max_points - 2, 1);
  return std::clamp<std::int64_t>(
      std::max(by_time, (points + capacity - 1) / capacity), 1, kMaxSlices);
}

void SortByTime(PointCloud& cloud) {
  std::vector<std::size_t> order(cloud.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&cloud](std::size_t a, std::size_t b) {
    return cloud.time_offset_us[a] < cloud.time_offset_us[b];
  });
  PointCloud sorted;
  sorted.Reserve(cloud.size());
  for (const std::size_t i : order) sorted.AddFrom(cloud, i);
  cloud = std::move(sorted);
}

}  // namespace

SensorStream::SensorStream(const StreamConfig& config)
    : config_(config),
      slices_in_scan_(SlicesInScan(config)),
      clock_(config.clock),
      held_(kMaxHeld) {}

std::int64_t SensorStream::NumberOf(std::int64_t utime) const {
  const std::int64_t scan = FloorDiv(utime, config_.scan_period_us);
  const std::int64_t offset_us = utime - scan * config_.scan_period_us;
  return scan * slices_in_scan_ + offset_us * slices_in_scan_ / config_.scan_period_us;
}

// The first moment whose NumberOf() is `number`.
std::int64_t SensorStream::BeginOf(std::int64_t number) const {
  const std::int64_t scan = FloorDiv(number, slices_in_scan_);
  const std::int64_t index = number - scan * slices_in_scan_;
  return scan * config_.scan_period_us +
         (index * config_.scan_period_us + slices_in_scan_ - 1) / slices_in_scan_;
}

void SensorStream::Add(const DataPacket& packet, std::int64_t arrival_utime) {
  ++counts_.packets;
  const std::int64_t duration_us = static_cast<std::int64_t>(packet.shots) * kShotPeriod_us;
  const DeviceClock::Reading reading = clock_.Observe(
      packet.header.timestamp_type, packet.header.timestamp, duration_us, arrival_utime);
  const bool begins = reading.event != ClockEvent::kNone && !clock_.is_settled();
  if (begins) BeginAnew();
  if (!reading.is_usable) {
    ++counts_.misfits;
    return;
  }
  if (!clock_.is_settled()) {
    Hold(packet, reading, arrival_utime);
    return;
  }
  ReleaseHeld();
  Place(packet, reading.device_ns, reading.is_device_stamp);
}

// The clock has begun anew: nothing that follows has to do with what was before, and what still
// waited for it can no longer be placed.
void SensorStream::BeginAnew() {
  counts_.misfits += static_cast<std::int64_t>(std::exchange(num_held_, 0));
  if (!open_.empty()) LeaveUpTo(open_.back().number + 1, due_);
  counts_.lost_packets += gaps_.Restart();
}

void SensorStream::Hold(const DataPacket& packet,
                        const DeviceClock::Reading& reading,
                        std::int64_t arrival) {
  if (num_held_ == kMaxHeld) {
    clock_.Settle();
    ReleaseHeld();
  }
  if (num_held_ == 0) first_held_utime_ = arrival;
  Held& held = held_[num_held_++];
  held.packet = packet;
  held.device_ns = reading.device_ns;
  held.is_device_stamp = reading.is_device_stamp;
  held.payload.assign(packet.payload.begin(), packet.payload.end());
  held.packet.payload = held.payload;
}

void SensorStream::ReleaseHeld() {
  const std::size_t count = std::exchange(num_held_, 0);
  for (std::size_t i = 0; i < count; ++i) {
    Place(held_[i].packet, held_[i].device_ns, held_[i].is_device_stamp);
  }
}

void SensorStream::Place(const DataPacket& packet, std::uint64_t device_ns, bool is_device_stamp) {
  const std::int64_t utime_ns = clock_.ToHost(device_ns);
  if (next_number_ && utime_ns / kNsPerUs < BeginOf(*next_number_) - kBeganAnew_us) {
    next_number_.reset();
    reached_utime_ = 0;
  }
  const std::int64_t duration_us = static_cast<std::int64_t>(packet.shots) * kShotPeriod_us;
  const std::int64_t given_up_utime =
      next_number_ ? BeginOf(*next_number_) : std::numeric_limits<std::int64_t>::min() / kNsPerUs;
  if (is_device_stamp) {
    switch (gaps_.Observe(device_ns, duration_us * kNsPerUs, utime_ns, given_up_utime)) {
      case PacketGaps::Verdict::kNext:
        break;
      case PacketGaps::Verdict::kFilled:
        ++counts_.reordered;
        break;
      case PacketGaps::Verdict::kLate:
        ++counts_.late_packets;
        return;
      case PacketGaps::Verdict::kDuplicate:
        ++counts_.duplicates;
        return;
    }
  }
  Fill(packet, utime_ns);
}

void SensorStream::Fill(const DataPacket& packet, std::int64_t utime_ns) {
  std::array<Point, kMaxPointsInPacket> points;
  DecodePoints(packet, points);
  const std::size_t echoes = packet.layout.echoes;
  Open* open = nullptr;
  for (std::size_t shot = 0; shot < packet.shots; ++shot) {
    const std::int64_t utime =
        FloorDiv(utime_ns, kNsPerUs) + static_cast<std::int64_t>(shot) * kShotPeriod_us;
    const std::int64_t number = NumberOf(utime);
    // The first shots of a packet that begins before what has left already.
    if (next_number_ && number < *next_number_) continue;
    if (open == nullptr || open->number != number) open = &OpenFor(number);
    open->is_dual = open->is_dual || echoes == 2;
    AddShot(*open, std::span<const Point>(points).subspan(shot * echoes, echoes), utime);
    reached_utime_ = std::max(reached_utime_, utime + kShotPeriod_us);
  }
}

SensorStream::Open& SensorStream::OpenFor(std::int64_t number) {
  auto place = open_.end();
  while (place != open_.begin() && std::prev(place)->number > number) --place;
  if (place != open_.begin() && std::prev(place)->number == number) return *std::prev(place);
  Open fresh;
  if (spare_.empty()) {
    fresh.cloud_sensor.Reserve(static_cast<std::size_t>(config_.max_points));
  } else {
    fresh = std::move(spare_.back());
    spare_.pop_back();
  }
  fresh.number = number;
  fresh.shots = 0;
  fresh.zero_returns = 0;
  fresh.is_dual = false;
  fresh.is_in_order = true;
  fresh.cloud_sensor.Clear();
  return *open_.insert(place, std::move(fresh));
}

void SensorStream::AddShot(Open& open, std::span<const Point> echoes, std::int64_t utime) {
  ++open.shots;
  const std::int64_t scan = FloorDiv(open.number, slices_in_scan_);
  const auto offset_us = static_cast<std::int32_t>(utime - scan * config_.scan_period_us);
  PointCloud& cloud = open.cloud_sensor;
  if (!cloud.empty() && cloud.time_offset_us.back() > offset_us) open.is_in_order = false;
  bool has_echo = false;
  for (const Point& echo : echoes) {
    if (!echo.is_return()) continue;
    has_echo = true;
    if (cloud.size() >= static_cast<std::size_t>(config_.max_points)) {
      ++counts_.overflow_points;
      continue;
    }
    cloud.Add({echo.x_m, echo.y_m, echo.z_m}, echo.reflectivity, echo.tag, offset_us);
  }
  if (!has_echo) ++open.zero_returns;
}

bool SensorStream::IsWhole(const Open& open) const {
  const std::int64_t end_utime = BeginOf(open.number + 1);
  return reached_utime_ >= end_utime && !gaps_.HasOpenBefore(end_utime);
}

std::vector<StreamSlice> SensorStream::Take(std::int64_t now_utime) {
  if (num_held_ > 0 && now_utime - first_held_utime_ >= DeviceClock::kMaxSettle_us) {
    clock_.Settle();
    ReleaseHeld();
  }
  std::vector<StreamSlice> out = std::exchange(due_, {});
  while (!open_.empty()) {
    const bool is_due = now_utime >= BeginOf(open_.front().number + 1) + config_.slice_grace_us;
    if (!is_due && !IsWhole(open_.front())) break;
    LeaveFront(out);
  }
  return out;
}

std::optional<std::int64_t> SensorStream::NextDue() const {
  if (!due_.empty()) return std::numeric_limits<std::int64_t>::min();
  std::optional<std::int64_t> due;
  if (num_held_ > 0) due = first_held_utime_ + DeviceClock::kMaxSettle_us;
  if (open_.empty()) return due;
  const std::int64_t front_due = BeginOf(open_.front().number + 1) + config_.slice_grace_us;
  return due ? std::min(*due, front_due) : front_due;
}

void SensorStream::LeaveUpTo(std::int64_t number, std::vector<StreamSlice>& out) {
  while (!open_.empty() && open_.front().number < number) LeaveFront(out);
}

void SensorStream::LeaveFront(std::vector<StreamSlice>& out) {
  const std::int64_t number = open_.front().number;
  // In between, everything was lost; beyond a scan, the sensor was silent.
  if (next_number_ && number > *next_number_ && number - *next_number_ <= slices_in_scan_) {
    for (std::int64_t empty = *next_number_; empty < number; ++empty) {
      out.push_back(Make(empty, nullptr));
    }
  }
  out.push_back(Make(number, &open_.front()));
  next_number_ = number + 1;
  spare_.push_back(std::move(open_.front()));
  open_.pop_front();
}

StreamSlice SensorStream::Make(std::int64_t number, const Open* open) {
  const std::int64_t scan = FloorDiv(number, slices_in_scan_);
  StreamSlice made;
  made.lost_packets = gaps_.GiveUpBefore(BeginOf(number + 1));
  made.time_source = clock_.source();
  made.slice.scan_id = scan;
  made.slice.scan_utime = scan * config_.scan_period_us;
  made.slice.scan_end_utime = made.slice.scan_utime + config_.scan_period_us;
  made.slice.slice_index = static_cast<int>(number - scan * slices_in_scan_);
  made.slice.slice_count = static_cast<int>(slices_in_scan_);
  counts_.lost_packets += made.lost_packets;
  ++counts_.slices;
  if (open == nullptr) return made;
  made.is_dual = open->is_dual;
  made.slice.shots = open->shots;
  made.slice.zero_returns = open->zero_returns;
  made.slice.cloud_sensor = open->cloud_sensor;
  if (!open->is_in_order) SortByTime(made.slice.cloud_sensor);
  counts_.shots += open->shots;
  counts_.zero_returns += open->zero_returns;
  return made;
}

void SensorStream::Restart() {
  num_held_ = 0;
  for (Open& open : open_) spare_.push_back(std::move(open));
  open_.clear();
  counts_.lost_packets += gaps_.Restart();
  clock_.Restart();
}

}  // namespace clearway::core::livox
