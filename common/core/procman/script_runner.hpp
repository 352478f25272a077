// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/procman/deployment.hpp"
#include "common/core/procman/sheriff.hpp"

namespace clearway::core::procman {

/// Carries out a script against a sheriff, step by step: it never blocks, time is an argument.
/// A wait for "running" ends well when each command runs, is ready where its deputy tells, and has
/// lasted half a second where nobody tells; also when a command that is not to be respawned has
/// exited with 0: it is done. It fails at once when a command failed, was refused, gave up, or
/// ended three times in a row; it never takes a crash for success, as the reference does. A wait
/// for "stopped" ends well when no command has a process or is about to get one. Not for several
/// threads.
class ScriptRunner {
 public:
  struct Options {
    std::int64_t timeout_us = 30'000'000;  ///< Of each wait for a status.
    bool force = false;                    ///< As for Sheriff::Start().
  };
  enum class State {
    kIdle,  ///< Nothing was run yet.
    kRunning,
    kDone,
    kFailed,    ///< A command cannot come to what was waited for.
    kTimedOut,  ///< It has not yet.
    kAborted,
  };

  /// @pre `sheriff` outlives the runner.
  explicit ScriptRunner(Sheriff& sheriff) : sheriff_(sheriff) {}

  /// Aborts what is running and begins `script`, with a first Tick(). Scripts that it names are
  /// those of the sheriff's deployment.
  void Run(const Script& script, const Options& options, std::int64_t now_us);

  void Abort();

  /// Goes on as far as it can. To be called after what the sheriff took in, and at 20 Hz.
  State Tick(std::int64_t now_us);

  [[nodiscard]] State state() const { return state_; }
  /// Of the script that runs or ran last.
  [[nodiscard]] const std::string& script() const { return name_; }
  /// How it ended, in a sentence that names each command that is not there, and why; while it runs,
  /// what is waited for. May be empty.
  [[nodiscard]] const std::string& text() const { return text_; }
  /// The commands that are waited for and are not there.
  [[nodiscard]] const std::vector<std::string>& awaited() const { return awaited_; }

 private:
  struct Frame {
    Script script;
    std::size_t next = 0;
  };
  enum class Verdict { kYes, kNotYet, kNever };

  void Begin(const ScriptAction& action, std::int64_t now_us);
  void BeginWait(std::vector<std::string> commands,
                 ScriptAction::Status status,
                 std::int64_t now_us);
  void BeginScript(const std::string& name);
  void CheckWait(std::int64_t now_us);
  void End(State state, std::string text);
  [[nodiscard]] static Verdict IsRunning(const CommandView& view);
  [[nodiscard]] static Verdict IsStopped(const CommandView& view);

  Sheriff& sheriff_;
  Options options_;
  State state_ = State::kIdle;
  std::string name_;
  std::string text_;
  std::vector<Frame> frames_;
  ScriptAction::Status wait_ = ScriptAction::Status::kNone;
  std::vector<std::string> waited_;  // All commands of the wait.
  std::vector<std::string> awaited_;
  std::int64_t until_us_ = 0;  // Of the wait for a status: its end; of wait ms: the next action.
};

}  // namespace clearway::core::procman
