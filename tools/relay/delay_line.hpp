// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <queue>
#include <vector>

namespace clearway::relay {

/// The bytes of a packet, shared by all that wait to send it.
using SharedPacket = std::shared_ptr<const std::vector<std::byte>>;

/// A packet that is to leave later.
struct DelayedPacket {
  std::int64_t due_ns = 0;
  std::size_t from = 0;  ///< Index of the port.
  std::size_t to = 0;    ///< Likewise.
  SharedPacket bytes;
};

/// Packets in the order in which they are due; those due at once in the order in which they came.
class DelayLine {
 public:
  explicit DelayLine(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// Tells whether there was room; a packet that waits for two ports is counted twice.
  [[nodiscard]] bool Push(DelayedPacket packet);

  /// The next packet that is due by then, if there is one.
  [[nodiscard]] std::optional<DelayedPacket> PopDue(std::int64_t now_ns);

  [[nodiscard]] std::optional<std::int64_t> next_due_ns() const;
  [[nodiscard]] std::size_t num_packets() const { return packets_.size(); }
  [[nodiscard]] std::size_t num_bytes() const { return num_bytes_; }

 private:
  struct Entry {
    DelayedPacket packet;
    std::uint64_t number = 0;
  };
  struct IsLater {
    bool operator()(const Entry& a, const Entry& b) const {
      return a.packet.due_ns != b.packet.due_ns ? a.packet.due_ns > b.packet.due_ns
                                                : a.number > b.number;
    }
  };

  std::size_t max_bytes_;
  std::size_t num_bytes_ = 0;
  std::uint64_t next_number_ = 0;
  std::priority_queue<Entry, std::vector<Entry>, IsLater> packets_;
};

}  // namespace clearway::relay
