// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/memory_deputy.hpp"

#include <algorithm>
#include <csignal>
#include <sstream>

namespace clearway::test {
namespace {

constexpr std::int64_t kPeriodUs = 1'000'000;
constexpr std::int64_t kDyingUs = 5'000;

std::string Channel(std::int32_t pid) {
  return "STATUS_" + std::to_string(pid);
}

// What a change of makes a report due.
std::string Digest(const core::procman::DeputyHealth& health) {
  std::string digest;
  for (const auto& command : health.commands) {
    digest += command.id + std::to_string(static_cast<int>(command.state)) +
              std::to_string(static_cast<int>(command.health)) + std::to_string(command.starts) +
              command.text + "\n";
  }
  return digest;
}

}  // namespace

core::procman::StartOutcome MemoryDeputy::Host::Start(const core::procman::CommandSpec& spec) {
  std::istringstream words(spec.exec);
  std::string verb;
  words >> verb;
  core::procman::StartOutcome outcome;
  if (verb == "forbidden") {
    outcome.problem = "no rule allows it";
    outcome.is_refused = true;
    return outcome;
  }
  Process process;
  process.spec = spec;
  outcome.pid = next_pid++;
  if (verb == "end") {
    int code = 0;
    std::int64_t lives_ms = 0;
    words >> code >> lives_ms;
    process.ends_us = now_us + lives_ms * 1000;
    process.end_code = code << 8;
  } else if (verb == "ready" || verb == "sick") {
    std::int64_t after_ms = 0;
    words >> after_ms;
    process.next_status_us = now_us + after_ms * 1000;
    process.is_sick = verb == "sick";
    outcome.status_channel = Channel(outcome.pid);
  } else if (verb == "mute") {
    outcome.status_channel = Channel(outcome.pid);
  }
  processes[outcome.pid] = process;
  started.push_back(spec.id);
  is_changed = true;
  return outcome;
}

void MemoryDeputy::Host::Signal(std::int32_t pid, int signal) {
  Process& process = processes.at(pid);
  if (process.spec.exec == "stubborn" && signal != SIGKILL) return;
  process.ends_us = now_us + kDyingUs;
  process.end_code = signal;
}

void MemoryDeputy::Host::Note(const std::string& command_id, const std::string& text) {
  (void)command_id;
  (void)text;
  is_changed = true;
}

int MemoryDeputy::Host::StartsOf(const std::string& id) const {
  return static_cast<int>(std::count(started.begin(), started.end(), id));
}

MemoryDeputy::MemoryDeputy(std::string id) : deputy_(std::move(id), {}, {}, host_) {}

void MemoryDeputy::TakeOrders(const core::procman::Orders& orders, std::int64_t now_us) {
  host_.now_us = now_us;
  if (deputy_.Take(orders, now_us) == core::procman::OrdersOutcome::kTaken) return;
}

void MemoryDeputy::Tick(std::int64_t now_us) {
  host_.now_us = now_us;
  std::vector<std::pair<std::int32_t, int>> ended;
  for (auto& [pid, process] : host_.processes) {
    if (process.ends_us >= 0 && now_us >= process.ends_us)
      ended.emplace_back(pid, process.end_code);
    if (process.next_status_us < 0 || now_us < process.next_status_us) continue;
    process.next_status_us = now_us + kPeriodUs;
    deputy_.OnStatus(Channel(pid),
                     pid,
                     {.is_fault = process.is_sick,
                      .is_ready = !process.is_sick,
                      .text = process.is_sick ? "no sensor" : ""},
                     now_us);
  }
  for (const auto& [pid, code] : ended) {
    host_.processes.erase(pid);
    host_.is_changed = true;
    deputy_.OnExit(pid, code, now_us);
  }
  deputy_.Tick(now_us);
  const std::string health = Digest(Health(now_us));
  if (health != last_health_) host_.is_changed = true;
  last_health_ = health;
}

bool MemoryDeputy::IsReportDue(std::int64_t now_us) {
  if (!host_.is_changed && now_us - reported_us_ < kPeriodUs) return false;
  host_.is_changed = false;
  reported_us_ = now_us;
  return true;
}

core::procman::DeputyReport MemoryDeputy::Report(std::int64_t utime) const {
  core::procman::DeputyReport report;
  report.utime = utime;
  report.deputy_id = deputy_.id();
  report.cpu_load = 0.25F;
  report.commands = deputy_.Reports();
  return report;
}

core::procman::DeputyHealth MemoryDeputy::Health(std::int64_t now_us) const {
  core::procman::DeputyHealth health;
  health.deputy_id = deputy_.id();
  health.host = "memory";
  health.version = "test";
  health.sheriff_id = deputy_.ledger().current();
  health.orders_age_us = deputy_.ledger().AgeUs(now_us);
  health.commands = deputy_.Health(now_us);
  return health;
}

bool MemoryDeputy::IsUp(const std::string& id) const {
  const auto reports = deputy_.Reports();
  return std::any_of(reports.begin(), reports.end(), [&](const auto& report) {
    return report.spec.id == id && report.pid != 0;
  });
}

}  // namespace clearway::test
