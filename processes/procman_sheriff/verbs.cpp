// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/verbs.hpp"

#include <algorithm>
#include <utility>

#include "processes/procman_sheriff/table.hpp"

namespace clearway {
namespace {

using core::procman::CommandView;
using core::procman::DeployedCommand;
using core::procman::DeputyView;
using core::procman::Sheriff;
using core::procman::Snapshot;

// Deputies answer within milliseconds, and report at 1 Hz anyway.
constexpr std::int64_t kDiscoverAgainUs = 200'000;
constexpr int kDiscoveries = 3;
// Long enough for a report and for the orders of another sheriff to come by themselves.
constexpr std::int64_t kOnePeriodUs = 1'200'000;
// Without a file nobody knows who is missing.
constexpr std::int64_t kQuickLookUs = 500'000;
// Health comes with the answer.
constexpr std::int64_t kHealthAnswersUs = 300'000;
constexpr const char* kNobodyHeard =
    "no deputy is heard: is one running, and is this its LCM address (-u)?";
constexpr const char* kUnheardHint =
    ": is clearway-deputy running there, with that id, on this LCM address (-u)? "
    "\"clearway-sheriff status\" lists who is";

SheriffProcess::Settings SettingsFor(SheriffVerb verb) {
  return {.mode = Sheriff::Mode::kObserve,
          .discovers = verb != SheriffVerb::kObserve,
          .takes_output = verb == SheriffVerb::kFollow};
}

std::string ResultOf(int exit_status) {
  switch (exit_status) {
    case 0:
      return "done";
    case kSheriffUsage:
      return "usage";
    case kSheriffUnheard:
      return "unheard";
    case kSheriffTimeout:
      return "timeout";
    case kSheriffOther:
      return "other_sheriff";
    default:
      return "failed";
  }
}

}  // namespace

SheriffVerbRun::SheriffVerbRun(process::Runtime& runtime,
                               SheriffRequest request,
                               SheriffPrinter printer,
                               SheriffVerbHooks hooks)
    : runtime_(runtime),
      request_(std::move(request)),
      printer_(std::move(printer)),
      hooks_(std::move(hooks)),
      process_(runtime, SettingsFor(request_.verb)),
      start_us_(runtime.MonotonicUs()) {
  if (request_.deployment) process_.sheriff().Load(*request_.deployment, start_us_);
  const bool streams =
      request_.verb == SheriffVerb::kFollow || request_.verb == SheriffVerb::kObserve;
  if (streams) phase_ = Phase::kStreaming;
  process_.OnChange([this](const core::procman::Change& change) { PrintChange(change); });
  process_.OnOutput([this](const CommandOutput& output) { PrintOutput(output); });
  process_.OnUpdate([this] { Step(); });
}

std::int64_t SheriffVerbRun::elapsed_us() const {
  return runtime_.MonotonicUs() - start_us_;
}

void SheriffVerbRun::Step() {
  switch (phase_) {
    case Phase::kListening:
      Listen();
      break;
    case Phase::kActing:
      request_.waits ? WatchScript() : WatchUnwaited();
      break;
    case Phase::kStreaming:
    case Phase::kDone:
      break;
  }
}

void SheriffVerbRun::Listen() {
  if (!HasListenedEnough()) {
    if (discoveries_ < kDiscoveries && elapsed_us() >= discoveries_ * kDiscoverAgainUs) {
      ++discoveries_;
      process_.Discover();
    }
    return;
  }
  const bool knows_nobody =
      !request_.deployment && process_.sheriff().Look(runtime_.MonotonicUs()).deputies.empty();
  if (!knows_nobody && !ResolveTargets()) return;
  if (request_.verb == SheriffVerb::kStatus) {
    Answer();
    return;
  }
  if (knows_nobody) {
    Finish(kSheriffUnheard, kNobodyHeard);
    return;
  }
  const std::string unheard = Unheard(NeededDeputies());
  if (!unheard.empty() && !request_.force && request_.verb != SheriffVerb::kStop) {
    if (elapsed_us() >= kDeputyUnheardUs) {
      Finish(kSheriffUnheard,
             "nothing was started (--force starts what can be); " + unheard + kUnheardHint);
    }
    return;
  }
  if (!request_.force && MayAnotherBeActive()) return;
  Act();
}

// Whether all that may answer have answered, or have had their time.
bool SheriffVerbRun::HasListenedEnough() const {
  const Snapshot snapshot = process_.sheriff().Look(runtime_.MonotonicUs());
  const bool is_status = request_.verb == SheriffVerb::kStatus;
  if (elapsed_us() >= kOnePeriodUs) return true;
  if (!request_.deployment && elapsed_us() < (is_status ? kQuickLookUs : kOnePeriodUs))
    return false;
  return std::all_of(
      snapshot.deputies.begin(), snapshot.deputies.end(), [&](const DeputyView& deputy) {
        const bool has_answered =
            deputy.tells_health || (is_status && elapsed_us() >= kHealthAnswersUs);
        return deputy.is_heard && has_answered;
      });
}

// Ends the verb when one is. True also while that is not known.
bool SheriffVerbRun::MayAnotherBeActive() {
  const auto other = process_.sheriff().ActiveOther(runtime_.MonotonicUs());
  if (!other || hooks_.is_gone(other->id)) return false;
  // A deputy tells of orders that are less than 3 s old: whoever gave them may be done. If not, it
  // is heard within a second.
  if (!other->was_heard) return true;
  Finish(kSheriffOther,
         "sheriff " + Printable(other->id) +
             " is active: its orders and these would fight (--force gives them all the same)");
  return true;
}

std::set<std::string> SheriffVerbRun::NeededDeputies() const {
  std::set<std::string> deputies;
  if (!request_.deployment) return deputies;
  if (request_.verb == SheriffVerb::kRun) {
    const core::procman::Script* script =
        FindScript(*request_.deployment, request_.targets.front());
    if (script == nullptr) return deputies;
    for (const DeployedCommand& command : CommandsOf(*script, *request_.deployment)) {
      deputies.insert(command.deputy);
    }
    return deputies;
  }
  for (const DeployedCommand& command : request_.deployment->commands) {
    if (IsTargeted(command.spec.id)) deputies.insert(command.deputy);
  }
  return deputies;
}

std::string SheriffVerbRun::Unheard(const std::set<std::string>& deputies) const {
  std::string names;
  for (const std::string& deputy : deputies) {
    if (process_.sheriff().IsHeard(deputy, runtime_.MonotonicUs())) continue;
    names += (names.empty() ? "not heard: deputy " : ", ") + deputy;
  }
  return names;
}

std::vector<core::procman::CommandSpec> SheriffVerbRun::KnownCommands() const {
  std::vector<core::procman::CommandSpec> commands;
  for (const CommandView& view : process_.sheriff().Look(runtime_.MonotonicUs()).commands) {
    core::procman::CommandSpec spec;
    spec.id = view.id;
    spec.group = view.group;
    commands.push_back(std::move(spec));
  }
  return commands;
}

bool SheriffVerbRun::ResolveTargets() {
  targets_.clear();
  if (request_.verb == SheriffVerb::kRun) return true;
  const auto commands = KnownCommands();
  for (const std::string& word : request_.targets) {
    const NamedTarget named = FindTarget(word, commands);
    if (!named.target) {
      Finish(kSheriffUsage, named.problem);
      return false;
    }
    targets_.push_back(*named.target);
  }
  return true;
}

bool SheriffVerbRun::IsTargeted(const std::string& command) const {
  if (targets_.empty()) return true;
  const auto view = process_.sheriff().View(command, runtime_.MonotonicUs());
  if (!view) return false;
  core::procman::CommandSpec spec;
  spec.id = view->id;
  spec.group = view->group;
  return std::any_of(targets_.begin(), targets_.end(), [&](const core::procman::Target& target) {
    return core::procman::IsTargeted(spec, target);
  });
}

Snapshot SheriffVerbRun::LookAtTargets() const {
  Snapshot snapshot = process_.sheriff().Look(runtime_.MonotonicUs());
  std::erase_if(snapshot.commands, [&](const CommandView& view) { return !IsTargeted(view.id); });
  return snapshot;
}

void SheriffVerbRun::Answer() {
  const Snapshot snapshot = LookAtTargets();
  if (!request_.json) printer_.out(StatusTable(snapshot));
  const std::string unheard = Unheard(NeededDeputies());
  if (!unheard.empty()) {
    Finish(kSheriffUnheard, unheard + kUnheardHint);
  } else if (snapshot.deputies.empty()) {
    Finish(kSheriffUnheard, kNobodyHeard);
  } else {
    Finish(0, {});
  }
}

void SheriffVerbRun::Interrupt() {
  if (phase_ == Phase::kStreaming) {
    for (const auto& [prefix, line] : unfinished_lines_) {
      if (!line.empty()) printer_.out(prefix + line);
    }
    Finish(0, {});
  } else if (phase_ != Phase::kDone) {
    Finish(kSheriffFailed, "interrupted; the deputies go on with the last orders");
  }
}

void SheriffVerbRun::Finish(int exit_status, const std::string& text) {
  const bool streams = phase_ == Phase::kStreaming;
  phase_ = Phase::kDone;
  exit_status_ = exit_status;
  if (request_.json && !streams) {
    printer_.out(StatusJson(LookAtTargets(), ResultOf(exit_status), text));
  }
  if (!text.empty()) printer_.error(Printable(text));
  hooks_.done();
}

}  // namespace clearway
