// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/core/procman/deputy.hpp"

namespace clearway::test {

/// clearway's deputy without processes: its rules, with a machine that is made up. Time is an
/// argument [us]. A command's text is what its process would do:
///   "run"          runs until it is signalled
///   "stubborn"     ends by SIGKILL only
///   "end CODE MS"  ends by itself after MS with exit status CODE
///   "ready MS"     tells by a status that it is ready after MS, then runs
///   "sick MS"      tells by a status that it cannot work after MS, then runs
///   "mute"         a status is expected of it and never comes
///   "forbidden"    its host does not allow it
class MemoryDeputy {
 public:
  explicit MemoryDeputy(std::string id);
  MemoryDeputy(const MemoryDeputy&) = delete;
  MemoryDeputy& operator=(const MemoryDeputy&) = delete;

  [[nodiscard]] const std::string& id() const { return deputy_.id(); }
  void TakeOrders(const core::procman::Orders& orders, std::int64_t now_us);
  void Tick(std::int64_t now_us);
  /// Whether reports are due: for each change, and at 1 Hz.
  [[nodiscard]] bool IsReportDue(std::int64_t now_us);
  [[nodiscard]] core::procman::DeputyReport Report(std::int64_t utime) const;
  [[nodiscard]] core::procman::DeputyHealth Health(std::int64_t now_us) const;

  [[nodiscard]] bool IsUp(const std::string& id) const;
  [[nodiscard]] int StartsOf(const std::string& id) const { return host_.StartsOf(id); }

 private:
  struct Process {
    core::procman::CommandSpec spec;
    std::int64_t ends_us = -1;
    int end_code = 0;
    std::int64_t speaks_us = -1;  // Its first status.
    bool is_sick = false;
    std::int64_t next_status_us = -1;
  };
  class Host final : public core::procman::CommandHost {
   public:
    core::procman::StartOutcome Start(const core::procman::CommandSpec& spec) override;
    void Signal(std::int32_t pid, int signal) override;
    void Note(const std::string& command_id, const std::string& text) override;
    [[nodiscard]] int StartsOf(const std::string& id) const;

    std::map<std::int32_t, Process> processes;
    std::vector<std::string> started;
    std::int64_t now_us = 0;
    std::int32_t next_pid = 5000;
    bool is_changed = true;
  };

  Host host_;
  core::procman::Deputy deputy_;
  std::int64_t reported_us_ = 0;
  std::string last_health_;
};

}  // namespace clearway::test
