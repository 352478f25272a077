// SPDX-License-Identifier: BSD-3-Clause
// What verbs do once it is known that they may give orders.
#include <algorithm>
#include <set>
#include <utility>

#include "processes/procman_sheriff/table.hpp"
#include "processes/procman_sheriff/verbs.hpp"

namespace clearway {
namespace {

using core::procman::CommandView;
using core::procman::ScriptRunner;
using core::procman::Sheriff;

// Orders that nobody waits for are sent three times.
constexpr std::int64_t kRepeatUs = 100'000;
constexpr int kRepeats = 2;

}  // namespace

void SheriffVerbRun::Act() {
  phase_ = Phase::kActing;
  acted_us_ = runtime_.MonotonicUs();
  process_.sheriff().SetMode(Sheriff::Mode::kCommand);
  const core::procman::Script script =
      request_.verb == SheriffVerb::kRun
          ? *FindScript(*request_.deployment, request_.targets.front())
          : ScriptFor(request_.verb, targets_, request_.waits);
  process_.runner().Run(
      script, {.timeout_us = request_.timeout_us, .force = request_.force}, acted_us_);
  process_.Update();
}

void SheriffVerbRun::WatchScript() {
  const std::int64_t now_us = runtime_.MonotonicUs();
  const auto other = process_.sheriff().ActiveOther(now_us);
  if (other && other->was_heard && !std::exchange(warned_of_other_, true)) {
    printer_.error("sheriff " + Printable(other->id) + " gives orders too");
  }
  const ScriptRunner& runner = process_.runner();
  switch (runner.state()) {
    case ScriptRunner::State::kDone:
      PrintWhatIsSo();
      Finish(0, {});
      return;
    case ScriptRunner::State::kTimedOut:
      Finish(kSheriffTimeout, runner.text());
      return;
    case ScriptRunner::State::kRunning:
      break;
    default:
      Finish(kSheriffFailed, runner.text());
      return;
  }
  // Nobody is left to wait for but deputies that are not there.
  std::set<std::string> deputies;
  for (const std::string& id : runner.awaited()) {
    const auto view = process_.sheriff().View(id, now_us);
    if (view) deputies.insert(view->deputy);
  }
  const bool is_any_heard = std::any_of(deputies.begin(), deputies.end(), [&](const auto& id) {
    return process_.sheriff().IsHeard(id, now_us);
  });
  if (!deputies.empty() && !is_any_heard && now_us - acted_us_ >= kDeputyUnheardUs) {
    Finish(kSheriffUnheard, Unheard(deputies) + "; the others have done what was asked");
  }
}

void SheriffVerbRun::WatchUnwaited() {
  if (runtime_.MonotonicUs() - acted_us_ < (repeats_ + 1) * kRepeatUs) return;
  if (request_.verb == SheriffVerb::kRun &&
      process_.runner().state() == ScriptRunner::State::kRunning) {
    return;
  }
  if (repeats_ == kRepeats) {
    Finish(0, {});
    return;
  }
  ++repeats_;
  process_.sheriff().RepeatOrders();
}

void SheriffVerbRun::PrintWhatIsSo() {
  if (request_.json) return;
  for (const CommandView& view : LookAtTargets().commands) {
    if (request_.verb == SheriffVerb::kRun && !view.is_in_file) continue;
    printer_.out(Printable(view.id) + ": " + std::string(core::procman::WordsFor(view.status)) +
                 (view.text.empty() ? "" : ", " + Printable(view.text)));
  }
}

}  // namespace clearway
