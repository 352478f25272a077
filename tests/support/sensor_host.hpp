// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/core/livox/commands.hpp"
#include "common/core/livox/data_packet.hpp"
#include "common/net/datagrams.hpp"

namespace clearway::test {

/// A host that talks to one sensor as little as it must: answers each broadcast with a handshake,
/// starts sampling, and sends heartbeats when told to. Keeps what it hears.
class SensorHost {
 public:
  static constexpr std::uint16_t kCommandPort = 55501;
  static constexpr std::uint16_t kDataPort = 56001;

  /// What a data packet said, and when it came.
  struct Packet {
    core::livox::DataHeader header;
    core::livox::Bytes bytes;
    std::int64_t arrival_utime = 0;
    core::Endpoint from;
  };
  struct Heard {
    core::livox::CommandCode code = core::livox::CommandCode::kBroadcast;
    core::livox::Bytes body;
    core::Endpoint from;
    std::int64_t arrival_utime = 0;
  };

  SensorHost(net::Network& network, core::Ipv4 ip) : ip_(ip) {
    broadcasts_ = network.Open({.bind = {core::kAnyIpv4, core::livox::kBroadcastPort}},
                               [this](auto datagrams) { OnFrames(datagrams); });
    commands_ =
        network.Open({.bind = {ip, kCommandPort}}, [this](auto datagrams) { OnFrames(datagrams); });
    data_ = network.Open({.bind = {ip, kDataPort}}, [this](auto datagrams) { OnData(datagrams); });
  }

  void Send(core::livox::CommandCode code, const core::livox::Bytes& body = {}) {
    using core::livox::FrameType;
    if (!sensor) return;
    commands_->Send(*sensor,
                    core::livox::PackCommand(FrameType::kCommand, ++sequence_, code, body));
  }
  void Shake() {
    Send(core::livox::CommandCode::kHandshake,
         core::livox::PackBody(core::livox::Handshake{
             .host_ip = ip_, .data_port = kDataPort, .command_port = kCommandPort, .imu_port = 0}));
  }

  core::livox::ReturnMode return_mode = core::livox::ReturnMode::kFirst;
  bool answers_broadcasts = true;
  std::optional<core::Endpoint> sensor;  ///< Where the newest broadcast came from.
  std::vector<Heard> heard;              ///< All control frames.
  std::vector<Packet> packets;           ///< All data packets.

  [[nodiscard]] int CountOf(core::livox::CommandCode code) const {
    int count = 0;
    for (const Heard& one : heard) count += one.code == code ? 1 : 0;
    return count;
  }

 private:
  void OnFrames(std::span<const net::Datagram> datagrams) {
    using core::livox::CommandCode;
    for (const net::Datagram& datagram : datagrams) {
      const auto parsed = core::livox::ParseFrame(datagram.bytes);
      if (!parsed.frame) continue;
      const CommandCode code = core::livox::CodeOf(*parsed.frame);
      const auto data = parsed.frame->data;
      heard.push_back({code, {data.begin(), data.end()}, datagram.from, datagram.arrival_utime});
      if (code == CommandCode::kBroadcast) {
        sensor = datagram.from;
        if (answers_broadcasts) Shake();
      } else if (code == CommandCode::kHandshake && data[0] == std::byte{0}) {
        Send(CommandCode::kSetReturnMode,
             core::livox::PackByte(static_cast<std::uint8_t>(return_mode)));
        Send(CommandCode::kSampling, core::livox::PackByte(1));
      }
    }
  }
  void OnData(std::span<const net::Datagram> datagrams) {
    for (const net::Datagram& datagram : datagrams) {
      const auto parsed = core::livox::ParsePacket(datagram.bytes);
      if (!parsed.packet) continue;
      packets.push_back({parsed.packet->header,
                         {datagram.bytes.begin(), datagram.bytes.end()},
                         datagram.arrival_utime,
                         datagram.from});
    }
  }

  core::Ipv4 ip_;
  std::uint16_t sequence_ = 0;
  std::unique_ptr<net::Socket> broadcasts_;
  std::unique_ptr<net::Socket> commands_;
  std::unique_ptr<net::Socket> data_;
};

}  // namespace clearway::test
