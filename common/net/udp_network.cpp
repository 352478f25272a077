// SPDX-License-Identifier: BSD-3-Clause
#include "common/net/udp_network.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <net/if.h>
#include <string>
#include <sys/socket.h>

#include <ifaddrs.h>

#include "common/host/descriptor.hpp"
#include "common/host/port_holders.hpp"
#include "common/net/receive_batch.hpp"

namespace clearway::net {
namespace {

// What is taken in a row before others get their turn: a whole large receive buffer, so that what
// has arrived is handled before anybody judges it as missing.
constexpr int kMaxDatagramsInARow = 8192;

sockaddr_in AddressOf(const Endpoint& endpoint) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(endpoint.port);
  address.sin_addr.s_addr = htonl(endpoint.ip);
  return address;
}

Endpoint EndpointOf(const sockaddr_in& address) {
  return {ntohl(address.sin_addr.s_addr), ntohs(address.sin_port)};
}

void SetOption(int fd, int option, const char* name) {
  const int on = 1;
  if (setsockopt(fd, SOL_SOCKET, option, &on, sizeof(on)) == 0) return;
  throw NetworkError(std::string("cannot set ") + name + ": " + std::strerror(errno));
}

// What the kernel granted, in the unit in which it is asked: it doubles the value for itself.
int GrantedBuffer(int fd) {
  int bytes = 0;
  socklen_t length = sizeof(bytes);
  return getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, &length) == 0 ? bytes / 2 : -1;
}

void AskForBuffer(int fd, int bytes) {
  if (bytes <= 0) return;
  // Only with the right to administer networks; all others get net.core.rmem_max at most.
  if (setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof(bytes)) == 0) return;
  setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof(bytes));
}

std::string WhyTaken(const Endpoint& endpoint) {
  std::string who;
  for (const host::PortHolder& holder : host::UdpPortHolders(endpoint.port)) {
    who += (who.empty() ? "" : ", ") + holder.program + " (pid " + std::to_string(holder.pid) + ")";
  }
  if (who.empty()) who = "another program, perhaps of another user (sudo ss -ulpn shows it)";
  return who + " has it; end that, or choose another port";
}

[[noreturn]] void ThrowBindError(const Endpoint& endpoint, int error) {
  std::string reason = std::strerror(error);
  if (error == EADDRINUSE) reason = WhyTaken(endpoint);
  if (error == EADDRNOTAVAIL) reason = "no interface of this host has that address";
  if (error == EACCES) reason = "ports below 1024 need more rights";
  throw NetworkError("cannot listen on UDP " + ToString(endpoint) + ": " + reason);
}

host::Descriptor OpenBound(const SocketSettings& settings) {
  host::Descriptor fd(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!fd.is_open()) throw NetworkError(std::string("cannot open a socket: ") + strerror(errno));
  SetOption(fd.get(), SO_TIMESTAMPNS, "SO_TIMESTAMPNS");
  SetOption(fd.get(), SO_RXQ_OVFL, "SO_RXQ_OVFL");
  if (settings.can_broadcast) SetOption(fd.get(), SO_BROADCAST, "SO_BROADCAST");
  AskForBuffer(fd.get(), settings.receive_buffer_bytes);
  const sockaddr_in address = AddressOf(settings.bind);
  if (bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    ThrowBindError(settings.bind, errno);
  }
  return fd;
}

class UdpSocket final : public Socket {
 public:
  UdpSocket(process::LiveRuntime& runtime, const SocketSettings& settings, Network::Handler handler)
      : runtime_(runtime), state_(std::make_shared<State>(OpenBound(settings))) {
    state_->handler = std::move(handler);
    // A copy of the pointer: the handler may destroy this socket.
    runtime.WatchDescriptor(state_->fd.get(),
                            [&runtime, state = state_] { Read(runtime, *state); });
  }
  ~UdpSocket() override {
    runtime_.UnwatchDescriptor(state_->fd.get());
    state_->fd.Reset();
  }
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  bool Send(const Endpoint& to, std::span<const std::byte> bytes) override;
  [[nodiscard]] Endpoint local() const override;
  [[nodiscard]] SocketCounts counts() const override { return state_->counts; }
  [[nodiscard]] int receive_buffer_bytes() const override {
    return GrantedBuffer(state_->fd.get());
  }
  [[nodiscard]] std::string send_error() const override { return send_error_; }

