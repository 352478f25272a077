// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/health_watch.hpp"

#include <utility>

namespace clearway::core::procman {

HealthWatch::HealthWatch(const HealthConfig& config, std::int64_t started_us)
    : config_(config), last_sign_us_(started_us) {}

void HealthWatch::OnStatus(const StatusWord& word, std::int64_t now_us) {
  has_status_ = true;
  last_sign_us_ = now_us;
  was_ready_ = was_ready_ || (word.is_ready && !word.is_fault);
  if (word.is_fault) {
    Set(CommandHealth::kUnhealthy, word.text, now_us);
  } else {
    Set(word.is_ready ? CommandHealth::kReady : CommandHealth::kNotReady, word.text, now_us);
  }
}

void HealthWatch::Tick(std::int64_t now_us) {
  if (now_us < NextDue()) return;
  const std::int64_t silent_ms = (now_us - last_sign_us_) / 1000;
  Set(CommandHealth::kUnhealthy,
      (has_status_ ? "its status has stopped: nothing for "
                   : "no status since its start: nothing for ") +
          std::to_string(silent_ms / 1000) + " s",
      now_us);
}

std::int64_t HealthWatch::NextDue() const {
  return last_sign_us_ + (has_status_ ? config_.silence_us : config_.first_status_us);
}

void HealthWatch::Set(CommandHealth health, std::string text, std::int64_t now_us) {
  health_ = health;
  text_ = std::move(text);
  if (health != CommandHealth::kUnhealthy) {
    unhealthy_since_us_.reset();
  } else if (!unhealthy_since_us_) {
    unhealthy_since_us_ = now_us;
  }
}

}  // namespace clearway::core::procman
