// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include <clearway/status_t.hpp>

#include "common/host/child_process.hpp"
#include "common/process/runtime.hpp"
#include "processes/procman_sheriff/sheriff_process.hpp"
#include "tools/run_graph/run_settings.hpp"

namespace clearway::run_graph {

/// A deputy for one run, with the run's deployment, and the sheriff that commands it and nobody
/// else. The deputy gets SIGTERM when this process dies, and ends its commands then; they die with
/// it when it is killed.
class OwnDeputy {
 public:
  /// Starts the deputy; it takes orders 0.6 s later. Throws std::runtime_error.
  OwnDeputy(process::Runtime& runtime, const RunSettings& settings);

  /// Ends it and what is left of its commands.
  ~OwnDeputy();
  OwnDeputy(const OwnDeputy&) = delete;
  OwnDeputy& operator=(const OwnDeputy&) = delete;

  void Start(const char* group);
  /// SIGINT to what runs of it; SIGKILL after 3 s.
  void Stop(const char* group);

  /// Runs and has said that it is ready.
  [[nodiscard]] bool IsReady(const std::string& command) const;
  /// What keeps it from that.
  [[nodiscard]] std::string StateOf(const std::string& command) const;

  /// 0: it does not run.
  [[nodiscard]] std::int32_t PidOf(const std::string& command) const;

  /// Exit status, 128 + signal when one killed it; nothing when it runs or was never started.
  [[nodiscard]] std::optional<int> ExitStatusOf(const std::string& command) const;

  /// The last lines that a command wrote.
  [[nodiscard]] std::string LastWordsOf(const std::string& command) const;

  /// Throws std::runtime_error, with its last words, when the deputy itself has ended.
  void CheckAlive();
  [[nodiscard]] bool has_ended() { return process_.ExitStatus().has_value(); }

  /// Whether the sender of a status is one of the commands.
  [[nodiscard]] bool IsOwn(const status_t& status) const;

 private:
  [[nodiscard]] core::procman::CommandView ViewOf(const std::string& command) const;

  process::Runtime& runtime_;
  std::filesystem::path log_folder_;
  std::string id_;
  SheriffProcess sheriff_;
  host::ChildProcess process_;
};

}  // namespace clearway::run_graph
