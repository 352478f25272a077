// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/graph_listener.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "common/messages/encoding.hpp"

namespace clearway::test {
namespace {

namespace channels = messages::channels;

constexpr std::int64_t kStep_us = 10'000;

template <typename Message>
void Keep(const lcm::ReceiveBuffer& buffer, std::vector<Arrived<Message>>& kept) {
  auto message = messages::Decode<Message>(
      {static_cast<const std::byte*>(buffer.data), std::size_t{buffer.data_size}});
  if (message) kept.push_back({buffer.recv_utime, *std::move(message)});
}

}  // namespace

GraphListener::GraphListener(const std::string& url) : lcm_(url + "?ttl=0&recv_buf_size=4194304") {
  if (!lcm_.good()) throw std::runtime_error("cannot open LCM at " + url);
  lcm_.subscribe(".*", &GraphListener::OnMessage, this)->setQueueCapacity(0);
}

std::int64_t GraphListener::NowUs() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

bool GraphListener::Await(const std::function<bool()>& done, std::int64_t timeout_us) {
  const std::int64_t deadline_us = NowUs() + timeout_us;
  while (!done()) {
    const std::int64_t left_us = deadline_us - NowUs();
    if (left_us <= 0) return false;
    lcm_.handleTimeout(static_cast<int>(std::min(left_us, kStep_us) / 1000 + 1));
  }
  return true;
}

void GraphListener::OnMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
  if (channel == "LCM_SELF_TEST") return;
  ++num_messages;
  if (channel == channels::kLidarPoints.name) {
    Keep(*buffer, slices);
    lidar_points_t& slice = slices.back().message;
    for (auto* values : {&slice.x, &slice.y, &slice.z}) values->clear();
  } else if (channel == channels::kDetections.name) {
    Keep(*buffer, detections);
  } else if (channel == channels::kDrivePermit.name) {
    Keep(*buffer, permits);
  } else if (channel.ends_with("_STATUS")) {
    std::vector<Arrived<status_t>> status;
    Keep(*buffer, status);
    for (auto& each : status) statuses[each.message.process] = std::move(each);
  }
}

}  // namespace clearway::test
