// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/core/procman/orders.hpp"

namespace clearway::core::procman {

/// How long a status may stay away. XML element: <deputy><health>.
struct HealthConfig {
  std::int64_t first_status_us = 30'000'000;
  std::int64_t silence_us = 3'000'000;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Milliseconds("first_status_ms",
                         self.first_status_us,
                         100.0,
                         3600000.0,
                         "From the start of a command to its first status [ms]; later it is "
                         "unhealthy.");
    visitor.Milliseconds("silence_ms",
                         self.silence_us,
                         1500.0,
                         3600000.0,
                         "Between two statuses [ms], which come at 1 Hz; longer is unhealthy.");
  }
};

/// What a status message says, as far as health is concerned.
struct StatusWord {
  bool is_fault = false;  ///< It says that it cannot work.
  bool is_ready = false;  ///< It says that others may rely on it.
  std::string text;
};

/// Judges one run of a command that publishes a status. Time is an argument [us, monotonic].
class HealthWatch {
 public:
  HealthWatch(const HealthConfig& config, std::int64_t started_us);

  void OnStatus(const StatusWord& word, std::int64_t now_us);
  /// Notices silence.
  void Tick(std::int64_t now_us);

  [[nodiscard]] CommandHealth health() const { return health_; }
  [[nodiscard]] const std::string& text() const { return text_; }
  /// When silence will be noticed.
  [[nodiscard]] std::int64_t NextDue() const;
  /// Since when it has been unhealthy; nothing: it is not.
  [[nodiscard]] std::optional<std::int64_t> unhealthy_since_us() const {
    return unhealthy_since_us_;
  }
  /// Whether this run was ever ready.
  [[nodiscard]] bool was_ready() const { return was_ready_; }

 private:
  void Set(CommandHealth health, std::string text, std::int64_t now_us);

  HealthConfig config_;
  std::int64_t last_sign_us_;
  bool has_status_ = false;
  bool was_ready_ = false;
  CommandHealth health_ = CommandHealth::kNotReady;
  std::string text_ = "no status yet";
  std::optional<std::int64_t> unhealthy_since_us_;
};

}  // namespace clearway::core::procman
