// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "common/process/buses_config.hpp"

// LCM's C structs, so that its headers stay out of ours.
struct _lcm_t;
struct _lcm_recv_buf_t;

namespace clearway::process {

/// Hears everything on one bus, whatever the channel: for tools that look at a bus from outside.
/// Processes use a Node.
class BusTap {
 public:
  /// Must not throw.
  using Handler = std::function<void(const std::string& channel, std::span<const std::byte> bytes)>;

  /// Blocks for up to 10 s where LCM does not hear itself. Throws std::runtime_error when the bus
  /// cannot be opened.
  BusTap(const BusConfig& config, Handler handler);
  ~BusTap();
  BusTap(const BusTap&) = delete;
  BusTap& operator=(const BusTap&) = delete;

  /// Whether the network took it.
  bool Publish(const std::string& channel, std::span<const std::byte> bytes);

  /// Hands over what arrives within `timeout_us`, the first message of it and all that wait then;
  /// tells whether there was any.
  bool HandleWaiting(std::int64_t timeout_us);

 private:
  static void OnMessage(const ::_lcm_recv_buf_t* buffer, const char* channel, void* user);

  Handler handler_;
  ::_lcm_t* lcm_ = nullptr;
};

}  // namespace clearway::process