 private:
  struct State {
    explicit State(host::Descriptor descriptor) : fd(std::move(descriptor)) {}
    host::Descriptor fd;
    Network::Handler handler;
    ReceiveBatch batch;
    std::uint32_t drop_count = 0;
    SocketCounts counts;
  };

  static void Read(process::LiveRuntime& runtime, State& state);

  process::LiveRuntime& runtime_;
  std::shared_ptr<State> state_;
  std::string send_error_;
};

void UdpSocket::Read(process::LiveRuntime& runtime, State& state) {
  for (int taken = 0; taken < kMaxDatagramsInARow && state.fd.is_open();) {
    const int count = state.batch.Receive(state.fd.get());
    if (count < 0) {
      // Anything but "nothing there" is told once and gone, e.g. what became of a datagram sent.
      if (errno == EAGAIN || errno == EWOULDBLOCK) return;
      ++taken;
      continue;
    }
    taken += count;
    const std::span<const Datagram> whole = state.batch.Whole(runtime.UtimeNow());
    state.counts.received += static_cast<std::int64_t>(whole.size());
    state.counts.truncated += state.batch.truncated();
    // The kernel's count wraps; differences do not.
    state.counts.dropped_by_kernel += state.batch.drop_count() - state.drop_count;
    state.drop_count = state.batch.drop_count();
    if (!whole.empty()) state.handler(whole);
    if (count < static_cast<int>(ReceiveBatch::kMaxDatagrams)) return;
  }
}

bool UdpSocket::Send(const Endpoint& to, std::span<const std::byte> bytes) {
  const sockaddr_in address = AddressOf(to);
  // A refusal may be that of an earlier datagram; the second try is about this one.
  for (int attempt = 0; attempt < 2; ++attempt) {
    const ssize_t sent = sendto(state_->fd.get(),
                                bytes.data(),
                                bytes.size(),
                                MSG_NOSIGNAL,
                                reinterpret_cast<const sockaddr*>(&address),
                                sizeof(address));
    if (sent == static_cast<ssize_t>(bytes.size())) {
      ++state_->counts.sent;
      send_error_.clear();
      return true;
    }
    if (errno != EINTR && errno != ECONNREFUSED) break;
  }
  send_error_ = std::strerror(errno);
  ++state_->counts.send_failures;
  return false;
}

Endpoint UdpSocket::local() const {
  sockaddr_in address{};
  socklen_t length = sizeof(address);
  if (getsockname(state_->fd.get(), reinterpret_cast<sockaddr*>(&address), &length) != 0) return {};
  return EndpointOf(address);
}

}  // namespace

std::unique_ptr<Socket> UdpNetwork::Open(const SocketSettings& settings, Handler handler) {
  return std::make_unique<UdpSocket>(runtime_, settings, std::move(handler));
}

std::vector<Interface> UdpNetwork::Interfaces() const {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) {
    throw NetworkError(std::string("cannot list the network interfaces: ") + std::strerror(errno));
  }
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> all(first, &freeifaddrs);
  std::vector<Interface> interfaces;
  for (const ifaddrs* entry = first; entry != nullptr; entry = entry->ifa_next) {
    const bool is_ipv4 = entry->ifa_addr != nullptr && entry->ifa_netmask != nullptr &&
                         entry->ifa_addr->sa_family == AF_INET;
    if (!is_ipv4 || (entry->ifa_flags & IFF_UP) == 0) continue;
    sockaddr_in address{};
    sockaddr_in mask{};
    std::memcpy(&address, entry->ifa_addr, sizeof(address));
    std::memcpy(&mask, entry->ifa_netmask, sizeof(mask));
    interfaces.push_back({.name = entry->ifa_name,
                          .ip = ntohl(address.sin_addr.s_addr),
                          .mask = ntohl(mask.sin_addr.s_addr)});
  }
  return interfaces;
}

}  // namespace clearway::net
