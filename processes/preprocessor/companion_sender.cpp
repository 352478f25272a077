// SPDX-License-Identifier: BSD-3-Clause
#include "processes/preprocessor/companion_sender.hpp"

namespace clearway {

namespace {

// The node gives up old bursts beyond about this many; what it still has to send is no more.
constexpr std::int64_t kMostBursts = 5;

// Of each channel; a process that was held up for a while hands on several scans at once.
constexpr std::ptrdiff_t kMostWaiting = 4;

}  // namespace

void CompanionSender::NoteObstacles(std::size_t num_slices, std::int64_t interval_us) {
  const std::int64_t now_us = node_.runtime().MonotonicUs();
  const std::int64_t duration_us = static_cast<std::int64_t>(num_slices) * interval_us;
  obstacles_until_us_ = std::min(std::max(obstacles_until_us_, now_us) + duration_us,
                                 now_us + kMostBursts * duration_us);
}

void CompanionSender::Enqueue(Burst burst) {
  const auto first_waiting = bursts_.begin() + (has_begun_ ? 1 : 0);
  const auto is_same = [&burst](const Burst& other) { return other.channel == burst.channel; };
  if (std::count_if(first_waiting, bursts_.end(), is_same) >= kMostWaiting) {
    const auto oldest = std::find_if(first_waiting, bursts_.end(), is_same);
    node_.CountDropped(std::ssize(oldest->slices));
    bursts_.erase(oldest);
  }
  bursts_.push_back(std::move(burst));
  if (!is_scheduled_) SendNext();
}

void CompanionSender::SendNext() {
  is_scheduled_ = false;
  if (bursts_.empty()) return;
  const std::int64_t wait_us = BacklogUs();
  if (wait_us > 0) {
    SendNextIn(wait_us);
    return;
  }
  Burst& burst = bursts_.front();
  const std::int64_t interval_us = burst.interval_us;
  burst.slices.front()();
  burst.slices.pop_front();
  has_begun_ = !burst.slices.empty();
  if (!has_begun_) bursts_.pop_front();
  SendNextIn(interval_us);
}

void CompanionSender::SendNextIn(std::int64_t delay_us) {
  is_scheduled_ = true;
  node_.runtime().After(delay_us, [this] { SendNext(); });
}

}  // namespace clearway
