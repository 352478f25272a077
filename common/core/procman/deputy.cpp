// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/deputy.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace clearway::core::procman {
namespace {

bool IsValid(const std::vector<DesiredCommand>& commands) {
  std::set<std::string> ids;
  for (const DesiredCommand& command : commands) {
    const std::string& id = command.spec.id;
    if (id.empty() || id.size() > Deputy::kMaxIdBytes || !ids.insert(id).second) return false;
  }
  return commands.size() <= Deputy::kMaxCommands;
}

}  // namespace

Deputy::Deputy(std::string id,
               const RespawnConfig& respawn,
               const HealthConfig& health,
               CommandHost& host)
    : id_(std::move(id)), respawn_(respawn), health_(health), host_(host) {}

OrdersOutcome Deputy::Take(const Orders& orders, std::int64_t now_us) {
  if (orders.deputy_id != id_) return OrdersOutcome::kForOther;
  if (is_shutting_down_) return OrdersOutcome::kShuttingDown;
  if (!IsValid(orders.commands) || orders.sheriff_id.size() > kMaxIdBytes) {
    return OrdersOutcome::kInvalid;
  }
  switch (ledger_.Judge(orders.sheriff_id, orders.utime, now_us)) {
    case OrderLedger::Verdict::kRepeated:
      return OrdersOutcome::kRepeated;
    case OrderLedger::Verdict::kStale:
      return OrdersOutcome::kStale;
    case OrderLedger::Verdict::kNew:
      break;
  }
  Apply(orders.commands, now_us);
  return OrdersOutcome::kTaken;
}

void Deputy::Resume(const std::vector<DesiredCommand>& kept, std::int64_t now_us) {
  if (IsValid(kept)) Apply(kept, now_us);
}

void Deputy::Apply(const std::vector<DesiredCommand>& commands, std::int64_t now_us) {
  has_orders_ = true;
  std::set<std::string> wanted;
  for (const DesiredCommand& desired : commands) wanted.insert(desired.spec.id);
  // What is to go goes first: a new command may need what it holds.
  for (auto& [id, command] : commands_) {
    if (!wanted.contains(id)) command->Remove(now_us);
  }
  std::erase_if(commands_, [](const auto& entry) { return entry.second->MayBeForgotten(); });
  for (const DesiredCommand& desired : commands) {
    std::unique_ptr<ManagedCommand>& command = commands_[desired.spec.id];
    if (!command) {
      command = std::make_unique<ManagedCommand>(desired.spec, respawn_, health_, host_);
    }
    command->Obey(desired, now_us);
  }
}

void Deputy::OnExit(std::int32_t pid, int wait_status, std::int64_t now_us) {
  for (auto& [id, command] : commands_) {
    if (command->pid() != pid) continue;
    command->OnExit(wait_status, now_us);
    break;
  }
  std::erase_if(commands_, [](const auto& entry) { return entry.second->MayBeForgotten(); });
  if (is_shutting_down_) StopNext(now_us);
}

void Deputy::OnStatus(const std::string& channel,
                      std::int32_t pid,
                      const StatusWord& word,
                      std::int64_t now_us) {
  for (auto& [id, command] : commands_) {
    if (command->pid() == pid && command->status_channel() == channel) {
      command->OnStatus(word, now_us);
    }
  }
}

void Deputy::Tick(std::int64_t now_us) {
  for (auto& [id, command] : commands_) command->Tick(now_us);
}

std::optional<std::int64_t> Deputy::NextDue() const {
  std::optional<std::int64_t> due_us;
  for (const auto& [id, command] : commands_) {
    const auto own_us = command->NextDue();
    if (own_us) due_us = std::min(due_us.value_or(*own_us), *own_us);
  }
  return due_us;
}

void Deputy::ShutDown(std::int64_t now_us) {
  if (is_shutting_down_) return;
  is_shutting_down_ = true;
  for (auto& [id, command] : commands_) command->KeepFromStarting();
  StopNext(now_us);
}

// The one that was started last among those that still run; none while one is being stopped.
void Deputy::StopNext(std::int64_t now_us) {
  ManagedCommand* last = nullptr;
  for (auto& [id, command] : commands_) {
    if (command->pid() == 0) continue;
    if (last == nullptr || command->started_us() >= last->started_us()) last = command.get();
  }
  if (last != nullptr) last->ShutDown(now_us);
}

void Deputy::KillAll() {
  for (auto& [id, command] : commands_) command->Kill();
}

bool Deputy::IsDone() const {
  return is_shutting_down_ &&
         std::all_of(commands_.begin(), commands_.end(), [](const auto& entry) {
           return entry.second->pid() == 0;
         });
}

const ManagedCommand* Deputy::CommandOf(std::int32_t pid) const {
  const auto found = std::find_if(commands_.begin(), commands_.end(), [pid](const auto& entry) {
    return entry.second->pid() == pid;
  });
  return found == commands_.end() ? nullptr : found->second.get();
}

std::vector<CommandReport> Deputy::Reports() const {
  std::vector<CommandReport> reports;
  for (const auto& [id, command] : commands_) reports.push_back(command->Report());
  return reports;
}

std::vector<CommandHealthReport> Deputy::Health(std::int64_t now_us) const {
  std::vector<CommandHealthReport> reports;
  for (const auto& [id, command] : commands_) reports.push_back(command->Health(now_us));
  return reports;
}

std::vector<DesiredCommand> Deputy::ToKeep() const {
  std::vector<DesiredCommand> kept;
  for (const auto& [id, command] : commands_) {
    if (!command->is_removed()) kept.push_back(command->ToKeep());
  }
  return kept;
}

}  // namespace clearway::core::procman
