// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/endpoint.hpp"
#include "common/core/livox/commands.hpp"
#include "common/core/livox/control_frame.hpp"
#include "common/core/livox/data_packet.hpp"
#include "common/core/livox/device_status.hpp"
#include "common/core/livox/driver_config.hpp"

namespace clearway::core {

/// What an emulated MID-70 is and how quick it is.
struct EmulatedMid70Config {
  std::string broadcast_code = "3GGDJ6K00100101";
  Endpoint announce_to{kBroadcastIpv4, livox::kBroadcastPort};
  std::array<std::uint8_t, 4> firmware{10, 3, 0, 1};
  std::int64_t broadcast_period_us = 1'000'000;
  std::int64_t boot_us = 200'000;            ///< From power on to the first broadcast.
  std::int64_t start_up_us = 1'000'000;      ///< From power on, or standby, until it measures.
  std::int64_t host_timeout_us = 5'000'000;  ///< Without a heartbeat: the host is gone.
  bool lets_others_take_over = true;         ///< A handshake of a second host is accepted.
};

/// What it keeps without power.
struct EmulatedMid70Memory {
  Ipv4 ip = kAnyIpv4;  ///< From the next start on.
  Ipv4 mask = 0xFFFFFF00;
  Ipv4 gateway = kAnyIpv4;
  bool has_static_ip = true;
  livox::ReturnMode return_mode = livox::ReturnMode::kFirst;
  livox::Extrinsic extrinsic = {};
  std::uint8_t slot = 1;  ///< Parameter 3, 1 to 9.
};

/// What it has heard and made of it.
struct EmulatedMid70Counts {
  std::array<std::int64_t, livox::kNumFrameDefects> broken{};  ///< Datagrams, by FrameDefect.
  std::int64_t foreign = 0;     ///< Commands of hosts that are not connected; no answer.
  std::int64_t unasked = 0;     ///< Frames that are no commands; no answer.
  std::int64_t refused = 0;     ///< Commands that were answered with a failure.
  std::int64_t done = 0;        ///< Commands that were answered with success.
  std::int64_t handshakes = 0;  ///< Of `done`.
  std::int64_t takeovers = 0;   ///< Handshakes that took it from another host.
  std::int64_t host_timeouts = 0;
  std::int64_t starts = 0;  ///< Power on and reboots.
};

/// The control side of a MID-70 without a network: what it says and does, in a time that is an
/// argument [us] and never goes back. It announces itself until a host shakes hands, obeys that
/// host, and announces itself again when the host says goodbye or is not heard for a while.
///
/// What is not known of real ones, and what is done here:
/// - Answers go to the address that a handshake came from and the command port that it states;
///   points to the address and data port that it states. A handshake that states no address or
///   port is refused.
/// - Commands of others than the connected host are not answered, also before any handshake.
/// - The connected host is known by its address: commands come from any of its ports.
/// - A second host's handshake takes the sensor over, or is refused (lets_others_take_over).
/// - Each handshake begins anew: sampling is off. So does the end of a connection.
/// - Sampling may be asked for while it starts up or sleeps; points come as soon as it measures.
/// - From power saving and standby it starts up as from power on, with progress.
/// - A part with an error other than the window makes it report the state Error; no points then.
/// - An address that is set holds from the next start on, a reboot's delay is in milliseconds.
/// - Results that are not 0 are 1; error codes of parameters, too.
/// - Return mode, extrinsic, address and slot outlive the power; coordinates and mode do not.
/// Source: the vendor's SDK 2.3.0 as a peer, its wiki for the commands' bodies.
class EmulatedMid70 {
 public:
  /// One frame from its port livox::kDevicePort.
  struct Outgoing {
    Endpoint to;
    livox::Bytes bytes;
    livox::CommandCode code = livox::CommandCode::kBroadcast;
  };

  /// Where points go, and how they look.
  struct Sampling {
    Endpoint to;
    livox::DataType data_type = livox::DataType::kExtendedCartesian;
    friend bool operator==(const Sampling&, const Sampling&) = default;
  };

  /// Switched on at `now_us`.
  EmulatedMid70(const EmulatedMid70Config& config,
                const EmulatedMid70Memory& memory,
                std::int64_t now_us);

