// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <deque>
#include <map>
#include <memory>

#include <clearway/lidar_points_t.hpp>

#include "common/core/livox/sensor_stream.hpp"
#include "common/io/cloud_source.hpp"
#include "common/io/lvx/lvx_reader.hpp"
#include "common/io/scan_stamp.hpp"
#include "common/messages/lidar_points.hpp"
#include "tools/convert/sources.hpp"

namespace clearway::convert {
namespace {

using core::livox::DataPacket;
using core::livox::SensorStream;
using core::livox::StreamSlice;
using core::livox::TimestampType;

constexpr std::int64_t kNsPerUs = 1000;
constexpr std::int64_t kNsPerSecond = 1'000'000'000;
// Stamps that jump by more than this began anew: the recording goes on at once.
constexpr std::int64_t kLongestGap_ns = 2 * kNsPerSecond;

// A stamp that says when it was by itself.
std::optional<std::int64_t> AbsoluteNs(const DataPacket& packet) {
  if (packet.header.timestamp_type == TimestampType::kPtp) {
    return static_cast<std::int64_t>(packet.header.timestamp);
  }
  if (packet.header.timestamp_type == TimestampType::kGps) {
    return core::livox::GpsUtcNs(packet.header.timestamp);
  }
  return std::nullopt;
}

// One device of the file.
struct Track {
  int sensor = 0;
  std::unique_ptr<SensorStream> stream = nullptr;
  TimestampType type = TimestampType::kUnknown;
  std::optional<std::int64_t> last_stamp_ns = std::nullopt;
  std::int64_t utime_ns = 0;  // Of the last packet's first shot.
};

class LvxSlices final : public SliceSource {
 public:
  explicit LvxSlices(const SourceSettings& settings)
      : settings_(settings), reader_(settings.input), played_ns_(FirstUtime(settings) * kNsPerUs) {
    core::livox::StreamConfig config;
    config.scan_period_us = settings.scan_period_us;
    while (config.scan_period_us % config.slice_us != 0) --config.slice_us;
    const std::vector<io::LvxDevice>& devices = reader_.header().devices;
    for (std::size_t i = 0; i < devices.size(); ++i) {
      sensors_.push_back(NameOf(i));
      tracks_[devices[i].index] = {static_cast<int>(i), std::make_unique<SensorStream>(config)};
    }
    sequences_.resize(sensors_.size());
  }

  [[nodiscard]] const std::vector<std::string>& sensors() const override { return sensors_; }

  [[nodiscard]] std::optional<TimedSlice> Next() override {
    while (ready_.empty() && !is_at_end_) ReadOn();
    if (ready_.empty()) return std::nullopt;
    TimedSlice next = std::move(ready_.front());
    ready_.pop_front();
    return next;
  }

  [[nodiscard]] double progress() const override {
    return static_cast<double>(reader_.position()) / static_cast<double>(reader_.size());
  }

  [[nodiscard]] SourceCounts counts() const override {
    const io::LvxReport& report = reader_.report();
    SourceCounts counts;
    counts.left_out = report.foreign_types + report.unknown_devices;
    for (const auto& [index, track] : tracks_) {
      const core::livox::StreamCounts& of_stream = track.stream->counts();
      counts.packets += of_stream.packets;
      counts.lost_packets += of_stream.lost_packets;
      counts.zero_returns += of_stream.zero_returns;
      counts.left_out += of_stream.duplicates + of_stream.late_packets + of_stream.unfit_packets;
      if (of_stream.overflow_points > 0) {
        counts.problems.push_back(sensors_[static_cast<std::size_t>(track.sensor)] + ": " +
                                  std::to_string(of_stream.overflow_points) +
                                  " points do not fit into their slices");
      }
    }
    if (!report.first_problem.empty()) counts.problems.push_back(report.first_problem);
    if (report.damages > 0) {
      counts.problems.push_back(settings_.input.string() + ": " + std::to_string(report.damages) +
                                " damaged places, " + std::to_string(report.lost_bytes) +
                                " bytes passed over");
    }
    if (report.cut_at) counts.remarks.push_back(report.cut);
    return counts;
  }

 private:
  static std::int64_t FirstUtime(const SourceSettings& settings) {
    if (settings.start_utime) return *settings.start_utime;
    return io::ParseScanStamp(settings.input.stem().native()).value_or(io::kFirstScanUtime);
  }

