// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a message of any type of the graph: refused, or decoded, converted and judged.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "common/core/geometry/pose_buffer.hpp"
#include "common/core/mapping/map_builder.hpp"
#include "common/core/procman/deputy.hpp"
#include "common/core/procman/sheriff.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "common/messages/lidar_points.hpp"
#include "common/messages/map_tiles.hpp"
#include "common/messages/obstacle_points.hpp"
#include "common/messages/odometry.hpp"
#include "common/messages/pose.hpp"
#include "common/messages/procman.hpp"

namespace clearway {
namespace {

void Require(bool holds) {
  if (!holds) std::abort();
}

// What every array must hold for the core to take a slice.
void RequireEqualArrays(const core::PointCloud& cloud) {
  const std::size_t points = cloud.size();
  Require(cloud.y.size() == points && cloud.z.size() == points);
  Require(cloud.intensity.size() == points && cloud.tag.size() == points);
  Require(cloud.time_offset_us.size() == points);
}

// Starts everything, and nothing ever ends.
class NoCommands : public core::procman::CommandHost {
 public:
  core::procman::StartOutcome Start(const core::procman::CommandSpec& spec) override {
    core::procman::StartOutcome outcome;
    if (spec.exec.size() % 2 == 0) outcome.pid = ++last_pid_;
    return outcome;
  }
  void Signal(std::int32_t, int) override {}
  void Note(const std::string&, const std::string&) override {}

 private:
  std::int32_t last_pid_ = 0;
};

template <typename Message>
void Use(const Message&) {}

void Use(const lidar_points_t& message) {
  const core::Slice slice = messages::FromLcm(message, 0);
  if (!core::IsValid(slice)) return;
  RequireEqualArrays(slice.cloud_sensor);
  const core::Slice again = messages::FromLcm(messages::ToLcm(slice, message.sensor), 0);
  Require(again.shots == slice.shots && again.zero_returns == slice.zero_returns);
}

void Use(const obstacle_points_t& message) {
  RequireEqualArrays(messages::FromLcm(message).cloud_sensor);
}

void Use(const odometry_t& message) {
  core::PoseBuffer buffer;
  if (buffer.Add(message.utime, messages::T_odom_vehicle(message)) ==
      core::PoseBuffer::Outcome::kAdded) {
    Require(buffer.Lookup(message.utime).has_value());
  }
}

void Use(const pose_t& message) {
  core::PoseBuffer buffer;
  buffer.Add(message.utime, messages::T_map_vehicle(message));
}

void Use(const map_tile_t& message) {
  const auto tile = messages::FromLcm(message);
  if (!tile) return;
  map_tile_t copy = messages::ToLcm(*tile);
  copy.session = message.session;
  const auto again = messages::FromLcm(copy);
  Require(again && again->cells == tile->cells && again->geometry == tile->geometry);
  // A layer is allocated as a whole: keep the fuzzer within its memory.
  if (tile->geometry.num_cells() > 1'000'000) return;
  core::MapAssembler assembler;
  assembler.Add(*tile);
  assembler.Add(*tile);
  Require(assembler.received() <= assembler.count());
}

void Use(const local_map_t& message) {
  const auto grid = messages::FromLcm(message);
  if (!grid || grid->cells.empty()) return;
  core::MapBuilder builder;
  if (builder.Add(*grid) == core::MapBuilder::Outcome::kAdded && builder.has_cells()) {
    Require(builder.Build({}).geometry.IsValid());
  }
}

void Use(const procman_lcm::orders_t& message) {
  const core::procman::Orders orders = messages::FromLcm(message);
  Require(messages::FromLcm(messages::ToLcm(orders)).commands.size() == orders.commands.size());
  NoCommands host;
  core::procman::Deputy deputy(orders.deputy_id, {}, {}, host);
  deputy.Take(orders, 0);
  deputy.Tick(1'000'000'000);
  (void)deputy.Health(1'000'000'000);
}

void Use(const procman_lcm::deputy_info_t& message) {
  core::procman::Sheriff sheriff("s", core::procman::Sheriff::Mode::kCommand);
  sheriff.OnReport(messages::FromLcm(message), 0);
  (void)sheriff.Look(5'000'000);
  (void)sheriff.OrdersDue(5'000'000, 1);
}

void Use(const deputy_health_t& message) {
  messages::HealthAssembler assembler;
  const auto health = assembler.Add(message);
  if (!health) return;
  core::procman::Sheriff sheriff("s", core::procman::Sheriff::Mode::kObserve);
  sheriff.OnHealth(*health, message.utime, 0);
  (void)sheriff.Look(5'000'000);
}

// A decoded message can travel again, and is no longer then (its strings end at a NUL).
template <typename Message>
void Take(std::span<const std::byte> bytes) {
  const auto message = messages::Decode<Message>(bytes);
  if (!message) return;
  Use(*message);
  const auto again = messages::Encode(*message);
  Require(again.size() <= bytes.size());
  Require(messages::Decode<Message>(again).has_value());
}

using Taker = void (*)(std::span<const std::byte>);
constexpr std::array<Taker, 23> kTypes = {Take<lidar_points_t>,
                                          Take<odometry_t>,
                                          Take<removed_points_t>,
                                          Take<drive_permit_t>,
                                          Take<drive_request_t>,
                                          Take<drive_command_t>,
                                          Take<estop_t>,
                                          Take<estop_ack_t>,
                                          Take<truth_t>,
                                          Take<pose_t>,
                                          Take<pose_status_t>,
                                          Take<obstacle_points_t>,
                                          Take<floor_t>,
                                          Take<detections_t>,
                                          Take<map_request_t>,
                                          Take<map_tile_t>,
                                          Take<local_map_t>,
                                          Take<status_t>,
                                          Take<procman_lcm::deputy_info_t>,
                                          Take<procman_lcm::orders_t>,
                                          Take<procman_lcm::output_t>,
                                          Take<procman_lcm::discovery_t>,
                                          Take<deputy_health_t>};

}  // namespace
}  // namespace clearway

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto bytes = std::as_bytes(std::span(data, size)).subspan(1);
  clearway::kTypes[data[0] % clearway::kTypes.size()](bytes);
  return 0;
}
