// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/host/child_process.hpp"
#include "tests/support/procman_peer.hpp"

namespace clearway::test {

/// Where the programs of this build are.
[[nodiscard]] std::filesystem::path ProgramFolder();

/// A program of this build, by its name without "clearway-".
[[nodiscard]] std::string Program(const std::string& name);

/// What a program that ended gave back.
struct ProgramResult {
  int exit_status = -1;  ///< 124 when it had to be ended.
  std::string out;
  std::string err;
};

/// Runs a program to its end, for at most `timeout_s`; `folder` takes what it prints.
[[nodiscard]] ProgramResult RunProgram(const std::vector<std::string>& command,
                                       const std::filesystem::path& folder,
                                       int timeout_s = 120);

/// The programs of the graph under a real deputy, each of which can be ended, frozen and started
/// anew. Orders are given by a peer that is silent otherwise; ends are known from PM_INFO.
class RunningGraph {
 public:
  /// `arguments` goes to every program, `play_arguments` to the player only. The deputy starts with
  /// the first command.
  RunningGraph(const std::string& url,
               std::vector<std::string> arguments,
               std::vector<std::string> play_arguments,
               std::filesystem::path folder);

  /// What is started from now on is started again by its deputy when it ends.
  void LetRespawn() { respawns_ = true; }

  /// Orders a new run and returns when it runs. Names as in <NAME>_STATUS: preprocessor, clusterer,
  /// stop_guard, play.
  void Start(const std::string& name) { Order({name}); }
  void StartAll() { Order({"stop_guard", "preprocessor", "clusterer", "play"}); }
  /// SIGKILL to the process; returns when its deputy has told.
  void Kill(const std::string& name);
  /// To the process itself, by nobody's order.
  void Signal(const std::string& name, int signal);
  /// Exit status, 128 + signal when one killed it; nothing when it has not ended in that time.
  [[nodiscard]] std::optional<int> AwaitEnd(const std::string& name, std::int64_t timeout_us);
  /// As its deputy last told; 0: does not run.
  [[nodiscard]] std::int32_t PidOf(const std::string& name) const;

  /// SIGKILL to the deputy. The next one carries on from the same folder.
  void KillDeputy();
  void StartDeputy();

  /// There is nobody any more who could give orders.
  void DismissSheriff() { peer_.reset(); }
  [[nodiscard]] ProcmanPeer& peer() { return *peer_; }

  static constexpr char kDeputy[] = "graph";

 private:
  void Order(const std::vector<std::string>& names);
  [[nodiscard]] core::procman::DesiredCommand CommandOf(const std::string& name) const;

  std::string url_;
  std::vector<std::string> arguments_;
  std::vector<std::string> play_arguments_;
  std::filesystem::path folder_;
  bool respawns_ = false;
  std::optional<ProcmanPeer> peer_;
  std::unique_ptr<host::ChildProcess> deputy_;
  std::map<std::string, core::procman::DesiredCommand> commands_;  // All that is wanted.
};

}  // namespace clearway::test
