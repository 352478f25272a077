// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <deque>

#include <clearway/lidar_points_t.hpp>

#include "common/core/scan/slice_cutter.hpp"
#include "common/io/cloud_source.hpp"
#include "common/io/scan_listing.hpp"
#include "common/io/scan_stamp.hpp"
#include "tools/convert/sources.hpp"

namespace clearway::convert {
namespace {

// As a sensor's driver would send them.
constexpr std::int64_t kSlice_us = 10'000;

bool AreStamps(const std::vector<std::filesystem::path>& files) {
  return std::all_of(files.begin(), files.end(), [](const std::filesystem::path& file) {
    return io::ParseScanStamp(file.stem().native()).has_value();
  });
}

io::RecordingConfig RecordingOf(const SourceSettings& settings, bool are_stamps) {
  return {.floats_per_point = settings.floats_per_point,
          .intensity_scale = settings.intensity_scale,
          .stamp = are_stamps ? io::StampSource::kName : io::StampSource::kRate,
          .rate_hz = 1e6 / static_cast<double>(settings.scan_period_us)};
}

class FolderSlices final : public SliceSource {
 public:
  explicit FolderSlices(const SourceSettings& settings)
      : settings_(settings),
        are_stamps_(AreStamps(io::ListScanFiles(settings.input))),
        scans_(settings.input, RecordingOf(settings, are_stamps_)),
        sensors_{settings.sensors.empty() ? "front" : settings.sensors.front()} {}

  [[nodiscard]] const std::vector<std::string>& sensors() const override { return sensors_; }

  [[nodiscard]] std::optional<TimedSlice> Next() override {
    while (ready_.empty() && next_scan_ < scans_.size()) LoadScan(next_scan_++);
    if (ready_.empty()) return std::nullopt;
    TimedSlice next = std::move(ready_.front());
    ready_.pop_front();
    return next;
  }

  [[nodiscard]] double progress() const override {
    return static_cast<double>(next_scan_) / static_cast<double>(scans_.size());
  }

  [[nodiscard]] SourceCounts counts() const override {
    SourceCounts counts = counts_;
    counts.remarks.push_back(settings_.input.string() +
                             (are_stamps_ ? ": stamps from the names of the files"
                                          : ": no stamps in the names, one scan after the other"));
    return counts;
  }

 private:
  [[nodiscard]] std::int64_t StartOf(std::size_t scan) const {
    const std::int64_t utime = scans_.utime(scan);
    if (!settings_.start_utime) return utime;
    return *settings_.start_utime + utime - scans_.utime(0);
  }

  void LoadScan(std::size_t i) {
    core::ScanToCut scan{.scan_id = static_cast<std::int64_t>(i),
                         .utime_start = StartOf(i),
                         .utime_end = StartOf(i) + settings_.scan_period_us,
                         .cloud_sensor = {}};
    // A recording that is quicker than the period: its scans do not overlap.
    if (i + 1 < scans_.size()) scan.utime_end = std::min(scan.utime_end, StartOf(i + 1));
    try {
      scan.cloud_sensor = scans_.Read(i).cloud;
    } catch (const io::ReadError& error) {
      ++counts_.left_out;
      counts_.problems.emplace_back(error.what());
      return;
    }
    core::SliceCut cut;
    cut.min_slices = static_cast<int>(
        std::clamp<std::int64_t>(settings_.scan_period_us / kSlice_us, 1, core::kMaxSlices));
    for (core::Slice& slice : core::CutIntoSlices(scan, cut)) {
      slice.sensor = 0;
      slice.session = 1;
      slice.sequence = sequence_++;
      counts_.zero_returns += slice.zero_returns;
      const std::int64_t end_utime = scan.utime_start + (scan.utime_end - scan.utime_start) *
                                                            (slice.slice_index + 1) /
                                                            slice.slice_count;
      ready_.push_back({.slice = std::move(slice),
                        .time_source = lidar_points_t::TIME_RECORDED,
                        .return_mode = lidar_points_t::RETURN_UNKNOWN,
                        .utime = end_utime});
    }
  }

  SourceSettings settings_;
  bool are_stamps_;
  io::CloudSource scans_;
  std::vector<std::string> sensors_;
  std::size_t next_scan_ = 0;
  std::int64_t sequence_ = 0;
  std::deque<TimedSlice> ready_;
  SourceCounts counts_;
};

}  // namespace

std::unique_ptr<SliceSource> OpenFolder(const SourceSettings& settings) {
  return std::make_unique<FolderSlices>(settings);
}

}  // namespace clearway::convert
