// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "common/core/endpoint.hpp"
#include "common/core/livox/little_endian.hpp"
#include "common/core/simulation/emulated_sensor_faults.hpp"

namespace clearway::core {

/// Data packets on their way through a network that is bad at stated times: which are lost,
/// doubled, held back and late depends on the seed and the packet's number only. Counts are those
/// that a receiver of everything that leaves would find.
class PacketFaults {
 public:
  struct Packet {
    Endpoint to;
    livox::Bytes bytes;
  };
  struct Counts {
    std::int64_t lost = 0;
    std::int64_t duplicates = 0;  ///< Second copies that left.
    std::int64_t reordered = 0;   ///< First copies that left after a younger packet had.
    std::int64_t control_lost = 0;
  };

  PacketFaults(std::vector<NetworkFaultConfig> faults, std::uint64_t seed)
      : faults_(std::move(faults)), seed_(seed) {}

  /// A packet enters at `now_us` after the simulator's start, which never goes back. When several
  /// faults hold, the first in the list does.
  void Put(Packet packet, std::int64_t now_us);

  /// The next packet that leaves at `now_us` at the latest; nothing while none is due.
  [[nodiscard]] std::optional<Packet> Take(std::int64_t now_us);

  /// When the next one leaves.
  [[nodiscard]] std::optional<std::int64_t> NextDue() const;

  /// How many packets and second copies are under way.
  [[nodiscard]] std::size_t size() const { return queue_.size(); }

  /// What is under way is lost, and counted.
  void DropAll();

  /// Whether a control frame that enters now is lost; counted.
  [[nodiscard]] bool LosesControl(std::int64_t now_us);

  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  struct UnderWay {
    Packet packet;
    std::int64_t number = 0;
    bool is_copy = false;
  };

  [[nodiscard]] const NetworkFaultConfig* FaultAt(std::int64_t now_us) const;
  [[nodiscard]] double Draw(std::int64_t number, std::uint64_t what) const;
  [[nodiscard]] std::int64_t Jitter(const NetworkFaultConfig& fault, std::int64_t number) const;
  void Enqueue(std::int64_t due_us, UnderWay under_way);

  std::vector<NetworkFaultConfig> faults_;
  std::uint64_t seed_;
  Counts counts_;
  // By when it leaves, then by when it was put there.
  std::map<std::pair<std::int64_t, std::int64_t>, UnderWay> queue_;
  std::int64_t num_enqueued_ = 0;
  std::int64_t next_number_ = 0;
  std::int64_t newest_out_ = -1;
  std::int64_t last_due_us_ = 0;
  std::int64_t num_control_ = 0;
};

}  // namespace clearway::core
