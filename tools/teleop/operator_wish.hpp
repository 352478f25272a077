// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/core/guard/base_gate.hpp"
#include "tools/teleop/keys.hpp"

namespace clearway::teleop {

/// Top speeds that keys can ask for, all positive.
struct OperatorLimits {
  double forward_mps = 1.0;
  double backward_mps = 0.5;
  double turn_radps = 1.5;
};

/// What an operator's keys ask the vehicle to do. Each press of a key is one of kSteps steps up to
/// the limit. A key that is held down repeats: what comes again within kRepeat_us is no new press,
/// but keeps the wish alive. Without any key that drives for kDeadMan_us the wish is standstill.
/// Thread safety: none.
class OperatorWish {
 public:
  static constexpr int kSteps = 5;
  static constexpr std::int64_t kRepeat_us = 100'000;
  static constexpr std::int64_t kDeadMan_us = 600'000;

  explicit OperatorWish(const OperatorLimits& limits) : limits_(limits) {}

  /// A key was pressed; `now_us` on a clock that never jumps.
  void OnKey(Key key, std::int64_t now_us);

  [[nodiscard]] core::BaseMotion At(std::int64_t now_us) const;

 private:
  void Stop();

  OperatorLimits limits_;
  int forward_ = 0;  // Steps, -kSteps .. kSteps.
  int left_ = 0;
  std::optional<Key> last_;
  std::int64_t last_us_ = 0;
};

}  // namespace clearway::teleop
