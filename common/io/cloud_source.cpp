// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/cloud_source.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/io/bin_reader.hpp"
#include "common/io/pcd_reader.hpp"
#include "common/io/scan_listing.hpp"
#include "common/io/scan_stamp.hpp"

namespace clearway::io {

namespace {

constexpr std::size_t kNoFile = std::numeric_limits<std::size_t>::max();
constexpr double kMicrosecondsPerSecond = 1e6;

/// The time of `periods` periods [us], rounded once, so that it does not drift.
std::int64_t Periods(std::size_t periods, double rate_hz) {
  return std::llround(static_cast<double>(periods) * kMicrosecondsPerSecond / rate_hz);
}

core::PointCloud Part(const core::PointCloud& cloud, std::size_t first, std::size_t count) {
  core::PointCloud part;
  const std::size_t end = std::min(first + count, cloud.size());
  part.Reserve(end - first);
  for (std::size_t i = first; i < end; ++i) part.AddFrom(cloud, i);
  return part;
}

}  // namespace

CloudSource::CloudSource(const std::filesystem::path& input, const RecordingConfig& config)
    : config_(config), files_(ListScanFiles(input)), cached_{.file = kNoFile, .cloud = {}} {
  root_ = std::filesystem::is_directory(input) ? input : input.parent_path();
  for (std::size_t file = 0; file < files_.size(); ++file) AddFile(file);
  SetStamps();
}

std::int64_t CloudSource::period_us() const {
  return Periods(1, config_.rate_hz);
}

void CloudSource::AddFile(std::size_t file) {
  const std::string name = files_[file].lexically_relative(root_).string();
  const std::string shown = name.empty() ? files_[file].string() : name;
  if (config_.points_per_scan <= 0) {
    scans_.push_back({.file = file, .first_point = 0, .utime = 0, .name = shown});
    return;
  }
  const auto step = static_cast<std::size_t>(config_.points_per_scan);
  const std::size_t points = ReadCached(file).size();
  for (std::size_t first = 0; first < points; first += step) {
    scans_.push_back({.file = file,
                      .first_point = first,
                      .utime = 0,
                      .name = shown + "#" + std::to_string(first / step)});
  }
}

void CloudSource::SetStamps() {
  if (config_.stamp == StampSource::kName) return SetStampsFromNames();
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    scans_[i].utime = kFirstScanUtime + Periods(i, config_.rate_hz);
  }
}

void CloudSource::SetStampsFromNames() {
  const auto step = static_cast<std::size_t>(std::max(config_.points_per_scan, 1));
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    Scan& scan = scans_[i];
    const auto stamp = ParseScanStamp(files_[scan.file].stem().native());
    if (!stamp) {
      throw ErrorInFile(files_[scan.file].string(),
                        "the name is no stamp; expected seconds with a decimal point, 14 to 16 "
                        "digits of microseconds or 17 to 19 of nanoseconds; else use "
                        "stamp=\"rate\"");
    }
    scan.utime = *stamp + Periods(scan.first_point / step, config_.rate_hz);
    if (i > 0 && scan.utime <= scans_[i - 1].utime) {
      throw ErrorInFile(files_[scan.file].string(),
                        "its stamp does not come after that of " + scans_[i - 1].name +
                            ", which is played before it (" + std::to_string(scan.utime) + " us, " +
                            std::to_string(scans_[i - 1].utime) + " us); use stamp=\"rate\"");
    }
  }
}

core::PointCloud CloudSource::ReadFile(std::size_t file) const {
  if (IsPcdFile(files_[file])) return ReadPcd(files_[file], config_.intensity_scale).cloud;
  return ReadBin(
      files_[file],
      {.floats_per_point = config_.floats_per_point, .intensity_scale = config_.intensity_scale});
}

const core::PointCloud& CloudSource::ReadCached(std::size_t file) {
  if (cached_.file != file) {
    cached_.file = kNoFile;
    cached_.cloud = ReadFile(file);
    cached_.file = file;
  }
  return cached_.cloud;
}

ScanFile CloudSource::Read(std::size_t i) {
  const Scan& scan = scans_[i];
  ScanFile result{.cloud = {}, .utime = scan.utime, .name = scan.name};
  if (config_.points_per_scan <= 0) {
    result.cloud = ReadFile(scan.file);
  } else {
    result.cloud = Part(
        ReadCached(scan.file), scan.first_point, static_cast<std::size_t>(config_.points_per_scan));
  }
  return result;
}

}  // namespace clearway::io
