// SPDX-License-Identifier: BSD-3-Clause
// What a sheriff makes of what it was told.
#include <array>
#include <csignal>
#include <sys/wait.h>
#include <utility>

#include "common/core/procman/managed_command.hpp"
#include "common/core/procman/sheriff.hpp"

namespace clearway::core::procman {
namespace {

constexpr std::int64_t kSilentUs = 3'000'000;
// After this a deputy does not tell its health any more: what runs is taken from its report alone.
constexpr std::int64_t kHealthLastsUs = 5'000'000;
// The longest pause of the reference deputy between two starts, and one report.
constexpr std::int64_t kReferencePauseUs = 2'000'000;

constexpr std::array<std::pair<std::string_view, std::string_view>, kStatusCount> kNames = {{
    {"unknown", "Unknown"},
    {"stopped", "Stopped"},
    {"failed", "Failed"},
    {"starting", "Starting"},
    {"getting_ready", "Getting ready"},
    {"running", "Running"},
    {"unhealthy", "Unhealthy"},
    {"backing_off", "Backing off"},
    {"gave_up", "Gave up"},
    {"refused", "Refused"},
    {"restarting", "Restarting"},
    {"stopping", "Stopping"},
    {"moving", "Moving"},
    {"removing", "Removing"},
}};

std::string Seconds(std::int64_t us) {
  return std::to_string(us / 1'000'000) + " s";
}

// How a run ended that is over.
bool EndedWell(const KnownCommand& command, const CommandReport& report) {
  const int code = report.exit_code;
  if (code == 0) return true;
  const int signal = WIFSIGNALED(code) ? WTERMSIG(code) : 0;
  if (signal == SIGINT || signal == SIGTERM || signal == report.spec.stop_signal) return true;
  if (!command.was_stopped) return false;
  // A shell tells by 128 + n that signal n ended what it ran.
  const int told = WIFEXITED(code) ? WEXITSTATUS(code) - 128 : 0;
  return signal == SIGKILL || told == SIGINT || told == SIGTERM || told == SIGKILL ||
         (told > 0 && told == report.spec.stop_signal);
}

}  // namespace

std::string_view NameOf(Status status) {
  return kNames.at(static_cast<std::size_t>(status)).first;
}

std::string_view WordsFor(Status status) {
  return kNames.at(static_cast<std::size_t>(status)).second;
}

const KnownDeputy* Sheriff::Find(const std::string& deputy) const {
  const auto found = deputies_.find(deputy);
  return found == deputies_.end() ? nullptr : &found->second;
}

bool Sheriff::IsHeard(const std::string& deputy, std::int64_t now_us) const {
  const KnownDeputy* known = Find(deputy);
  return known != nullptr && known->report && now_us - known->heard_us <= kSilentUs;
}

Sheriff::Copy Sheriff::CopyOn(const KnownDeputy* deputy,
                              const std::string& command,
                              std::int64_t now_us) {
  Copy copy{.deputy = deputy};
  if (deputy == nullptr) return copy;
  copy.is_told = deputy->health && now_us - deputy->health_us <= kHealthLastsUs;
  const auto listed = deputy->commands.find(command);
  if (listed == deputy->commands.end()) return copy;
  copy.reported = &listed->second;
  const auto health = deputy->healths.find(command);
  if (!copy.is_told || health == deputy->healths.end() || listed->second.is_health_old) return copy;
  // The one of the two messages that came first is ahead of the other.
  const bool is_up = health->second.state == CommandState::kRunning ||
                     health->second.state == CommandState::kStopping;
  if (is_up == (listed->second.report.pid != 0)) copy.health = &health->second;
  return copy;
}

// A deputy where it runs although it is to run on another; null when there is none.
const KnownDeputy* Sheriff::Elsewhere(const KnownCommand& command) const {
  for (const auto& [id, deputy] : deputies_) {
    const auto listed = deputy.commands.find(command.spec.id);
    if (id != command.deputy && listed != deputy.commands.end() && listed->second.report.pid != 0) {
      return &deputy;
    }
  }
  return nullptr;
}

Sheriff::Judgement Sheriff::Judge(const KnownCommand& command, std::int64_t now_us) const {
  const KnownDeputy* home = Find(command.deputy);
  const Copy copy = CopyOn(home, command.spec.id, now_us);
  const bool runs_at_home = copy.reported != nullptr && copy.reported->report.pid != 0;
  const KnownDeputy* elsewhere = Elsewhere(command);
  if (const KnownDeputy* obstacle = Obstacle(command, now_us)) {
    if (IsHeard(obstacle->id, now_us)) {
      return {Status::kMoving, "has to end on " + obstacle->id + " first"};
    }
    return {Status::kMoving,
            "ran on " + obstacle->id + " when that was last heard, " +
                Seconds(now_us - obstacle->heard_us) +
                " ago: not started as long as it may still run there, unless by force"};
  }
  if (elsewhere != nullptr && !runs_at_home && (!command.is_asked || command.force_quit)) {
    if (!IsHeard(elsewhere->id, now_us)) {
      return {Status::kUnknown,
              "ran on " + elsewhere->id + ", which is silent for " +
                  Seconds(now_us - elsewhere->heard_us)};
    }
    if (command.is_asked) return {Status::kStopping, "on " + elsewhere->id};
    Judgement there =
        JudgeCopy({.spec = command.spec}, CopyOn(elsewhere, command.spec.id, now_us), now_us);
    there.text = "runs on " + elsewhere->id + "; a start or restart moves it" +
                 (there.text.empty() ? "" : "; " + there.text);
    return there;
  }
  if (home == nullptr || !home->report) {
    return {Status::kUnknown, "deputy " + command.deputy + " is not heard"};
  }
  if (!IsHeard(command.deputy, now_us)) {
    return {Status::kUnknown,
            "deputy " + command.deputy + " is silent for " + Seconds(now_us - home->heard_us)};
  }
  return JudgeCopy(command, copy, now_us);
}

Sheriff::Judgement Sheriff::JudgeCopy(const KnownCommand& command,
                                      const Copy& copy,
                                      std::int64_t now_us) {
  const bool is_to_run = !command.force_quit && !command.is_removed && command.run_id != 0;
  if (copy.reported == nullptr) {
    if (is_to_run) return {Status::kStarting, {}};
    return {Status::kStopped, "not started yet"};
  }
  const CommandReport& report = copy.reported->report;
  const bool is_new_run = is_to_run && command.run_id != report.run_id;
  if (command.is_removed) return {Status::kRemoving, {}};
  if (report.pid == 0) {
    return is_new_run ? Judgement{Status::kStarting, {}} : JudgeEnded(command, copy, now_us);
  }
  if (command.force_quit) {
    return {Status::kStopping, copy.health != nullptr ? copy.health->text : ""};
  }
  return is_new_run ? Judgement{Status::kRestarting, {}} : JudgeRunning(copy);
}

// It has no process, and no order that would give it one.
Sheriff::Judgement Sheriff::JudgeEnded(const KnownCommand& command,
                                       const Copy& copy,
                                       std::int64_t now_us) {
  const CommandReport& report = copy.reported->report;
  const CommandHealthReport* health = copy.health;
  if (!command.force_quit && health != nullptr) {
    if (health->state == CommandState::kRefused) return {Status::kRefused, health->text};
    if (health->state == CommandState::kGaveUp) return {Status::kGaveUp, health->text};
    if (health->state == CommandState::kBackingOff) return {Status::kBackingOff, health->text};
  }
  if (report.run_id == 0) return {Status::kStopped, "not started yet"};
  const std::string end = DescribeExit(report.exit_code);
  const bool starts_again =
      copy.is_told ? health == nullptr : now_us - copy.reported->since_us < kReferencePauseUs;
  if (!command.force_quit && report.spec.auto_respawn && copy.reported->was_seen_up &&
      starts_again) {
    return {Status::kBackingOff, end, copy.is_told};
  }
  return {EndedWell(command, report) ? Status::kStopped : Status::kFailed,
          end,
          copy.is_told && health == nullptr};
}

// It has a process and is to have it.
Sheriff::Judgement Sheriff::JudgeRunning(const Copy& copy) {
  if (!copy.is_told) return {Status::kRunning, {}};
  const auto last = copy.deputy->healths.find(copy.reported->report.spec.id);
  const CommandHealthReport* health = copy.health;
  if (health == nullptr) {
    // The report was quicker than the health of this run: it is not known to be ready, unless
    // readiness was never asked of it.
    const bool counts_as_ready = last != copy.deputy->healths.end() && last->second.starts > 0 &&
                                 last->second.health == CommandHealth::kNotExpected &&
                                 last->second.state == CommandState::kRunning;
    return {counts_as_ready ? Status::kRunning : Status::kGettingReady, {}, !counts_as_ready};
  }
  if (health->state == CommandState::kStopping) return {Status::kStopping, health->text};
  if (health->health == CommandHealth::kNotReady) return {Status::kGettingReady, health->text};
  if (health->health == CommandHealth::kUnhealthy) return {Status::kUnhealthy, health->text};
  return {Status::kRunning, health->text};
}

void Sheriff::NoteChanges(std::int64_t now_us, std::optional<std::int64_t> utime) {
  // Without a message that shows it: the deputy's own clock, carried on.
  const auto stamp_of = [&](const KnownDeputy* deputy) {
    if (utime) return *utime;
    return deputy == nullptr || !deputy->report
               ? 0
               : deputy->report->utime + (now_us - deputy->heard_us);
  };
  for (auto& [id, deputy] : deputies_) {
    const bool is_heard = IsHeard(id, now_us);
    if (is_heard == deputy.was_heard) continue;
    deputy.was_heard = is_heard;
    Note({.utime = stamp_of(&deputy),
          .kind = Change::Kind::kDeputy,
          .deputy = id,
          .command = {},
          .from = is_heard ? "Silent" : "Heard",
          .to = is_heard ? "Heard" : "Silent",
          .text = {}});
  }
  for (auto& [id, command] : commands_) {
    Judgement judgement = Judge(command, now_us);
    if (judgement.is_provisional) continue;
    const Status before = command.noted.value_or(Status::kUnknown);
    command.noted = judgement.status;
    if (judgement.status == before) continue;
    Note({.utime = stamp_of(Find(command.deputy)),
          .deputy = command.deputy,
          .command = id,
          .from = std::string(WordsFor(before)),
          .to = std::string(WordsFor(judgement.status)),
          .before = before,
          .status = judgement.status,
          .text = std::move(judgement.text)});
  }
}

void Sheriff::Note(Change change) {
  change.sequence = next_change_++;
  history_.push_back(std::move(change));
  if (history_.size() > kMaxHistory) history_.pop_front();
}

}  // namespace clearway::core::procman
