// SPDX-License-Identifier: BSD-3-Clause
#include "tools/teleop/operator_wish.hpp"

#include <algorithm>

namespace clearway::teleop {
namespace {

int StepTo(int steps, int change) {
  return std::clamp(steps + change, -OperatorWish::kSteps, OperatorWish::kSteps);
}

double Share(int steps) {
  return static_cast<double>(steps) / OperatorWish::kSteps;
}

}  // namespace

void OperatorWish::Stop() {
  forward_ = 0;
  left_ = 0;
  last_.reset();
}

void OperatorWish::OnKey(Key key, std::int64_t now_us) {
  if (key == Key::kStop || key == Key::kQuit) {
    Stop();
    return;
  }
  if (key == Key::kOther) return;
  if (last_ && now_us - last_us_ > kDeadMan_us) Stop();
  const bool is_repeat = last_ == key && now_us - last_us_ <= kRepeat_us;
  last_ = key;
  last_us_ = now_us;
  if (is_repeat) return;
  if (key == Key::kForward) forward_ = StepTo(forward_, 1);
  if (key == Key::kBackward) forward_ = StepTo(forward_, -1);
  if (key == Key::kLeft) left_ = StepTo(left_, 1);
  if (key == Key::kRight) left_ = StepTo(left_, -1);
}

core::BaseMotion OperatorWish::At(std::int64_t now_us) const {
  if (!last_ || now_us - last_us_ > kDeadMan_us) return {};
  return {Share(forward_) * (forward_ < 0 ? limits_.backward_mps : limits_.forward_mps),
          Share(left_) * limits_.turn_radps};
}

}  // namespace clearway::teleop
