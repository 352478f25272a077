// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tools/relay/hub.hpp"
#include "tools/relay/packet_socket.hpp"

namespace clearway::relay {

struct RelayPort {
  std::string name;
  std::string interface_name;
};

struct RelaySettings {
  std::vector<RelayPort> ports;
  std::vector<std::string> commands;  ///< Followed before the first frame.
  std::uint64_t seed = 1;
  std::size_t max_delayed_bytes = std::size_t{64} << 20U;
  bool until_eof = false;  ///< The end of the standard input ends the relay, too.
};

/// The hub with its sockets, the clock, and commands by standard input. Single thread.
class Relay {
 public:
  /// Throws std::runtime_error, std::invalid_argument or CommandError when it cannot be set up.
  explicit Relay(const RelaySettings& settings);

  /// Until SIGINT, SIGTERM, `quit`, or the end of the standard input where that was asked for.
  void Run();

 private:
  void WaitForEvents();
  void ReadFrames(std::size_t port);
  void ReadCommands();
  void Answer(const std::string& line);
  void Follow(const std::string& line);
  void PrintStatistics();

  bool until_eof_;
  bool is_input_open_ = true;
  bool is_done_ = false;
  std::string input_;  // What has no line end yet.
  std::int64_t interval_start_ns_;
  std::vector<std::unique_ptr<PacketSocket>> sockets_;
  std::vector<std::byte> buffer_;
  Hub hub_;
};

}  // namespace clearway::relay
