// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/core/cloud.hpp"
#include "common/io/read_error.hpp"
#include "common/io/recording_config.hpp"

namespace clearway::io {

/// Stamp of the first scan of a recording that brings no stamps [us since the epoch], 2001-09-09:
/// a date like any other, so that no consumer takes it for "never", and the same on each run.
inline constexpr std::int64_t kFirstScanUtime = 1'000'000'000'000'000;

/// One scan of a recording.
struct ScanFile {
  core::PointCloud cloud;  ///< In the sensor's frame, in the order of the file.
  std::int64_t utime = 0;  ///< Start of the scan [us since the epoch].
  std::string name;        ///< Relative to the input; with #k for the k-th scan of a cut file.
};

/// A recording as an ordered sequence of scans: a folder of files, a list of files, a file, or long
/// clouds that are cut into scans (see ListScanFiles() and RecordingConfig).
/// Stamps grow strictly from scan to scan. With stamp="name" a file's stamp is the start of its
/// (first) scan; the scans of a cut file follow each other by period_us().
/// Thread safety: none.
class CloudSource {
 public:
  /// Lists the scans. Files are opened here only when they are cut, to count their points.
  /// Throws ReadError: nothing is there (says what was looked for); a name is no stamp; stamps do
  /// not grow (names both files); a file that must be cut cannot be read.
  CloudSource(const std::filesystem::path& input, const RecordingConfig& config);

  /// Number of scans, at least 1 unless all files to be cut are empty clouds.
  [[nodiscard]] std::size_t size() const { return scans_.size(); }

  /// From the start of a scan to the start of the next one at rate_hz [us].
  [[nodiscard]] std::int64_t period_us() const;

  /// Start of scan i [us since the epoch]. @pre i < size()
  [[nodiscard]] std::int64_t utime(std::size_t i) const { return scans_[i].utime; }

  /// Reads scan i; in any order, as often as wanted. Throws ReadError when its file cannot be
  /// read: the other scans still can. @pre i < size()
  [[nodiscard]] ScanFile Read(std::size_t i);

 private:
  struct Scan {
    std::size_t file;         // Index into files_.
    std::size_t first_point;  // In that file; 0 when it is not cut.
    std::int64_t utime;
    std::string name;
  };

  struct CachedFile {
    std::size_t file;
    core::PointCloud cloud;
  };

  void AddFile(std::size_t file);
  void SetStamps();
  void SetStampsFromNames();
  [[nodiscard]] core::PointCloud ReadFile(std::size_t file) const;
  const core::PointCloud& ReadCached(std::size_t file);

  RecordingConfig config_;
  std::filesystem::path root_;
  std::vector<std::filesystem::path> files_;
  std::vector<Scan> scans_;
  CachedFile cached_;  // The file that was cut last; its scans are read one after the other.
};

}  // namespace clearway::io
