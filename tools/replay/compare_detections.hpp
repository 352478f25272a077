// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <clearway/detections_t.hpp>

namespace clearway::replay {

/// The DETECTIONS of one run, scan by scan. Slices may come in any order and more than once.
class DetectionsOfRun {
 public:
  /// A scan as one message: all detections in order of their slices.
  struct Scan {
    detections_t whole{};      ///< Session, sequence, slice numbers: of its first slice.
    bool is_complete = false;  ///< Its input was complete, and all of its slices are here.
  };

  /// `name` is what errors call the run.
  explicit DetectionsOfRun(std::string name) : name_(std::move(name)) {}

  void Add(detections_t slice);
  /// A message that did not decode.
  void AddInvalid() { ++invalid_; }

  /// Messages that did not decode or contradict themselves or their scan's others.
  [[nodiscard]] std::size_t invalid() const { return invalid_; }

  /// All scans by scan_utime. Throws io::ReadError when two sessions published slices of one scan:
  /// two graphs are in the log, and it is not said which one is meant.
  [[nodiscard]] std::map<std::int64_t, Scan> Scans() const;

 private:
  struct Slices {
    std::int64_t session = 0;
    std::int32_t count = 0;
    std::optional<std::int64_t> other_session;
    std::map<std::int32_t, detections_t> by_index;
  };

  std::string name_;
  std::map<std::int64_t, Slices> scans_;  // By scan_utime.
  std::size_t invalid_ = 0;
};

/// The DETECTIONS of an LCM log. Throws io::ReadError when it cannot be opened.
[[nodiscard]] DetectionsOfRun ReadDetections(const std::filesystem::path& log,
                                             const std::string& channel_prefix);

/// How the detections of two runs over the same scans compare.
struct Comparison {
  std::size_t equal = 0;
  std::size_t different = 0;
  std::size_t incomplete = 0;         ///< Points or slices are missing in one: not compared.
  std::size_t only_in_run = 0;        ///< Scans that the reference does not have.
  std::size_t only_in_reference = 0;  ///< Scans that the run does not have.
  std::size_t detections = 0;         ///< Of the run, in the scans that were compared.
  std::size_t invalid = 0;            ///< Messages of both that could not be used.
  std::string first_difference;       ///< Where, which field, both values; empty: none.

  /// True when at least one scan was compared, nothing differs and both have the same scans.
  [[nodiscard]] bool agrees() const {
    return equal > 0 && different == 0 && only_in_run == 0 && only_in_reference == 0;
  }
};

/// Compares each scan, matched by scan_utime: its stamp and id, states, number of points, and every
/// field of every detection, floating-point numbers bit by bit. Left out is what tells of a run and
/// not of the scan: session, sequence, slicing, processing time and map epoch.
[[nodiscard]] Comparison Compare(const DetectionsOfRun& run, const DetectionsOfRun& reference);

}  // namespace clearway::replay
