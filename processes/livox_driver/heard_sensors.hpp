// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/core/livox/driver_config.hpp"

namespace clearway {

/// Who announces himself on the network, and which lidar of the configuration that is: the one with
/// its broadcast code; else the one that is known by its address alone; else, when one is
/// configured with neither, the only MID-70 that is heard and meant by no other. That one is chosen
/// kDecide_us after it was first heard, for good; while several could be meant, none is.
/// Sensors that are no MID-70 are never used. Times are those of one monotonic clock [us].
class HeardSensors {
 public:
  /// Longer than the time between two broadcasts of a sensor.
  static constexpr std::int64_t kDecide_us = 1'200'000;
  /// Who is silent for so long is not there any more.
  static constexpr std::int64_t kSilence_us = 3'000'000;
  /// More are not remembered: the one that was silent for the longest time is forgotten.
  static constexpr std::size_t kMaxHeard = 32;

  explicit HeardSensors(const std::vector<core::livox::LidarConfig>& lidars) : lidars_(lidars) {}

  struct Verdict {
    std::optional<std::size_t> lidar;  ///< Its place in the configuration; nothing: not used.
    bool is_new = false;               ///< Was not there before.
  };
  /// Takes a broadcast.
  Verdict Hear(const core::livox::Broadcast& body, const core::Endpoint& from, std::int64_t now_us);

  struct Choice {
    std::size_t lidar = 0;
    core::Endpoint from;
  };
  /// The sensor that was chosen by now for the lidar with neither code nor address; told once.
  [[nodiscard]] std::optional<Choice> Choose(std::int64_t now_us);

  /// Why this lidar has not been found although others are heard, with what to do; else empty.
  [[nodiscard]] std::string ProblemOf(std::size_t lidar, std::int64_t now_us) const;

  /// "MID-70 3GGDJ6K00100102 at 192.168.1.102, ...": those who are heard and not used.
  [[nodiscard]] std::string UnknownText(std::int64_t now_us) const;

 private:
  struct Heard {
    core::livox::DeviceType type = core::livox::DeviceType::kMid70;
    core::Endpoint from;
    std::int64_t first_us = 0;
    std::int64_t last_us = 0;
  };
  using Entry = std::pair<const std::string, Heard>;

  [[nodiscard]] std::optional<std::size_t> ClaimOf(const Entry& entry) const;
  [[nodiscard]] std::optional<std::size_t> LidarOf(const Entry& entry) const;
  [[nodiscard]] std::optional<std::size_t> OpenLidar() const;
  [[nodiscard]] std::vector<const Entry*> Candidates(std::int64_t now_us) const;
  [[nodiscard]] static std::string TextOf(const Entry& entry);
  void MakeRoom();

  std::vector<core::livox::LidarConfig> lidars_;
  std::map<std::string, Heard> heard_;  // By broadcast code.
  std::string chosen_code_;             // For the lidar with neither code nor address.
};

}  // namespace clearway
