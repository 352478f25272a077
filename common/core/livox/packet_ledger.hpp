// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace clearway::core::livox {

/// What a packet is to those that came before.
enum class PacketVerdict : std::int8_t {
  kNew,
  kDuplicate,  ///< Its stamp was there already.
  kLate        ///< Its time is closed.
};

/// Keeps account of a sensor's packets by their stamps, since they carry no number: what came,
/// what is missing, what came twice. All times are stamps on the sensor's clock [ns] since any
/// moment of it.
///
/// Time is accounted for without a gap up to accounted_ns(): by packets, and by declared losses. A
/// gap counts as round(gap / duration of the packet before it) packets; nothing is lost until
/// DeclareLost() says so, and what fills a gap before is no loss. Packets may come in any order.
/// Duplicates are known among the last kRemembered stamps; an older one is late.
/// Time: O(1) a packet in order, O(packets behind a gap) others. Thread safety: none.
class PacketLedger {
 public:
  static constexpr std::size_t kRemembered = 2048;

  PacketLedger();

  /// Begins anew.
  void Clear();

  /// What a packet with this stamp is; changes nothing.
  [[nodiscard]] PacketVerdict Judge(std::int64_t stamp_ns) const;

  /// Takes it into account. @pre Judge(stamp_ns) is not kDuplicate; duration_ns > 0. A late one is
  /// only remembered.
  void Add(std::int64_t stamp_ns, std::int64_t duration_ns);

  /// Of a packet whose time is only that of its arrival: no gap before it is a loss.
  void AddUnstamped(std::int64_t start_ns, std::int64_t duration_ns);
  [[nodiscard]] bool IsClosed(std::int64_t stamp_ns) const { return stamp_ns < closed_ns_; }

  /// No gap is open before this.
  [[nodiscard]] std::int64_t accounted_ns() const { return accounted_ns_; }
  /// The end of the youngest packet.
  [[nodiscard]] std::int64_t newest_end_ns() const { return newest_end_ns_; }
  [[nodiscard]] bool empty() const { return is_empty_; }

  /// Gives up the packets that would have begun before `until_ns`, as far as a younger one has
  /// come; returns how many.
  std::int64_t DeclareLost(std::int64_t until_ns);

  /// What begins before this comes late from now on.
  void Close(std::int64_t until_ns) { closed_ns_ = until_ns; }

  /// Nothing is missing before the packet that begins here. @pre no gap is open.
  void SkipTo(std::int64_t stamp_ns) { accounted_ns_ = stamp_ns; }

 private:
  struct Waiting {
    std::int64_t stamp_ns = 0;
    std::int64_t duration_ns = 0;
  };

  void Remember(std::int64_t stamp_ns);
  void Advance();

  bool is_empty_ = true;
  std::int64_t accounted_ns_ = 0;
  std::int64_t newest_end_ns_ = 0;
  std::int64_t closed_ns_ = 0;
  std::int64_t unit_ns_ = 1;              // Duration of the packet before accounted_ns_.
  std::vector<Waiting> waiting_;          // Beyond the first gap, ascending.
  std::vector<std::int64_t> remembered_;  // Ascending.
};

}  // namespace clearway::core::livox
