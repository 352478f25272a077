// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/bus_facts.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <random>
#include <string>
#include <unistd.h>

#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "common/process/bus_tap.hpp"

namespace clearway::doctor {
namespace {

namespace channels = messages::channels;
using Clock = std::chrono::steady_clock;

constexpr char kOwnChannel[] = "CLEARWAY_DOCTOR";
constexpr std::int64_t kTurnUs = 20'000;

// What only this life of this program sends.
std::vector<std::byte> MakeMark() {
  std::random_device random;
  std::vector<std::byte> mark;
  for (int i = 0; i < 16; ++i) mark.push_back(static_cast<std::byte>(random()));
  return mark;
}

std::vector<std::byte> DiscoveryMessage() {
  procman_lcm::discovery_t message;
  message.utime = std::chrono::duration_cast<std::chrono::microseconds>(
                      std::chrono::system_clock::now().time_since_epoch())
                      .count();
  // No deputy's id: one that starts with the same id would end.
  message.transmitter_id = "clearway-doctor:" + std::to_string(getpid());
  message.nonce = 0;
  return messages::Encode(message);
}

}  // namespace

BusFacts ListenTo(const std::vector<Bus>& buses, std::int64_t listen_us) {
  BusFacts facts;
  facts.loop_backs.resize(buses.size());
  Listener listener;
  const std::vector<std::byte> mark = MakeMark();
  std::vector<std::unique_ptr<process::BusTap>> taps;
  for (std::size_t i = 0; i < buses.size(); ++i) {
    LoopBack& loop_back = facts.loop_backs[i];
    try {
      taps.push_back(std::make_unique<process::BusTap>(
          buses[i].config,
          [&loop_back, &listener, &mark](const std::string& channel,
                                         std::span<const std::byte> bytes) {
            if (channel == kOwnChannel) {
              const bool is_own = std::equal(bytes.begin(), bytes.end(), mark.begin(), mark.end());
              loop_back.was_heard = loop_back.was_heard || is_own;
            } else if (channel != channels::kPmDiscover.name) {
              listener.OnMessage(channel, bytes);
            }
          }));
      taps.back()->Publish(kOwnChannel, mark);
      taps.back()->Publish(channels::kPmDiscover.name, DiscoveryMessage());
    } catch (const std::exception& error) {
      loop_back.problem = error.what();
    }
  }
  const auto end = Clock::now() + std::chrono::microseconds(listen_us);
  while (!taps.empty() && Clock::now() < end) {
    for (const auto& tap : taps) tap->HandleWaiting(kTurnUs);
  }
  facts.heard = listener.Result();
  return facts;
}

}  // namespace clearway::doctor
