// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/timers.hpp"

#include <algorithm>
#include <stdexcept>

namespace clearway::process {

Timers::Id Timers::Add(std::int64_t due_us,
                       std::int64_t period_us,
                       std::function<void()> callback) {
  if (period_us < 0) throw std::invalid_argument("Timers::Add: negative period");
  const Id id = next_id_++;
  timers_.emplace(std::pair(due_us, id), Timer{period_us, std::move(callback)});
  return id;
}

void Timers::Cancel(Id id) {
  const auto found = std::find_if(
      timers_.begin(), timers_.end(), [id](const auto& entry) { return entry.first.second == id; });
  if (found != timers_.end()) timers_.erase(found);
}

std::optional<std::int64_t> Timers::NextDue() const {
  if (timers_.empty()) return std::nullopt;
  return timers_.begin()->first.first;
}

bool Timers::RunOne(std::int64_t now_us) {
  if (timers_.empty() || timers_.begin()->first.first > now_us) return false;
  auto node = timers_.extract(timers_.begin());
  const auto [due_us, id] = node.key();
  // The callback may cancel its own timer: keep a copy of what runs, and put the timer back first.
  const std::function<void()> callback = node.mapped().callback;
  const std::int64_t period_us = node.mapped().period_us;
  if (period_us > 0) {
    const std::int64_t missed = (now_us - due_us) / period_us;
    node.key() = std::pair(due_us + (missed + 1) * period_us, id);
    timers_.insert(std::move(node));
  }
  callback();
  return true;
}

}  // namespace clearway::process
