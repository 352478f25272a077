// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/script_runner.hpp"

#include <algorithm>
#include <utility>

namespace clearway::core::procman {
namespace {

// More deaths than this in a row, and nobody waits for the next.
constexpr std::int32_t kHopelessDeaths = 3;
// The reader refuses scripts that run each other in a circle.
constexpr std::size_t kMaxDepth = 100;

std::string Describe(const CommandView& view) {
  return view.id + ": " + std::string(WordsFor(view.status)) +
         (view.text.empty() ? "" : ", " + view.text);
}

void Append(std::string& list, const std::string& item) {
  list += (list.empty() ? "" : "; ") + item;
}

}  // namespace

void ScriptRunner::Run(const Script& script, const Options& options, std::int64_t now_us) {
  Abort();
  options_ = options;
  state_ = State::kRunning;
  name_ = script.name;
  text_.clear();
  frames_.assign(1, {script, 0});
  Tick(now_us);
}

void ScriptRunner::Abort() {
  if (state_ == State::kRunning) End(State::kAborted, "aborted");
}

void ScriptRunner::End(State state, std::string text) {
  state_ = state;
  text_ = std::move(text);
  frames_.clear();
  waited_.clear();
  wait_ = ScriptAction::Status::kNone;
  until_us_ = 0;
  if (state == State::kDone || state == State::kAborted) awaited_.clear();
}

ScriptRunner::State ScriptRunner::Tick(std::int64_t now_us) {
  while (state_ == State::kRunning) {
    if (wait_ != ScriptAction::Status::kNone) {
      CheckWait(now_us);
      if (wait_ != ScriptAction::Status::kNone) break;
    } else if (now_us < until_us_) {
      break;
    } else if (frames_.back().next < frames_.back().script.actions.size()) {
      Begin(ScriptAction(frames_.back().script.actions[frames_.back().next++]), now_us);
    } else {
      frames_.pop_back();
      if (frames_.empty()) End(State::kDone, {});
    }
  }
  return state_;
}

void ScriptRunner::Begin(const ScriptAction& action, std::int64_t now_us) {
  using Kind = ScriptAction::Kind;
  using Extent = Sheriff::Extent;
  const Extent extent = action.kind == Kind::kStop || action.wait == ScriptAction::Status::kStopped
                            ? Extent::kStop
                            : Extent::kStart;
  switch (action.kind) {
    case Kind::kStart:
      sheriff_.Start(action.target, now_us, options_.force);
      break;
    case Kind::kStop:
      sheriff_.Stop(action.target, now_us);
      break;
    case Kind::kRestart:
      sheriff_.Restart(action.target, now_us, options_.force);
      break;
    case Kind::kWaitTime:
      until_us_ = now_us + action.duration_ms * 1000;
      text_ = "waits " + std::to_string(action.duration_ms) + " ms";
      return;
    case Kind::kRunScript:
      BeginScript(action.script);
      return;
    case Kind::kWaitStatus:
      break;
  }
  if (action.wait != ScriptAction::Status::kNone) {
    BeginWait(sheriff_.Targeted(action.target, extent), action.wait, now_us);
  }
}

void ScriptRunner::BeginScript(const std::string& name) {
  const std::vector<Script>& scripts = sheriff_.deployment().scripts;
  const auto found = std::find_if(
      scripts.begin(), scripts.end(), [&](const Script& script) { return script.name == name; });
  if (found == scripts.end()) {
    End(State::kFailed, "there is no script \"" + name + "\"");
  } else if (frames_.size() >= kMaxDepth) {
    End(State::kFailed, "scripts run each other without an end: \"" + name + "\"");
  } else {
    frames_.push_back({*found, 0});
  }
}

void ScriptRunner::BeginWait(std::vector<std::string> commands,
                             ScriptAction::Status status,
                             std::int64_t now_us) {
  wait_ = status;
  waited_ = std::move(commands);
  awaited_ = waited_;
  until_us_ = now_us + options_.timeout_us;
}

void ScriptRunner::CheckWait(std::int64_t now_us) {
  const bool for_running = wait_ == ScriptAction::Status::kRunning;
  std::string failed;
  std::string missing;
  awaited_.clear();
  for (const std::string& id : waited_) {
    const std::optional<CommandView> view = sheriff_.View(id, now_us);
    if (!view) {
      if (for_running) Append(failed, id + ": is not known any more");
      continue;
    }
    const Verdict verdict = for_running ? IsRunning(*view) : IsStopped(*view);
    if (verdict == Verdict::kYes) continue;
    awaited_.push_back(id);
    Append(verdict == Verdict::kNever ? failed : missing, Describe(*view));
  }
  const std::string what = for_running ? "running" : "stopped";
  if (!failed.empty()) {
    End(State::kFailed, failed);
  } else if (missing.empty()) {
    wait_ = ScriptAction::Status::kNone;
    until_us_ = 0;
    text_.clear();
  } else if (now_us >= until_us_) {
    End(State::kTimedOut,
        "not " + what + " after " + std::to_string(options_.timeout_us / 1'000'000) +
            " s: " + missing);
  } else {
    text_ = "waits until " + what + ": " + missing;
  }
}

ScriptRunner::Verdict ScriptRunner::IsRunning(const CommandView& view) {
  const bool is_over = view.run_id != 0 && view.run_id == view.desired_run_id && !view.was_stopped;
  switch (view.status) {
    case Status::kRunning:
      return view.is_settled ? Verdict::kYes : Verdict::kNotYet;
    case Status::kStopped:
      if (!is_over) return Verdict::kNotYet;
      return view.exit_code == 0 && !view.auto_respawn ? Verdict::kYes : Verdict::kNever;
    case Status::kFailed:
      return is_over && view.is_settled ? Verdict::kNever : Verdict::kNotYet;
    case Status::kGaveUp:
    case Status::kRefused:
      return Verdict::kNever;
    case Status::kBackingOff:
      return view.deaths >= kHopelessDeaths ? Verdict::kNever : Verdict::kNotYet;
    default:
      return Verdict::kNotYet;
  }
}

ScriptRunner::Verdict ScriptRunner::IsStopped(const CommandView& view) {
  switch (view.status) {
    case Status::kStopped:
    case Status::kFailed:
    case Status::kGaveUp:
    case Status::kRefused:
      return view.is_settled ? Verdict::kYes : Verdict::kNotYet;
    default:
      return Verdict::kNotYet;
  }
}

}  // namespace clearway::core::procman