  [[nodiscard]] std::string NameOf(std::size_t i) const {
    const std::vector<io::LvxDevice>& devices = reader_.header().devices;
    if (i < settings_.sensors.size()) return settings_.sensors[i];
    if (devices.size() == 1) return "front";
    const std::string& code = devices[i].lidar_code;
    return code.empty() ? "device_" + std::to_string(devices[i].index) : code;
  }

  // When the packet's first shot was. Without a time of its own, the first packet of a device, and
  // the first one after its stamps began anew, come at once after what the file held before.
  [[nodiscard]] std::int64_t UtimeNs(const DataPacket& packet, Track& track) const {
    const std::optional<std::int64_t> absolute_ns = AbsoluteNs(packet);
    const std::int64_t stamp_ns =
        absolute_ns.value_or(static_cast<std::int64_t>(packet.header.timestamp));
    const bool goes_on = track.last_stamp_ns && track.type == packet.header.timestamp_type;
    std::int64_t step_ns = goes_on ? stamp_ns - *track.last_stamp_ns : 0;
    if (track.type == TimestampType::kPps && step_ns < 0) step_ns += kNsPerSecond;
    track.last_stamp_ns = stamp_ns;
    track.type = packet.header.timestamp_type;
    if (absolute_ns && !settings_.start_utime) return *absolute_ns;
    if (goes_on && step_ns >= -kLongestGap_ns / 2 && step_ns <= kLongestGap_ns) {
      return track.utime_ns + step_ns;
    }
    return std::max(track.utime_ns, played_ns_);
  }

  void ReadOn() {
    const std::optional<io::LvxPackage> package = reader_.Next();
    if (!package) {
      is_at_end_ = true;
      // Nothing will come that a slice could wait for.
      for (auto& [index, track] : tracks_) {
        TakeSlices(track, played_ns_ / kNsPerUs + 10 * settings_.scan_period_us + kNsPerSecond);
      }
      return;
    }
    const auto parsed = core::livox::ParsePacket(package->packet);
    if (!parsed.packet) return;  // The reader gives none such.
    Track& track = tracks_.at(package->device_index);
    track.utime_ns = UtimeNs(*parsed.packet, track);
    const auto shots = static_cast<std::int64_t>(parsed.packet->shots);
    const std::int64_t arrival_ns = track.utime_ns + shots * core::livox::kShotPeriod_us * kNsPerUs;
    track.stream->Add(*parsed.packet, arrival_ns / kNsPerUs);
    played_ns_ = is_first_ ? arrival_ns : std::max(played_ns_, arrival_ns);
    is_first_ = false;
    TakeSlices(track, arrival_ns / kNsPerUs);
  }

  void TakeSlices(Track& track, std::int64_t now_utime) {
    for (StreamSlice& out : track.stream->Take(now_utime)) {
      out.slice.sensor = track.sensor;
      out.slice.session = 1;
      out.slice.sequence = sequences_[static_cast<std::size_t>(track.sensor)]++;
      const std::int64_t period_us = out.slice.scan_end_utime - out.slice.scan_utime;
      const std::int64_t end_utime =
          out.slice.scan_utime + period_us * (out.slice.slice_index + 1) / out.slice.slice_count;
      const std::int8_t mode =
          out.is_dual ? lidar_points_t::RETURN_DUAL : lidar_points_t::RETURN_UNKNOWN;
      ready_.push_back({.slice = std::move(out.slice),
                        .lost_packets = out.lost_packets,
                        .time_source = static_cast<std::int8_t>(out.time_source),
                        .return_mode = mode,
                        .utime = end_utime});
    }
  }

  SourceSettings settings_;
  io::LvxReader reader_;
  std::int64_t played_ns_;  // How far the recording's time has come.
  bool is_first_ = true;
  bool is_at_end_ = false;
  std::vector<std::string> sensors_;
  std::map<std::uint8_t, Track> tracks_;  // By device index.
  std::vector<std::int64_t> sequences_;   // By sensor.
  std::deque<TimedSlice> ready_;
};

}  // namespace

std::unique_ptr<SliceSource> OpenLvx(const SourceSettings& settings) {
  return std::make_unique<LvxSlices>(settings);
}

}  // namespace clearway::convert
