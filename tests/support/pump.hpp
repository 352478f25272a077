// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <utility>

#include "common/process/runtime.hpp"

namespace clearway::test {

/// Calls `step` every 20 ms while it lives.
class Pump {
 public:
  Pump(process::Runtime& runtime, std::function<void()> step)
      : runtime_(runtime), timer_(runtime.Every(20'000, std::move(step))) {}
  ~Pump() { runtime_.Cancel(timer_); }
  Pump(const Pump&) = delete;
  Pump& operator=(const Pump&) = delete;

 private:
  process::Runtime& runtime_;
  process::Runtime::TimerId timer_;
};

}  // namespace clearway::test
