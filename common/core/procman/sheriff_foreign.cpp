// SPDX-License-Identifier: BSD-3-Clause
// What a sheriff takes from other sheriffs.
#include <algorithm>
#include <set>
#include <utility>

#include "common/core/procman/sheriff.hpp"

namespace clearway::core::procman {
namespace {

constexpr std::size_t kMaxSheriffs = 64;

}  // namespace

void Sheriff::OnForeignOrders(const Orders& orders, std::int64_t now_us) {
  if (orders.sheriff_id == id_ || orders.deputy_id.empty() || !IsInScope(orders.deputy_id)) return;
  if (sheriffs_us_.size() >= kMaxSheriffs && !sheriffs_us_.contains(orders.sheriff_id)) {
    sheriffs_us_.erase(std::min_element(
        sheriffs_us_.begin(), sheriffs_us_.end(), [](const auto& a, const auto& b) {
          return a.second < b.second;
        }));
  }
  sheriffs_us_[orders.sheriff_id] = now_us;
  if (deputies_.size() >= kMaxDeputies && !deputies_.contains(orders.deputy_id)) return;
  KnownDeputy& deputy = deputies_[orders.deputy_id];
  deputy.id = orders.deputy_id;
  if (deputy.orders_by != orders.sheriff_id) {
    Note({.utime = orders.utime,
          .kind = Change::Kind::kSheriff,
          .deputy = deputy.id,
          .command = {},
          .from = deputy.orders_by,
          .to = orders.sheriff_id,
          .text = {}});
  }
  deputy.orders_by = orders.sheriff_id;
  deputy.orders_us = now_us;
  if (mode_ == Mode::kObserve) {
    std::set<std::string> ordered;
    for (const DesiredCommand& desired : orders.commands) {
      if (!desired.spec.id.empty() && ordered.insert(desired.spec.id).second) {
        Mirror(desired, deputy);
      }
    }
    for (auto& [id, command] : commands_) {
      if (command.deputy != deputy.id || ordered.contains(id)) continue;
      command.is_mirrored = false;
      command.is_removed = deputy.commands.contains(id);
    }
    TakeWhatTheReportLacks(deputy, now_us);
  }
  NoteChanges(now_us, orders.utime);
}

void Sheriff::Mirror(const DesiredCommand& desired, const KnownDeputy& deputy) {
  if (commands_.size() >= kMaxCommands && !commands_.contains(desired.spec.id)) return;
  const auto [entry, is_new] = commands_.try_emplace(desired.spec.id);
  KnownCommand& command = entry->second;
  if (is_new) command.deputy = deputy.id;
  if (command.deputy != deputy.id) return;
  if (!command.is_in_file) command.spec = desired.spec;
  const auto listed = deputy.commands.find(desired.spec.id);
  const bool is_up = listed != deputy.commands.end() && listed->second.report.pid != 0;
  if (!desired.force_quit) command.was_stopped = false;
  // An order to end what has ended already only keeps it so.
  if (desired.force_quit && !command.force_quit) command.was_stopped = is_up;
  command.run_id = desired.run_id;
  command.force_quit = desired.force_quit;
  command.is_mirrored = true;
  command.is_removed = false;
}

std::optional<OtherSheriff> Sheriff::ActiveOther(std::int64_t now_us) const {
  std::optional<OtherSheriff> other;
  const auto consider = [&](const std::string& id, std::int64_t age_us, bool was_heard) {
    if (id.empty() || id == id_ || age_us > kOrdersActiveUs) return;
    if (!other || age_us < other->age_us) {
      other = {id, age_us, was_heard || (other && other->id == id && other->was_heard)};
    }
    if (other->id == id) other->was_heard = other->was_heard || was_heard;
  };
  for (const auto& [id, heard_us] : sheriffs_us_) consider(id, now_us - heard_us, true);
  for (const auto& [id, deputy] : deputies_) {
    if (!deputy.health || deputy.health->orders_age_us < 0) continue;
    const std::int64_t age_us = deputy.health->orders_age_us + now_us - deputy.health_us;
    consider(deputy.health->sheriff_id, age_us, false);
  }
  return other;
}

}  // namespace clearway::core::procman
