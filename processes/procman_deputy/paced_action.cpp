// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_deputy/paced_action.hpp"

#include <algorithm>
#include <utility>

namespace clearway {

PacedAction::PacedAction(process::Runtime& runtime, const Pace& pace, std::function<void()> action)
    : runtime_(runtime), pace_(pace), action_(std::move(action)) {}

PacedAction::~PacedAction() {
  if (timer_) runtime_.Cancel(*timer_);
}

void PacedAction::Ask() {
  if (timer_) return;
  const std::int64_t due_us = even_us_ - pace_.burst * pace_.interval_us;
  timer_ = runtime_.After(due_us - runtime_.MonotonicUs(), [this] { Act(); });
}

void PacedAction::Flush() {
  if (!timer_) return;
  runtime_.Cancel(*timer_);
  Act();
}

void PacedAction::Act() {
  timer_.reset();
  even_us_ = std::max(even_us_, runtime_.MonotonicUs()) + pace_.interval_us;
  action_();
}

}  // namespace clearway
