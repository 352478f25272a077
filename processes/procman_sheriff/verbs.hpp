// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "processes/procman_sheriff/request.hpp"
#include "processes/procman_sheriff/sheriff_process.hpp"

namespace clearway {

/// After three reports that did not come a deputy counts as not there.
inline constexpr std::int64_t kDeputyUnheardUs = 3'000'000;

/// The user's machine, as far as a verb needs it.
struct SheriffVerbHooks {
  /// The verb is done; called once, never from within the constructor.
  std::function<void()> done;
  /// Whether the program with this sheriff id is known to have ended: it ran on this host, and its
  /// process is no more.
  std::function<bool(const std::string& sheriff_id)> is_gone = [](const std::string&) {
    return false;
  };
};

/// One verb of clearway-sheriff from its question on the bus to its answer and exit status. All but
/// kCheck, which needs no bus.
/// start, stop, restart, run: listens until the deputies of the file have answered and it is known
/// that no other sheriff is active, then gives orders until what was asked for is so.
class SheriffVerbRun {
 public:
  /// @pre `runtime` outlives the object and runs no more when that is destroyed.
  SheriffVerbRun(process::Runtime& runtime,
                 SheriffRequest request,
                 SheriffPrinter printer,
                 SheriffVerbHooks hooks);
  SheriffVerbRun(const SheriffVerbRun&) = delete;
  SheriffVerbRun& operator=(const SheriffVerbRun&) = delete;

  /// The user wants to go.
  void Interrupt();

  [[nodiscard]] int exit_status() const { return exit_status_; }
  [[nodiscard]] SheriffProcess& process() { return process_; }

 private:
  enum class Phase { kListening, kActing, kStreaming, kDone };

  void Step();
  void Listen();
  void Answer();
  void Act();
  void WatchScript();
  void WatchUnwaited();
  void PrintWhatIsSo();
  void PrintOutput(const CommandOutput& output);
  [[nodiscard]] bool FollowsOutputOf(const std::string& command);
  void PrintChange(const core::procman::Change& change);
  void Finish(int exit_status, const std::string& text);

  [[nodiscard]] bool HasListenedEnough() const;
  [[nodiscard]] bool MayAnotherBeActive();
  [[nodiscard]] std::set<std::string> NeededDeputies() const;
  [[nodiscard]] std::string Unheard(const std::set<std::string>& deputies) const;
  [[nodiscard]] std::vector<core::procman::CommandSpec> KnownCommands() const;
  [[nodiscard]] bool ResolveTargets();
  [[nodiscard]] core::procman::Snapshot LookAtTargets() const;
  [[nodiscard]] bool IsTargeted(const std::string& command) const;
  [[nodiscard]] std::int64_t elapsed_us() const;

  process::Runtime& runtime_;
  SheriffRequest request_;
  SheriffPrinter printer_;
  SheriffVerbHooks hooks_;
  SheriffProcess process_;
  Phase phase_ = Phase::kListening;
  int exit_status_ = 0;
  std::int64_t start_us_;
  std::int64_t acted_us_ = 0;
  int discoveries_ = 1;
  int repeats_ = 0;
  std::vector<core::procman::Target> targets_;
  std::map<std::string, std::string> unfinished_lines_;  // Of output, by deputy and command.
  bool warned_of_other_ = false;
};

/// Whether the program with this sheriff id (host:pid:utime) ran on `host` and has ended.
[[nodiscard]] bool HasSheriffEnded(const std::string& sheriff_id, const std::string& host);

}  // namespace clearway
