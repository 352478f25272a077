// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/io/lcm_log.hpp"
#include "common/messages/channels.hpp"

namespace clearway::replay {

/// A message that is fed to the graph.
struct Input {
  std::int64_t utime = 0;  ///< When; never before the input before [us since the epoch].
  messages::BusId bus = messages::BusId::kLocal;
  std::string channel;  ///< Without prefix.
  std::vector<std::byte> bytes;
};

/// What LogInputs made of a log's events.
struct InputCounts {
  std::map<std::string, std::size_t> fed;  ///< By channel, without prefix.
  std::size_t not_inputs = 0;              ///< Of other channels: what a graph published, PM_*.
  std::size_t left_out = 0;      ///< POSE, POSE_STATUS, while the graph has a source of its own.
  std::size_t stepped_back = 0;  ///< Fed at the time of the input before.
  std::int64_t largest_step_back_us = 0;
  std::size_t refused = 0;    ///< Inputs with a time that cannot be.
  std::string first_refused;  ///< The first of them, in words.
};

/// The inputs of a graph in an LCM log: LIDAR_POINTS, ODOMETRY, POSE, POSE_STATUS, in the order in
/// which they stand there.
///
/// Time stamps of a log are those of its logger's clock. One that goes back by up to an hour is
/// fed without delay after the one before. One that is farther than an hour from the one before,
/// either way, or outside 1970-01-01 01:00 .. 2286 is damage, or another recording joined on: that
/// event is refused, and counted.
class LogInputs {
 public:
  struct Settings {
    std::filesystem::path log;
    std::string channel_prefix;
    bool with_pose = true;  ///< False: POSE and POSE_STATUS are left out.
  };

  static constexpr std::int64_t kLargestGapUs = 3'600'000'000;

  /// Throws io::ReadError when the file cannot be opened.
  explicit LogInputs(const Settings& settings);

  /// The next input; nothing at the end of the log.
  [[nodiscard]] std::optional<Input> Next();

  [[nodiscard]] const InputCounts& counts() const { return counts_; }

  /// Share of the log that has been read, 0..1.
  [[nodiscard]] double ShareRead() const;

  /// The names of the channels seen so far, at most 20 of them, for people.
  [[nodiscard]] std::string ChannelsSeen() const;

 private:
  [[nodiscard]] std::optional<Input> Accept(io::LogEvent event);
  [[nodiscard]] std::optional<std::int64_t> TimeOf(const io::LogEvent& event);
  void NoteChannel(const std::string& channel);

  Settings settings_;
  io::LcmLogReader reader_;
  std::uintmax_t log_bytes_ = 0;
  std::uintmax_t bytes_read_ = 0;
  std::set<std::string> channels_;
  bool has_more_channels_ = false;
  std::optional<std::int64_t> last_utime_;
  InputCounts counts_;
};

}  // namespace clearway::replay
