// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <clearway/deputy_health_t.hpp>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/orders_t.hpp>

#include "common/core/procman/orders.hpp"

namespace clearway::messages {

[[nodiscard]] procman_lcm::orders_t ToLcm(const core::procman::Orders& orders);
[[nodiscard]] core::procman::Orders FromLcm(const procman_lcm::orders_t& message);

[[nodiscard]] procman_lcm::deputy_info_t ToLcm(const core::procman::DeputyReport& report);
[[nodiscard]] core::procman::DeputyReport FromLcm(const procman_lcm::deputy_info_t& message);

/// The report in slices of at most `max_message_bytes` (one command at least in each), in order;
/// one slice when there are no commands. Session and sequence are left to the sender.
[[nodiscard]] std::vector<deputy_health_t> ToLcm(const core::procman::DeputyHealth& health,
                                                 std::int64_t utime,
                                                 std::size_t max_message_bytes);

/// Puts the slices of one deputy's reports together again.
class HealthAssembler {
 public:
  /// The whole report once its last slice has come; nothing before. A slice of a newer report gives
  /// up the older one: the next comes within a second. Broken slices are ignored.
  [[nodiscard]] std::optional<core::procman::DeputyHealth> Add(const deputy_health_t& slice);

 private:
  std::int64_t session_ = 0;
  std::int64_t utime_ = 0;
  std::vector<std::optional<deputy_health_t>> slices_;
};

}  // namespace clearway::messages
