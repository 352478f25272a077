// SPDX-License-Identifier: BSD-3-Clause
// What a deputy says of itself: PM_INFO and PM_HEALTH.
#include <algorithm>

#include "common/messages/channels.hpp"
#include "common/messages/procman.hpp"
#include "common/process/plain_channels.hpp"
#include "processes/procman_deputy/deputy_process.hpp"

namespace clearway {
namespace {

namespace channels = messages::channels;

constexpr std::size_t kRememberedInfos = 32;
constexpr std::int64_t kRivalHeardUs = 3'000'000;

}  // namespace

core::procman::DeputyReport DeputyProcess::Report() const {
  core::procman::DeputyReport report{.utime = last_utime_,
                                     .deputy_id = settings_.id,
                                     .cpu_load = host_use_.cpu_load,
                                     .phys_mem_total_bytes = host_use_.memory_total_bytes,
                                     .phys_mem_free_bytes = host_use_.memory_free_bytes,
                                     .swap_total_bytes = host_use_.swap_total_bytes,
                                     .swap_free_bytes = host_use_.swap_free_bytes,
                                     .commands = deputy_.Reports()};
  for (core::procman::CommandReport& command : report.commands) {
    const Machine::Use use = machine_.UseOf(command.pid);
    command.cpu_usage = use.cpu_usage;
    command.mem_vsize_bytes = use.vsize_bytes;
    command.mem_rss_bytes = use.rss_bytes;
  }
  return report;
}

core::procman::DeputyHealth DeputyProcess::Health() const {
  const std::int64_t now_us = runtime_.MonotonicUs();
  core::procman::DeputyHealth health{.deputy_id = settings_.id,
                                     .host = runtime_.HostName(),
                                     .version = settings_.version,
                                     .config_digest = config_digest_,
                                     .sheriff_id = deputy_.ledger().current(),
                                     .orders_age_us = deputy_.ledger().AgeUs(now_us),
                                     .text = trouble_,
                                     .commands = deputy_.Health(now_us)};
  const auto add = [&health](const std::string& text) {
    if (!text.empty()) health.text += (health.text.empty() ? "" : "; ") + text;
  };
  add(kept_orders_.problem());
  add(logs_.Problem());
  const std::string rival = deputy_.ledger().Rival(now_us);
  if (!rival.empty()) {
    add("two sheriffs command this deputy: " + deputy_.ledger().current() + " and " + rival);
  }
  if (rival_heard_us_ >= 0 && now_us - rival_heard_us_ < kRivalHeardUs) {
    add("another deputy has the same id");
  }
  for (core::procman::CommandHealthReport& command : health.commands) {
    command.dropped_output_bytes = output_.DroppedBytes(command.id);
  }
  return health;
}

void DeputyProcess::PublishState() {
  // Grows, so that nobody takes an old state for a new one when this host's clock steps back.
  last_utime_ = std::max(last_utime_ + 1, runtime_.UtimeNow());
  sent_utimes_.push_back(last_utime_);
  if (sent_utimes_.size() > kRememberedInfos) sent_utimes_.pop_front();
  process::Publish(runtime_, channels::kPmInfo, messages::ToLcm(Report()));
  for (deputy_health_t& slice :
       messages::ToLcm(Health(), last_utime_, runtime_.MaxMessageBytes(channels::kPmHealth.bus))) {
    slice.session = session_;
    slice.sequence = health_sequence_++;
    process::Publish(runtime_, channels::kPmHealth, slice);
  }
}

}  // namespace clearway
