// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/procman/deployment.hpp"

namespace clearway {

// Exit statuses of clearway-sheriff (BSD sysexits), beside 0.
inline constexpr int kSheriffUsage = 64;
inline constexpr int kSheriffUnheard = 69;  ///< A deputy that is needed was not heard.
inline constexpr int kSheriffFailed = 70;   ///< A command crashed, was refused or gave up.
inline constexpr int kSheriffTimeout = 75;
inline constexpr int kSheriffOther = 77;  ///< Another sheriff is active.
inline constexpr int kSheriffFile = 78;

enum class SheriffVerb {
  kStatus,
  kStart,
  kStop,
  kRestart,
  kRun,
  kFollow,
  kObserve,
  kCheck,
  kScreen
};

/// Nothing when the word is none.
[[nodiscard]] std::optional<SheriffVerb> VerbOf(std::string_view word);
/// All of them, for messages.
[[nodiscard]] std::string KnownVerbs();

/// Gives orders, and therefore asks whether another sheriff does.
[[nodiscard]] constexpr bool GivesOrders(SheriffVerb verb) {
  return verb == SheriffVerb::kStart || verb == SheriffVerb::kStop ||
         verb == SheriffVerb::kRestart || verb == SheriffVerb::kRun;
}

/// What a user asks for.
struct SheriffRequest {
  SheriffVerb verb = SheriffVerb::kStatus;
  std::optional<core::procman::Deployment> deployment;
  std::vector<std::string> targets;  ///< As written; of kRun the script's name.
  std::int64_t timeout_us = 30'000'000;
  bool force = false;
  bool json = false;
  bool waits = true;
};

/// Where the answer goes. Each text is one or more whole lines without the last line's end.
struct SheriffPrinter {
  std::function<void(const std::string&)> out;
  std::function<void(const std::string&)> error;
  bool shows_progress = false;
};

/// The target that a user's word names, among these commands: "everything", "cmd:ID", "group:PATH",
/// or a command's id or a group's path by itself.
struct NamedTarget {
  std::optional<core::procman::Target> target;
  std::string problem;  ///< One sentence; empty when there is a target.
};
[[nodiscard]] NamedTarget FindTarget(const std::string& word,
                                     const std::vector<core::procman::CommandSpec>& commands);

/// The script of this name; null when there is none.
[[nodiscard]] const core::procman::Script* FindScript(const core::procman::Deployment& deployment,
                                                      const std::string& name);

/// The commands of the file that the script is about, with those of the scripts that it runs.
[[nodiscard]] std::vector<core::procman::DeployedCommand> CommandsOf(
    const core::procman::Script& script,
    const core::procman::Deployment& deployment);

/// The script that a start, stop or restart of these targets amounts to.
[[nodiscard]] core::procman::Script ScriptFor(SheriffVerb verb,
                                              const std::vector<core::procman::Target>& targets,
                                              bool waits);

}  // namespace clearway
