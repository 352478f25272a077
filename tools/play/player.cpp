// SPDX-License-Identifier: BSD-3-Clause
#include "tools/play/player.hpp"

#include <algorithm>

#include "common/core/scan/slice_cutter.hpp"
#include "common/io/read_error.hpp"
#include "common/messages/lidar_points.hpp"
#include "common/process/log.hpp"

namespace clearway::play {
namespace {

using messages::channels::kLidarPoints;

// A slice lasts about this long, as a sensor's driver would send it.
constexpr std::int64_t kSliceUs = 10'000;

core::SliceCut CutFor(std::size_t max_message_bytes, std::int64_t period_us) {
  core::SliceCut cut;
  cut.min_slices =
      static_cast<int>(std::clamp<std::int64_t>(period_us / kSliceUs, 1, core::kMaxSlices));
  cut.max_points = static_cast<int>((max_message_bytes - messages::kLidarHeaderBytes) /
                                    messages::kLidarBytesPerPoint);
  return cut;
}

}  // namespace

Player::Player(process::Node& node,
               ScanSource& source,
               const PlayerSettings& settings,
               std::function<void()> on_done)
    : node_(node), source_(source), settings_(settings), on_done_(std::move(on_done)) {
  ReportState(status_t::STATE_OK);
  process::Runtime& runtime = node_.runtime();
  const auto settle_us = static_cast<std::int64_t>(settings_.settle_s * 1e6);
  monotonic_minus_utime_us_ = runtime.MonotonicUs() + settle_us - StampOf(0);
  runtime.After(settle_us, [this] { BeginNextScan(); });
}

std::int64_t Player::StampOf(std::size_t scan) const {
  const std::size_t n = source_.size();
  const std::int64_t loop_us = source_.utime(n - 1) - source_.utime(0) + source_.period_us();
  return source_.utime(scan % n) + static_cast<std::int64_t>(scan / n) * loop_us;
}

void Player::BeginNextScan() {
  // Without this, a loop over nothing but unreadable scans would never return.
  const std::size_t unreadable_pass = next_scan_ + source_.size();
  do {
    if (next_scan_ >= (settings_.loop ? unreadable_pass : source_.size())) {
      ReportState(status_t::STATE_DONE);
      on_done_();
      return;
    }
    LoadScan();
    ++next_scan_;
  } while (slices_.empty());
  next_slice_ = 0;
  ScheduleSlice();
}

void Player::LoadScan() {
  const std::int64_t utime = StampOf(next_scan_);
  slices_.clear();
  try {
    PlayedScan scan = source_.Read(next_scan_ % source_.size());
    slices_ = core::CutIntoSlices(
        {.scan_id = static_cast<std::int64_t>(next_scan_),
         .utime_start = utime,
         .utime_end = utime + source_.period_us(),
         .cloud_sensor = std::move(scan.cloud_sensor)},
        CutFor(node_.runtime().MaxMessageBytes(kLidarPoints.bus), source_.period_us()));
    if (slices_.size() > static_cast<std::size_t>(core::kMaxSlices)) {
      slices_.clear();
      throw io::ReadError(scan.name + ": too many points for slices of max_message_bytes");
    }
  } catch (const io::ReadError& error) {
    process::LogError(error.what());
    ++progress_.unreadable;
  }
}

void Player::ScheduleSlice() {
  const core::Slice& slice = slices_[next_slice_];
  const std::int64_t period_us = slice.scan_end_utime - slice.scan_utime;
  const std::int64_t end_utime =
      slice.scan_utime + period_us * (slice.slice_index + 1) / slice.slice_count;
  process::Runtime& runtime = node_.runtime();
  runtime.After(end_utime + monotonic_minus_utime_us_ - runtime.MonotonicUs(),
                [this] { SendSlice(); });
}

void Player::SendSlice() {
  node_.Publish(kLidarPoints, messages::ToLcm(slices_[next_slice_], settings_.sensor));
  if (++next_slice_ < slices_.size()) {
    ScheduleSlice();
    return;
  }
  ++progress_.played;
  ReportState(status_t::STATE_OK);
  BeginNextScan();
}

void Player::ReportState(std::int8_t code) {
  node_.SetCounter("scans_played", static_cast<std::int64_t>(progress_.played));
  node_.SetCounter("scans_unreadable", static_cast<std::int64_t>(progress_.unreadable));
  node_.SetCounter("scans_total", static_cast<std::int64_t>(source_.size()));
  const std::string size = std::to_string(source_.size());
  node_.SetState(
      {code,
       true,
       "played " + std::to_string(progress_.played) +
           (settings_.loop ? " scans, in a loop of " + size : " of " + size + " scans")});
}

}  // namespace clearway::play
