// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/procman.hpp"

#include <algorithm>

namespace clearway::messages {
namespace {

using core::procman::CommandHealth;
using core::procman::CommandHealthReport;
using core::procman::CommandReport;
using core::procman::CommandSpec;
using core::procman::CommandState;
using core::procman::DeputyHealth;
using core::procman::DeputyReport;
using core::procman::DesiredCommand;
using core::procman::Orders;

// More slices than any report needs: what claims more is not believed.
constexpr std::int32_t kMaxSlices = 4096;

procman_lcm::cmd_t ToLcm(const CommandSpec& spec) {
  return {spec.id,
          spec.exec,
          spec.group,
          static_cast<std::int8_t>(spec.auto_respawn),
          static_cast<std::int8_t>(spec.stop_signal),
          spec.stop_time_allowed_s};
}

CommandSpec FromLcm(const procman_lcm::cmd_t& message) {
  return {.id = message.command_id,
          .exec = message.exec_str,
          .group = message.group,
          .auto_respawn = message.auto_respawn != 0,
          .stop_signal = message.stop_signal,
          .stop_time_allowed_s = message.stop_time_allowed};
}

command_health_t ToLcm(const CommandHealthReport& report) {
  command_health_t message;
  message.command_id = report.id;
  message.state = static_cast<std::int8_t>(report.state);
  message.health = static_cast<std::int8_t>(report.health);
  message.text = report.text;
  message.starts = report.starts;
  message.quick_deaths = report.quick_deaths;
  message.running_us = report.running_us;
  message.dropped_output_bytes = report.dropped_output_bytes;
  return message;
}

// A number that this program does not know is taken as the state that claims least.
CommandHealthReport FromLcm(const command_health_t& message) {
  const bool known = message.state >= command_health_t::STATE_STOPPED &&
                     message.state <= command_health_t::STATE_REFUSED &&
                     message.health >= command_health_t::HEALTH_NOT_EXPECTED &&
                     message.health <= command_health_t::HEALTH_UNHEALTHY;
  return {.id = message.command_id,
          .state = known ? CommandState{message.state} : CommandState::kStopped,
          .health = known ? CommandHealth{message.health} : CommandHealth::kUnhealthy,
          .text = message.text,
          .starts = message.starts,
          .quick_deaths = message.quick_deaths,
          .running_us = message.running_us,
          .dropped_output_bytes = message.dropped_output_bytes};
}

deputy_health_t HeaderOf(const DeputyHealth& health, std::int64_t utime) {
  deputy_health_t message{};
  message.utime = utime;
  message.deputy_id = health.deputy_id;
  message.host = health.host;
  message.version = health.version;
  message.config_digest = health.config_digest;
  message.sheriff_id = health.sheriff_id;
  message.orders_age_us = health.orders_age_us;
  message.text = health.text;
  return message;
}

}  // namespace

procman_lcm::orders_t ToLcm(const Orders& orders) {
  procman_lcm::orders_t message;
  message.utime = orders.utime;
  message.deputy_id = orders.deputy_id;
  message.sheriff_id = orders.sheriff_id;
  message.ncmds = static_cast<std::int32_t>(orders.commands.size());
  for (const DesiredCommand& command : orders.commands) {
    procman_lcm::cmd_desired_t desired;
    desired.cmd = ToLcm(command.spec);
    desired.desired_runid = command.run_id;
    desired.force_quit = static_cast<std::int8_t>(command.force_quit);
    message.cmds.push_back(std::move(desired));
  }
  return message;
}

Orders FromLcm(const procman_lcm::orders_t& message) {
  Orders orders{.utime = message.utime,
                .deputy_id = message.deputy_id,
                .sheriff_id = message.sheriff_id,
                .commands = {}};
  for (const procman_lcm::cmd_desired_t& desired : message.cmds) {
    orders.commands.push_back({.spec = FromLcm(desired.cmd),
                               .run_id = desired.desired_runid,
                               .force_quit = desired.force_quit != 0});
  }
  return orders;
}

procman_lcm::deputy_info_t ToLcm(const DeputyReport& report) {
  procman_lcm::deputy_info_t message;
  message.utime = report.utime;
  message.deputy_id = report.deputy_id;
  message.cpu_load = report.cpu_load;
  message.phys_mem_total_bytes = report.phys_mem_total_bytes;
  message.phys_mem_free_bytes = report.phys_mem_free_bytes;
  message.swap_total_bytes = report.swap_total_bytes;
  message.swap_free_bytes = report.swap_free_bytes;
  message.ncmds = static_cast<std::int32_t>(report.commands.size());
  for (const CommandReport& command : report.commands) {
    procman_lcm::cmd_status_t status;
    status.cmd = ToLcm(command.spec);
    status.pid = command.pid;
    status.actual_runid = command.run_id;
    status.exit_code = command.exit_code;
    status.cpu_usage = command.cpu_usage;
    status.mem_vsize_bytes = command.mem_vsize_bytes;
    status.mem_rss_bytes = command.mem_rss_bytes;
    message.cmds.push_back(std::move(status));
  }
  return message;
}

DeputyReport FromLcm(const procman_lcm::deputy_info_t& message) {
  DeputyReport report{.utime = message.utime,
                      .deputy_id = message.deputy_id,
                      .cpu_load = message.cpu_load,
                      .phys_mem_total_bytes = message.phys_mem_total_bytes,
                      .phys_mem_free_bytes = message.phys_mem_free_bytes,
                      .swap_total_bytes = message.swap_total_bytes,
                      .swap_free_bytes = message.swap_free_bytes,
                      .commands = {}};
  for (const procman_lcm::cmd_status_t& status : message.cmds) {
    report.commands.push_back({.spec = FromLcm(status.cmd),
                               .pid = status.pid,
                               .run_id = status.actual_runid,
                               .exit_code = status.exit_code,
                               .cpu_usage = status.cpu_usage,
                               .mem_vsize_bytes = status.mem_vsize_bytes,
                               .mem_rss_bytes = status.mem_rss_bytes});
  }
  return report;
}

std::vector<deputy_health_t> ToLcm(const DeputyHealth& health,
                                   std::int64_t utime,
                                   std::size_t max_message_bytes) {
  std::vector<deputy_health_t> slices{HeaderOf(health, utime)};
  std::size_t bytes = static_cast<std::size_t>(slices.back().getEncodedSize());
  for (const CommandHealthReport& report : health.commands) {
    command_health_t command = ToLcm(report);
    const auto more = static_cast<std::size_t>(command._getEncodedSizeNoHash());
    if (!slices.back().commands.empty() && bytes + more > max_message_bytes) {
      slices.push_back(HeaderOf(health, utime));
      bytes = static_cast<std::size_t>(slices.back().getEncodedSize());
    }
    slices.back().commands.push_back(std::move(command));
    bytes += more;
  }
  for (std::size_t i = 0; i < slices.size(); ++i) {
    slices[i].slice_index = static_cast<std::int32_t>(i);
    slices[i].slice_count = static_cast<std::int32_t>(slices.size());
    slices[i].n = static_cast<std::int32_t>(slices[i].commands.size());
  }
  return slices;
}

std::optional<DeputyHealth> HealthAssembler::Add(const deputy_health_t& slice) {
  if (slice.slice_count < 1 || slice.slice_count > kMaxSlices || slice.slice_index < 0 ||
      slice.slice_index >= slice.slice_count) {
    return std::nullopt;
  }
  const auto count = static_cast<std::size_t>(slice.slice_count);
  if (slice.session != session_ || slice.utime != utime_ || count != slices_.size()) {
    session_ = slice.session;
    utime_ = slice.utime;
    slices_.assign(count, std::nullopt);
  }
  slices_[static_cast<std::size_t>(slice.slice_index)] = slice;
  if (!std::all_of(slices_.begin(), slices_.end(), [](const auto& s) { return s.has_value(); })) {
    return std::nullopt;
  }
  DeputyHealth health{.deputy_id = slice.deputy_id,
                      .host = slice.host,
                      .version = slice.version,
                      .config_digest = slice.config_digest,
                      .sheriff_id = slice.sheriff_id,
                      .orders_age_us = slice.orders_age_us,
                      .text = slice.text,
                      .commands = {}};
  for (const auto& each : slices_) {
    for (const command_health_t& command : each->commands) {
      health.commands.push_back(FromLcm(command));
    }
  }
  return health;
}

}  // namespace clearway::messages
