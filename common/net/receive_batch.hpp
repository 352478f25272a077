// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <vector>

#include "common/net/datagrams.hpp"

namespace clearway::net {

/// Room for several datagrams, which the kernel fills with one call. Allocates once.
class ReceiveBatch {
 public:
  static constexpr std::size_t kMaxDatagrams = 64;

  ReceiveBatch();
  ReceiveBatch(const ReceiveBatch&) = delete;
  ReceiveBatch& operator=(const ReceiveBatch&) = delete;

  /// Takes what waits at a socket that does not block: how many datagrams came, at most
  /// kMaxDatagrams; -1 with errno where the kernel says no.
  int Receive(int fd);

  /// Those of the last Receive() that came whole, oldest first; valid until the next one.
  /// `fallback_utime` is the arrival of those that the kernel did not stamp.
  [[nodiscard]] std::span<const Datagram> Whole(std::int64_t fallback_utime);

  /// Of the last Receive(): datagrams that did not fit.
  [[nodiscard]] std::int64_t truncated() const { return truncated_; }
  /// The kernel's count of what it dropped at this socket, modulo 2^32, as last told.
  [[nodiscard]] std::uint32_t drop_count() const { return drop_count_; }

 private:
  // A time stamp and a drop count.
  static constexpr std::size_t kControlBytes = 128;
  struct alignas(cmsghdr) Control {
    std::array<std::byte, kControlBytes> bytes;
  };

  void ReadControl(msghdr& header, Datagram& datagram);

  std::vector<std::byte> bytes_;
  std::array<iovec, kMaxDatagrams> vectors_{};
  std::array<sockaddr_in, kMaxDatagrams> addresses_{};
  std::array<Control, kMaxDatagrams> controls_{};
  std::array<mmsghdr, kMaxDatagrams> headers_{};
  std::array<Datagram, kMaxDatagrams> datagrams_{};
  std::size_t received_ = 0;
  std::int64_t truncated_ = 0;
  std::uint32_t drop_count_ = 0;
};

}  // namespace clearway::net
