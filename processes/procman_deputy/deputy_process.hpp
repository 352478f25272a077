// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <clearway/status_t.hpp>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>

#include "common/core/procman/deputy.hpp"
#include "common/core/procman/output_queue.hpp"
#include "common/process/runtime.hpp"
#include "processes/procman_deputy/command_logs.hpp"
#include "processes/procman_deputy/kept_orders.hpp"
#include "processes/procman_deputy/machine.hpp"
#include "processes/procman_deputy/paced_action.hpp"

namespace clearway {

/// What a deputy is told at its start.
struct DeputySettings {
  std::string id;
  std::string version;
  core::procman::RespawnConfig respawn;
  core::procman::HealthConfig health;
  core::procman::OutputConfig output;
  CommandLogsConfig logs;             ///< With a folder.
  std::filesystem::path orders_file;  ///< The last orders are kept here; empty: they are not.
  /// Digest of the graph's configuration on this host, asked for at 1 Hz; may be empty.
  std::function<std::string()> config_digest;
};

/// procman's protocol over a bus on one side, a machine on the other. See README.md beside this
/// file.
class DeputyProcess final : private Machine::Listener, private core::procman::CommandHost {
 public:
  /// Exit statuses of the reference's deputy.
  static constexpr int kStopped = 0;
  static constexpr int kOtherStarts = 1;  ///< Another deputy starts with the same id.
  static constexpr int kOtherRuns = 2;    ///< Another deputy runs with the same id.

  /// `on_end` is called once, with an exit status, when nothing is left to do.
  DeputyProcess(process::Runtime& runtime,
                DeputySettings settings,
                Machine& machine,
                std::function<void(int)> on_end);
  ~DeputyProcess() override;
  DeputyProcess(const DeputyProcess&) = delete;
  DeputyProcess& operator=(const DeputyProcess&) = delete;

  /// Stops all commands in order, then ends. The second call kills them.
  void ShutDown();

  /// Called once the id is known to be this deputy's alone, before any command is started.
  void BeforeFirstStart(std::function<void()> action) { before_first_start_ = std::move(action); }

  /// Orders that do not come over the bus: from a script that this deputy runs by itself.
  core::procman::OrdersOutcome TakeOrders(const core::procman::Orders& orders);
  /// What is said on the bus, for the same script.
  [[nodiscard]] core::procman::DeputyReport Report() const;
  [[nodiscard]] core::procman::DeputyHealth Health() const;
  [[nodiscard]] bool has_orders() const { return deputy_.has_orders(); }
  /// Something about the deputy itself that people must know; stands in its health from now on.
  void SetTrouble(const std::string& text);
  [[nodiscard]] bool is_established() const { return is_established_; }

 private:
  // core::procman::CommandHost
  core::procman::StartOutcome Start(const core::procman::CommandSpec& spec) override;
  void Signal(std::int32_t pid, int signal) override { machine_.Signal(pid, signal); }
  void Note(const std::string& command_id, const std::string& text) override;
  // Machine::Listener
  void OnOutput(std::int32_t pid, std::string_view text) override;
  void OnExit(std::int32_t pid, int wait_status) override;

  void OnDiscovery(const procman_lcm::discovery_t& message);
  void OnInfo(const procman_lcm::deputy_info_t& message);
  void OnOrders(const procman_lcm::orders_t& message);
  void OnStatus(const std::string& channel, const status_t& message);
  void Announce();
  void Establish();
  // False: there are too many.
  bool WatchStatus(const std::string& channel);
  void Resume();
  void KeepOrders();
  void ForgetIfGone(const std::string& command_id);
  void EverySecond();
  void AfterEvent(bool has_changed);
  void SendOutput(std::int64_t early_us = 0);
  void PublishState();
  void Say(const std::string& text);
  void SayRarely(const std::string& text);
  void End(int status);

  process::Runtime& runtime_;
  DeputySettings settings_;
  Machine& machine_;
  std::function<void(int)> on_end_;
  std::function<void()> before_first_start_;
  core::procman::Deputy deputy_;
  core::procman::OutputQueue output_;
  KeptOrders kept_orders_;
  CommandLogs logs_;
  PacedAction state_;
  PacedAction keeping_;
  Machine::HostUse host_use_;
  std::map<std::int32_t, std::string> ids_;  // Of running commands, by their processes.
  std::set<std::string> status_channels_;
  std::deque<std::int64_t> sent_utimes_;  // Of PM_INFO: what comes back from the bus is our own.
  std::string config_digest_;
  std::string trouble_;
  std::int64_t session_;
  std::int64_t health_sequence_ = 0;
  std::int64_t nonce_;
  std::int64_t last_utime_ = 0;
  std::int64_t last_said_us_ = -1;
  std::int64_t stale_orders_ = 0;
  std::int64_t invalid_messages_ = 0;
  std::int64_t rival_heard_us_ = -1;
  bool is_established_ = false;
  bool is_shutting_down_ = false;
  bool has_ended_ = false;
  std::optional<process::Runtime::TimerId> due_timer_;
  std::vector<process::Runtime::TimerId> timers_;
};

}  // namespace clearway
