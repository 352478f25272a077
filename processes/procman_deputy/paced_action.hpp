// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "common/process/runtime.hpp"

namespace clearway {

/// What anybody on the bus, or many children at once, can ask for faster than it can be done. It is
/// done once for all that asked, right after the events at hand; and once an interval where that
/// has happened more than `burst` times in a row.
class PacedAction {
 public:
  struct Pace {
    std::int64_t interval_us = 0;
    int burst = 0;
  };

  /// @pre `runtime` outlives it.
  PacedAction(process::Runtime& runtime, const Pace& pace, std::function<void()> action);
  ~PacedAction();
  PacedAction(const PacedAction&) = delete;
  PacedAction& operator=(const PacedAction&) = delete;

  void Ask();
  /// Does at once what was asked for and has not been done yet.
  void Flush();

 private:
  void Act();

  process::Runtime& runtime_;
  Pace pace_;
  std::function<void()> action_;
  std::optional<process::Runtime::TimerId> timer_;
  std::int64_t even_us_ = 0;  // When the next would be due at an even pace.
};

}  // namespace clearway
