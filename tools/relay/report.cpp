// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/report.hpp"

#include <nlohmann/json.hpp>

namespace clearway::relay {
namespace {

using nlohmann::ordered_json;

double PerSecond(double count, double interval_s) {
  return interval_s > 0.0 ? count / interval_s : 0.0;
}

double MbitPerSecond(std::uint64_t bytes, double interval_s) {
  return PerSecond(static_cast<double>(bytes) * 8e-6, interval_s);
}

ordered_json PortJson(const Hub::Port& port, std::uint64_t kernel_drops, double interval_s) {
  const ChannelTraffic& other = port.traffic.other();
  std::uint64_t interval_bytes = other.interval_bytes;
  for (const auto& [key, traffic] : port.traffic.channels()) {
    interval_bytes += traffic.interval_bytes;
  }
  return {{"name", port.name},
          {"is_cut", port.is_cut},
          {"in_frames", port.in_frames},
          {"in_bytes", port.in_bytes},
          {"in_mbit_per_s", MbitPerSecond(interval_bytes, interval_s)},
          {"in_other_frames", other.frames},
          {"in_other_bytes", other.bytes},
          {"out_frames", port.out_frames},
          {"out_bytes", port.out_bytes},
          {"refused_frames", port.refused},
          {"kernel_dropped_frames", kernel_drops}};
}

ordered_json DirectionJson(const Hub& hub, const Hub::Direction& direction) {
  const FaultSettings& settings = direction.faults.settings;
  return {{"from", hub.ports()[direction.from].name},
          {"to", hub.ports()[direction.to].name},
          {"loss", settings.loss},
          {"duplicate", settings.duplicate},
          {"delay_ms", static_cast<double>(settings.delay_ns) * 1e-6},
          {"jitter_ms", static_cast<double>(settings.jitter_ns) * 1e-6},
          {"delivered_frames", direction.delivered},
          {"lost_frames", direction.lost},
          {"cut_frames", direction.cut},
          {"duplicated_frames", direction.duplicated},
          {"overflowed_frames", direction.overflowed}};
}

ordered_json ChannelJson(const std::string& from,
                         const ChannelKey& key,
                         const ChannelTraffic& traffic,
                         double interval_s) {
  return {{"from", from},
          {"channel", key.channel},
          {"udp_port", key.udp_port},
          {"messages", traffic.messages},
          {"frames", traffic.frames},
          {"bytes", traffic.bytes},
          {"largest_message_bytes", traffic.largest_message_bytes},
          {"messages_per_s", PerSecond(static_cast<double>(traffic.interval_messages), interval_s)},
          {"mbit_per_s", MbitPerSecond(traffic.interval_bytes, interval_s)}};
}

}  // namespace

std::string FormatStatistics(const Hub& hub,
                             const std::vector<std::uint64_t>& kernel_drops,
                             double interval_s) {
  ordered_json ports = ordered_json::array();
  ordered_json channels = ordered_json::array();
  for (std::size_t i = 0; i < hub.ports().size(); ++i) {
    const Hub::Port& port = hub.ports()[i];
    ports.push_back(PortJson(port, kernel_drops.at(i), interval_s));
    for (const auto& [key, traffic] : port.traffic.channels()) {
      channels.push_back(ChannelJson(port.name, key, traffic, interval_s));
    }
  }
  ordered_json directions = ordered_json::array();
  for (const Hub::Direction& direction : hub.directions()) {
    directions.push_back(DirectionJson(hub, direction));
  }
  const ordered_json report = {{"interval_s", interval_s},
                               {"ports", ports},
                               {"directions", directions},
                               {"channels", channels},
                               {"delayed_frames", hub.delayed().num_packets()},
                               {"delayed_bytes", hub.delayed().num_bytes()}};
  // Channel names are whatever someone sent.
  return report.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace clearway::relay
