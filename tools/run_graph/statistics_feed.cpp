// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "tools/run_graph/run_statistics.hpp"

namespace clearway::run_graph {
namespace {

namespace channels = messages::channels;

// True when the message is of this channel, whether or not it can be decoded.
template <typename Message, typename Take>
bool TakeIfOn(const messages::Channel<Message>& channel,
              const std::string& name,
              std::span<const std::byte> bytes,
              const Take& take) {
  if (name != channel.name) return false;
  if (const auto message = messages::Decode<Message>(bytes)) take(*message);
  return true;
}

}  // namespace

void RunStatistics::OnMessage(const std::string& channel,
                              std::span<const std::byte> bytes,
                              std::int64_t arrival_us) {
  if (channel.ends_with("_STATUS") && channel != channels::kPoseStatus.name) {
    if (const auto status = messages::Decode<status_t>(bytes)) OnStatus(*status);
    return;
  }
  const auto on = [&](const auto& kind, const auto& take) {
    return TakeIfOn(kind, channel, bytes, take);
  };
  on(channels::kLidarPoints, [&](const auto& m) { OnLidarPoints(m, arrival_us); }) ||
      on(channels::kObstaclePoints, [&](const auto& m) { OnObstaclePoints(m); }) ||
      on(channels::kRemovedPoints, [&](const auto& m) { OnRemovedPoints(m); }) ||
      on(channels::kFloor, [&](const auto& m) { OnFloor(m); }) ||
      on(channels::kPose, [&](const auto& m) { OnPose(m); }) ||
      on(channels::kMap, [&](const auto& m) { OnMap(m); }) ||
      on(channels::kDetections, [&](const auto& m) { OnDetections(m, arrival_us); }) ||
      on(channels::kDrivePermit, [&](const auto& m) { OnDrivePermit(m, arrival_us); });
}

}  // namespace clearway::run_graph
