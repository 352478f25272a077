// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/relay/command.hpp"
#include "tools/relay/delay_line.hpp"
#include "tools/relay/faults.hpp"
#include "tools/relay/traffic.hpp"

namespace clearway::relay {

/// Every frame that comes in by one port goes out by all others, with the faults that are set.
/// Neither sockets nor a clock: packets and times come in, packets go out by a function.
class Hub {
 public:
  struct Settings {
    std::uint64_t seed = 1;
    std::size_t max_delayed_bytes = std::size_t{64} << 20U;
    /// A packet is this many bytes of the socket's own, passed on as they are, and then the frame.
    std::size_t packet_header_bytes = 0;
  };
  struct Port {
    std::string name;
    bool is_cut = false;
    std::uint64_t in_frames = 0;
    std::uint64_t in_bytes = 0;
    std::uint64_t out_frames = 0;
    std::uint64_t out_bytes = 0;
    std::uint64_t refused = 0;  ///< Frames that the socket did not take.
    TrafficMeter traffic;       ///< Of what comes in.
  };
  struct Direction {
    std::size_t from = 0;
    std::size_t to = 0;
    Faults faults;
    std::uint64_t delivered = 0;  ///< Frames, duplicates among them.
    std::uint64_t lost = 0;       ///< By loss.
    std::uint64_t cut = 0;        ///< Since a port is cut.
    std::uint64_t duplicated = 0;
    std::uint64_t overflowed = 0;  ///< The delay line was full.
  };
  /// Whether the packet was taken.
  using Send = std::function<bool(std::size_t port, std::span<const std::byte> packet)>;

  /// Throws std::invalid_argument when there are fewer than two ports or two of one name.
  Hub(const std::vector<std::string>& port_names, const Settings& settings, Send send);

  /// Follows all commands but kStatistics and kQuit, which are not the hub's. Throws CommandError
  /// when there is no such port.
  void Follow(const Command& command);

  /// @pre `now_ns` never decreases, here and in SendDue().
  void OnPacket(std::size_t from, std::span<const std::byte> packet, std::int64_t now_ns);

  /// Sends what was held back until now.
  void SendDue(std::int64_t now_ns);
  [[nodiscard]] std::optional<std::int64_t> next_due_ns() const { return delayed_.next_due_ns(); }

  [[nodiscard]] const std::vector<Port>& ports() const { return ports_; }
  /// By port that a frame comes from, then by port that it goes to.
  [[nodiscard]] const std::vector<Direction>& directions() const { return directions_; }
  [[nodiscard]] const DelayLine& delayed() const { return delayed_; }

  /// The meters' intervals begin anew.
  void StartInterval();

 private:
  void Forward(Direction& direction,
               std::span<const std::byte> packet,
               SharedPacket& shared,
               std::int64_t now_ns);
  void SendNow(Direction& direction, std::span<const std::byte> packet);
  Direction& DirectionOf(std::size_t from, std::size_t to);
  [[nodiscard]] Port& PortOf(const std::string& name);

  Settings settings_;
  Send send_;
  std::vector<Port> ports_;
  std::vector<Direction> directions_;
  DelayLine delayed_;
};

}  // namespace clearway::relay
