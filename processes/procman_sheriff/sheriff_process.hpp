// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "common/core/procman/script_runner.hpp"
#include "common/core/procman/sheriff.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/procman.hpp"
#include "common/process/runtime.hpp"

namespace clearway {

/// What a command wrote.
struct CommandOutput {
  std::int64_t utime = 0;
  std::string deputy;
  std::string command;  ///< Empty: the deputy itself speaks.
  std::string text;     ///< Any bytes but NUL; cut anywhere.
};

/// A sheriff on a bus: PM_INFO, PM_HEALTH, PM_ORDERS, PM_OUTPUT -> PM_ORDERS, PM_DISCOVER. Prints
/// nothing and ends nothing, so that other programs may hold one. See README.md beside this file.
class SheriffProcess {
 public:
  struct Settings {
    core::procman::Sheriff::Mode mode = core::procman::Sheriff::Mode::kCommand;
    core::procman::Sheriff::Scope scope = core::procman::Sheriff::Scope::kBus;
    /// Ask all deputies to report at once. Off: nothing is ever sent but orders.
    bool discovers = true;
    /// Listen to PM_OUTPUT.
    bool takes_output = false;
  };

  /// @pre `runtime` outlives the process, and runs no more once that is destroyed.
  SheriffProcess(process::Runtime& runtime, const Settings& settings);
  SheriffProcess(const SheriffProcess&) = delete;
  SheriffProcess& operator=(const SheriffProcess&) = delete;
  ~SheriffProcess();

  /// After having changed something here or in runner() call Update(): else it takes effect with
  /// the next tick, 50 ms later at most.
  [[nodiscard]] core::procman::Sheriff& sheriff() { return sheriff_; }
  [[nodiscard]] const core::procman::Sheriff& sheriff() const { return sheriff_; }
  [[nodiscard]] core::procman::ScriptRunner& runner() { return runner_; }

  /// Sends what is due, carries the script on, hands on what changed.
  void Update();

  /// Asks all deputies to report.
  void Discover();

  /// Each line of the history as it is made, from now on.
  void OnChange(std::function<void(const core::procman::Change&)> handler);
  void OnOutput(std::function<void(const CommandOutput&)> handler);
  /// After whatever may have changed anything to see: a message, an action, time. A handler that
  /// calls Update() whenever it is called never ends.
  void OnUpdate(std::function<void()> handler);

  /// Messages of the PM_ channels that could not be decoded.
  [[nodiscard]] std::int64_t invalid() const { return invalid_; }

 private:
  void Listen(const Settings& settings);
  void HandOnChanges();

  process::Runtime& runtime_;
  core::procman::Sheriff sheriff_;
  core::procman::ScriptRunner runner_;
  std::map<std::string, messages::HealthAssembler> assemblers_;
  process::Runtime::TimerId timer_ = 0;
  std::int64_t next_change_ = 0;
  bool is_updating_ = false;
  bool is_update_due_ = false;
  std::int64_t invalid_ = 0;
  std::function<void(const core::procman::Change&)> on_change_;
  std::function<void(const CommandOutput&)> on_output_;
  std::function<void()> on_update_;
};

}  // namespace clearway