  /// Takes a datagram that came to its command port; gives the answer, if there is one.
  [[nodiscard]] std::vector<Outgoing> Receive(const Endpoint& from,
                                              livox::ByteView datagram,
                                              std::int64_t now_us);

  /// Does what is due: broadcasts, messages of an abnormal status, a lost host, a reboot.
  [[nodiscard]] std::vector<Outgoing> Advance(std::int64_t now_us);

  /// Off and on again: what it keeps, it keeps.
  void PowerCycle(std::int64_t now_us);

  /// Its address is another one at once; the connection is lost.
  void ChangeAddress(Ipv4 ip, std::int64_t now_us);

  /// What it finds wrong with itself from now on.
  void SetStatus(const livox::DeviceStatus& status) { status_ = status; }

  /// Nothing while it sends no points.
  [[nodiscard]] std::optional<Sampling> sampling(std::int64_t now_us) const;

  [[nodiscard]] livox::WorkState StateAt(std::int64_t now_us) const;
  [[nodiscard]] std::uint32_t status_code() const { return livox::EncodeStatus(status_); }
  /// The connected host's command port; nothing while it is not connected.
  [[nodiscard]] std::optional<Endpoint> host() const;
  [[nodiscard]] Ipv4 ip() const { return ip_; }
  [[nodiscard]] const EmulatedMid70Memory& memory() const { return memory_; }
  [[nodiscard]] const EmulatedMid70Counts& counts() const { return counts_; }
  /// When it started last.
  [[nodiscard]] std::int64_t started_us() const { return started_us_; }
  /// The UTC time that a host told, and when; nothing until then.
  struct UtcTime {
    std::int64_t utc_ns = 0;
    std::int64_t told_us = 0;
  };
  [[nodiscard]] const std::optional<UtcTime>& utc() const { return utc_; }

 private:
  struct Connection {
    Endpoint commands;  // Of the host.
    Endpoint data;
    std::int64_t heard_us = 0;
    bool is_sampling = false;
  };

  [[nodiscard]] livox::Bytes Answer(const livox::ControlFrame& frame, std::int64_t now_us);
  [[nodiscard]] livox::Bytes AnswerGeneral(const livox::ControlFrame& frame, std::int64_t now_us);
  [[nodiscard]] livox::Bytes AnswerLidar(const livox::ControlFrame& frame, std::int64_t now_us);
  [[nodiscard]] std::vector<Outgoing> Greet(const Endpoint& from,
                                            const livox::ControlFrame& frame,
                                            std::int64_t now_us);
  [[nodiscard]] bool Shake(const Endpoint& from,
                           const livox::Handshake& handshake,
                           std::int64_t now_us);
  [[nodiscard]] livox::Bytes AnswerHeartbeat(std::int64_t now_us);
  [[nodiscard]] livox::Bytes AnswerGetIp() const;
  [[nodiscard]] bool SetIp(livox::ByteView data);
  [[nodiscard]] bool SetSampling(livox::ByteView data);
  [[nodiscard]] bool SetMode(livox::ByteView data, std::int64_t now_us);
  [[nodiscard]] bool SetUtc(livox::ByteView data, std::int64_t now_us);
  [[nodiscard]] livox::Bytes SetParameter(livox::ByteView data);
  [[nodiscard]] livox::Bytes GetParameters(livox::ByteView data) const;
  [[nodiscard]] livox::Bytes ResetParameters(livox::ByteView data);
  [[nodiscard]] Outgoing Message(const Endpoint& to, livox::CommandCode code, livox::ByteView body);
  void Disconnect(std::int64_t now_us);
  [[nodiscard]] bool HasError() const;

  EmulatedMid70Config config_;
  EmulatedMid70Memory memory_;
  EmulatedMid70Counts counts_;
  livox::DeviceStatus status_;
  Ipv4 ip_ = kAnyIpv4;
  std::int64_t started_us_ = 0;
  std::int64_t measures_from_us_ = 0;
  livox::WorkState mode_ = livox::WorkState::kNormal;
  livox::Coordinates coordinates_ = livox::Coordinates::kCartesian;
  std::optional<Connection> connection_;
  std::optional<std::int64_t> reboot_us_;
  std::int64_t next_broadcast_us_ = 0;
  std::int64_t next_abnormal_us_ = 0;
  std::uint16_t sequence_ = 0;  // Of what it sends unasked.
  std::optional<UtcTime> utc_;
};

}  // namespace clearway::core
