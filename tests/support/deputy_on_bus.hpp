// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/messages/channels.hpp"
#include "common/messages/procman.hpp"
#include "common/process/plain_channels.hpp"
#include "tests/support/memory_deputy.hpp"
#include "tests/support/reference_deputy.hpp"

namespace clearway::test {

/// The deputies without processes, on a bus. Looks every 10 ms whether anything is to be done.
template <typename Deputy>
class DeputyOnBus {
 public:
  /// @pre `runtime` outlives it.
  DeputyOnBus(process::Runtime& runtime, const std::string& id) : runtime_(runtime), deputy_(id) {
    const auto fail = [this] { ++invalid; };
    process::Subscribe<procman_lcm::orders_t>(
        runtime_,
        messages::channels::kPmOrders,
        [this](const procman_lcm::orders_t& message) {
          ++orders;
          if (loses_orders()) return;
          Take(messages::FromLcm(message));
          Look();
        },
        fail);
    process::Subscribe<procman_lcm::discovery_t>(
        runtime_,
        messages::channels::kPmDiscover,
        [this](const procman_lcm::discovery_t&) {
          ++discoveries;
          Report();
        },
        fail);
    runtime_.Every(10'000, [this] { Look(); });
  }

  [[nodiscard]] Deputy& deputy() { return deputy_; }

  /// True loses the orders.
  std::function<bool()> loses_orders = [] { return false; };
  /// Reports nothing while it is true.
  bool is_mute = false;
  int orders = 0;  ///< That were sent to any deputy.
  int discoveries = 0;
  int invalid = 0;

  void Print(const std::string& command, const std::string& text) {
    procman_lcm::output_t message;
    message.utime = runtime_.UtimeNow();
    message.deputy_id = deputy_.id();
    message.num_commands = 1;
    message.command_ids = {command};
    message.text = {text};
    process::Publish(runtime_, messages::channels::kPmOutput, message);
  }

 private:
  void Take(const core::procman::Orders& message) {
    if constexpr (std::is_same_v<Deputy, ReferenceDeputy>) {
      deputy_.TakeOrders(message, runtime_.MonotonicUs(), runtime_.UtimeNow());
    } else {
      deputy_.TakeOrders(message, runtime_.MonotonicUs());
    }
  }

  void Look() {
    deputy_.Tick(runtime_.MonotonicUs());
    if (deputy_.IsReportDue(runtime_.MonotonicUs())) Report();
  }

  void Report() {
    if (is_mute) return;
    const std::int64_t utime = runtime_.UtimeNow();
    process::Publish(runtime_, messages::channels::kPmInfo, messages::ToLcm(deputy_.Report(utime)));
    if constexpr (std::is_same_v<Deputy, MemoryDeputy>) {
      const auto slices = messages::ToLcm(deputy_.Health(runtime_.MonotonicUs()), utime, 400);
      for (const deputy_health_t& slice : slices) {
        process::Publish(runtime_, messages::channels::kPmHealth, slice);
      }
    }
  }

  process::Runtime& runtime_;
  Deputy deputy_;
};

}  // namespace clearway::test
