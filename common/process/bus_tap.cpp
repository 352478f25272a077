// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/bus_tap.hpp"

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include <lcm/lcm.h>

#include "common/process/lcm_connection.hpp"

namespace clearway::process {
namespace {

// LCM's own, at each start of a receiver.
constexpr std::string_view kSelfTestChannel = "LCM_SELF_TEST";

// Of one call, so that a flood does not keep the caller from looking at the time.
constexpr int kMessagesInARow = 1000;

}  // namespace

BusTap::BusTap(const BusConfig& config, Handler handler)
    : handler_(std::move(handler)), lcm_(lcm_create(FullUrl(config).c_str())) {
  if (lcm_ == nullptr) throw std::runtime_error("cannot open LCM at " + FullUrl(config));
  lcm_subscription_t* const all = lcm_subscribe(lcm_, ".*", &BusTap::OnMessage, this);
  if (all == nullptr) {
    lcm_destroy(lcm_);
    throw std::runtime_error("cannot receive from LCM at " + FullUrl(config));
  }
  lcm_subscription_set_queue_capacity(all, 0);  // Unlimited: it is drained soon.
}

BusTap::~BusTap() {
  lcm_destroy(lcm_);
}

bool BusTap::Publish(const std::string& channel, std::span<const std::byte> bytes) {
  return lcm_publish(lcm_, channel.c_str(), bytes.data(), static_cast<unsigned>(bytes.size())) == 0;
}

bool BusTap::HandleWaiting(std::int64_t timeout_us) {
  const int timeout_ms =
      static_cast<int>(std::clamp<std::int64_t>(timeout_us, 0, 1'000'000) / 1000);
  if (lcm_handle_timeout(lcm_, timeout_ms) <= 0) return false;
  for (int n = 1; n < kMessagesInARow && lcm_handle_timeout(lcm_, 0) > 0; ++n) {
  }
  return true;
}

void BusTap::OnMessage(const lcm_recv_buf_t* buffer, const char* channel, void* user) {
  if (channel == kSelfTestChannel) return;
  static_cast<BusTap*>(user)->handler_(
      channel, {static_cast<const std::byte*>(buffer->data), std::size_t{buffer->data_size}});
}

}  // namespace clearway::process
