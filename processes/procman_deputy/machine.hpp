// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>

#include "common/core/procman/command_host.hpp"

namespace clearway {

/// The machine below a deputy: the real one is ChildSet; tests put another in its place.
class Machine {
 public:
  /// What happens on it. Called by whoever runs the machine, never from within Start() or Signal().
  class Listener {
   public:
    virtual ~Listener() = default;
    /// A command wrote something.
    virtual void OnOutput(std::int32_t pid, std::string_view text) = 0;
    /// A command has ended, all of its output has been handed on, and nothing that came from it is
    /// left. `wait_status` as of wait().
    virtual void OnExit(std::int32_t pid, int wait_status) = 0;
  };

  /// What a command uses, together with all that came from it.
  struct Use {
    float cpu_usage = 0.0F;  ///< Share of all processors since the last sample, 0 to 1.
    std::int64_t vsize_bytes = 0;
    std::int64_t rss_bytes = 0;
  };

  /// What the host uses.
  struct HostUse {
    float cpu_load = -1.0F;  ///< 0 to 1; -1: not known yet.
    std::int64_t memory_total_bytes = 0;
    std::int64_t memory_free_bytes = 0;
    std::int64_t swap_total_bytes = 0;
    std::int64_t swap_free_bytes = 0;
  };

  virtual ~Machine() = default;

  virtual void SetListener(Listener* listener) = 0;

  /// As CommandHost.
  virtual core::procman::StartOutcome Start(const core::procman::CommandSpec& spec) = 0;
  virtual void Signal(std::int32_t pid, int signal) = 0;

  /// The command that a process of this host came from, by its own process; 0: from none.
  [[nodiscard]] virtual std::int32_t CommandPidOf(std::int32_t pid) const = 0;

  /// Measures everything anew; once a second.
  virtual HostUse Sample() = 0;
  /// As of the last sample; zeros for who was not there then.
  [[nodiscard]] virtual Use UseOf(std::int32_t pid) const = 0;
};

}  // namespace clearway
