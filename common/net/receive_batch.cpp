// SPDX-License-Identifier: BSD-3-Clause
#include "common/net/receive_batch.hpp"

#include <cstring>
#include <ctime>

namespace clearway::net {

ReceiveBatch::ReceiveBatch() : bytes_(kMaxDatagrams * kMaxDatagramBytes) {
  for (std::size_t i = 0; i < kMaxDatagrams; ++i) {
    vectors_[i] = {bytes_.data() + i * kMaxDatagramBytes, kMaxDatagramBytes};
    headers_[i].msg_hdr.msg_iov = &vectors_[i];
    headers_[i].msg_hdr.msg_iovlen = 1;
    headers_[i].msg_hdr.msg_name = &addresses_[i];
    headers_[i].msg_hdr.msg_control = &controls_[i];
  }
}

int ReceiveBatch::Receive(int fd) {
  received_ = 0;
  truncated_ = 0;
  for (mmsghdr& header : headers_) {
    // The kernel leaves here what it used.
    header.msg_hdr.msg_namelen = sizeof(sockaddr_in);
    header.msg_hdr.msg_controllen = sizeof(Control);
  }
  const int count = recvmmsg(fd, headers_.data(), kMaxDatagrams, MSG_DONTWAIT, nullptr);
  if (count > 0) received_ = static_cast<std::size_t>(count);
  return count;
}

std::span<const Datagram> ReceiveBatch::Whole(std::int64_t fallback_utime) {
  std::size_t whole = 0;
  for (std::size_t i = 0; i < received_; ++i) {
    Datagram datagram{.from = {ntohl(addresses_[i].sin_addr.s_addr), ntohs(addresses_[i].sin_port)},
                      .bytes = {bytes_.data() + i * kMaxDatagramBytes, headers_[i].msg_len},
                      .arrival_utime = fallback_utime};
    ReadControl(headers_[i].msg_hdr, datagram);
    if ((headers_[i].msg_hdr.msg_flags & MSG_TRUNC) != 0) {
      ++truncated_;
    } else {
      datagrams_[whole++] = datagram;
    }
  }
  received_ = 0;
  return {datagrams_.data(), whole};
}

void ReceiveBatch::ReadControl(msghdr& header, Datagram& datagram) {
  for (cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr; part = CMSG_NXTHDR(&header, part)) {
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SCM_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(part), sizeof(stamp));
      datagram.arrival_utime = std::int64_t{stamp.tv_sec} * 1'000'000 + stamp.tv_nsec / 1000;
    } else if (part->cmsg_type == SO_RXQ_OVFL) {
      std::memcpy(&drop_count_, CMSG_DATA(part), sizeof(drop_count_));
    }
  }
}

}  // namespace clearway::net
