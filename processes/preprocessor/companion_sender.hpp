// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/process/node.hpp"

namespace clearway {

/// Sends what accompanies a scan (LOCAL_MAP, REMOVED_POINTS) in the pauses that its obstacle points
/// leave, so that nothing of it ever delays an obstacle. Slices go one by one, each the bus's burst
/// interval after the one before. A burst that has begun is finished; when more than a few of a
/// channel wait, the oldest is given up and counted as dropped.
class CompanionSender {
 public:
  explicit CompanionSender(process::Node& node) : node_(node) {}
  CompanionSender(const CompanionSender&) = delete;
  CompanionSender& operator=(const CompanionSender&) = delete;

  /// A burst of `num_slices` obstacle points has been given to the node just now.
  void NoteObstacles(std::size_t num_slices, std::int64_t interval_us);

  /// How long obstacle points will still be under way [us], as far as can be told.
  [[nodiscard]] std::int64_t BacklogUs() const {
    return std::max<std::int64_t>(0, obstacles_until_us_ - node_.runtime().MonotonicUs());
  }

  template <typename Message>
  void Send(const messages::Channel<Message>& channel, std::vector<Message> slices) {
    Burst burst{channel.name, node_.runtime().BurstIntervalUs(channel.bus), {}};
    for (Message& slice : slices) {
      burst.slices.push_back(
          [this, channel, message = std::make_shared<Message>(std::move(slice))] {
            node_.Publish(channel, std::move(*message));
          });
    }
    Enqueue(std::move(burst));
  }

 private:
  struct Burst {
    std::string channel;
    std::int64_t interval_us;
    std::deque<std::function<void()>> slices;
  };

  void Enqueue(Burst burst);
  void SendNext();
  void SendNextIn(std::int64_t delay_us);

  process::Node& node_;
  std::deque<Burst> bursts_;  // Only the first may have begun.
  bool has_begun_ = false;
  bool is_scheduled_ = false;
  std::int64_t obstacles_until_us_ = 0;  // Until then the node sends obstacle points.
};

}  // namespace clearway
