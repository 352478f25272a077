// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/sheriff_process.hpp"

#include <algorithm>
#include <utility>

#include "common/process/plain_channels.hpp"

namespace clearway {
namespace {

namespace channels = messages::channels;

constexpr std::int64_t kTickUs = 50'000;
// Ids come from outside.
constexpr std::size_t kMaxDeputies = 1000;

std::string NewSheriffId(process::Runtime& runtime) {
  return runtime.HostName() + ":" + std::to_string(runtime.ProcessId()) + ":" +
         std::to_string(runtime.UtimeNow());
}

}  // namespace

SheriffProcess::SheriffProcess(process::Runtime& runtime, const Settings& settings)
    : runtime_(runtime),
      sheriff_(NewSheriffId(runtime), settings.mode, settings.scope),
      runner_(sheriff_) {
  Listen(settings);
  timer_ = runtime_.Every(kTickUs, [this] { Update(); });
  if (settings.discovers) Discover();
}

SheriffProcess::~SheriffProcess() {
  runtime_.Cancel(timer_);
}

void SheriffProcess::Listen(const Settings& settings) {
  const auto on_invalid = [this] { ++invalid_; };
  process::Subscribe<procman_lcm::deputy_info_t>(
      runtime_,
      channels::kPmInfo,
      [this](const procman_lcm::deputy_info_t& message) {
        sheriff_.OnReport(messages::FromLcm(message), runtime_.MonotonicUs());
        Update();
      },
      on_invalid);
  process::Subscribe<deputy_health_t>(
      runtime_,
      channels::kPmHealth,
      [this](const deputy_health_t& message) {
        const bool is_known = assemblers_.contains(message.deputy_id);
        if (!is_known && assemblers_.size() >= kMaxDeputies) return;
        const auto health = assemblers_[message.deputy_id].Add(message);
        if (!health) return;
        sheriff_.OnHealth(*health, message.utime, runtime_.MonotonicUs());
        Update();
      },
      on_invalid);
  process::Subscribe<procman_lcm::orders_t>(
      runtime_,
      channels::kPmOrders,
      [this](const procman_lcm::orders_t& message) {
        if (message.sheriff_id == sheriff_.id()) return;
        sheriff_.OnForeignOrders(messages::FromLcm(message), runtime_.MonotonicUs());
        Update();
      },
      on_invalid);
  if (!settings.takes_output) return;
  process::Subscribe<procman_lcm::output_t>(
      runtime_,
      channels::kPmOutput,
      [this](const procman_lcm::output_t& message) {
        if (!on_output_) return;
        for (std::size_t i = 0; i < message.command_ids.size(); ++i) {
          on_output_({.utime = message.utime,
                      .deputy = message.deputy_id,
                      .command = message.command_ids[i],
                      .text = message.text[i]});
        }
      },
      on_invalid);
}

void SheriffProcess::Update() {
  // A handler that acts on what it is told calls this again: once more round then.
  is_update_due_ = true;
  if (std::exchange(is_updating_, true)) return;
  while (std::exchange(is_update_due_, false)) {
    const std::int64_t now_us = runtime_.MonotonicUs();
    runner_.Tick(now_us);
    for (const core::procman::Orders& orders : sheriff_.OrdersDue(now_us, runtime_.UtimeNow())) {
      process::Publish(runtime_, channels::kPmOrders, messages::ToLcm(orders));
    }
    sheriff_.Tick(now_us);
    HandOnChanges();
    if (on_update_) on_update_();
  }
  is_updating_ = false;
}

void SheriffProcess::HandOnChanges() {
  // By number: a handler may make more of them.
  while (!sheriff_.history().empty() && sheriff_.history().back().sequence >= next_change_) {
    const std::int64_t first = sheriff_.history().front().sequence;
    next_change_ = std::max(next_change_, first);
    const auto index = static_cast<std::size_t>(next_change_ - first);
    const core::procman::Change change = sheriff_.history()[index];
    ++next_change_;
    if (on_change_) on_change_(change);
  }
}

void SheriffProcess::Discover() {
  procman_lcm::discovery_t message{};
  message.utime = runtime_.UtimeNow();
  message.transmitter_id = sheriff_.id();
  message.nonce = 0;
  process::Publish(runtime_, channels::kPmDiscover, message);
}

void SheriffProcess::OnChange(std::function<void(const core::procman::Change&)> handler) {
  on_change_ = std::move(handler);
}

void SheriffProcess::OnOutput(std::function<void(const CommandOutput&)> handler) {
  on_output_ = std::move(handler);
}

void SheriffProcess::OnUpdate(std::function<void()> handler) {
  on_update_ = std::move(handler);
}

}  // namespace clearway
