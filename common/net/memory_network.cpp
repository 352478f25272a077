// SPDX-License-Identifier: BSD-3-Clause
#include "common/net/memory_network.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

namespace clearway::net {
namespace internal {

struct SocketState {
  SocketSettings settings;
  Endpoint local;
  Network::Handler handler;
  SocketCounts counts;
  bool is_open = true;
};

struct HostState {
  std::vector<Interface> interfaces;  // Loopback first.
  std::map<Endpoint, std::shared_ptr<SocketState>> sockets;
  bool is_plugged = true;

  [[nodiscard]] bool Owns(Ipv4 ip) const {
    if (interfaces.front().Reaches(ip)) return true;
    return std::any_of(
        interfaces.begin(), interfaces.end(), [ip](const Interface& one) { return one.ip == ip; });
  }
  [[nodiscard]] const Interface* WayTo(Ipv4 ip) const {
    const auto way = std::find_if(interfaces.begin(), interfaces.end(), [ip](const Interface& one) {
      return one.Reaches(ip);
    });
    return way == interfaces.end() ? nullptr : &*way;
  }
  [[nodiscard]] std::shared_ptr<SocketState> Find(const Endpoint& to) const {
    for (const Endpoint& bound : {to, Endpoint{core::kAnyIpv4, to.port}}) {
      const auto found = sockets.find(bound);
      if (found != sockets.end()) return found->second;
    }
    return nullptr;
  }
};

// Datagrams that arrive together: one buffer for all, so that a thousand a second cost no thousand
// allocations.
struct Batch {
  struct Entry {
    std::shared_ptr<SocketState> to;
    Endpoint from;
    std::size_t begin;
    std::size_t length;
  };
  std::vector<Entry> entries;
  std::vector<std::byte> bytes;

  void Add(const std::shared_ptr<SocketState>& to,
           const Endpoint& from,
           std::span<const std::byte> datagram) {
    entries.push_back({to, from, bytes.size(), datagram.size()});
    bytes.insert(bytes.end(), datagram.begin(), datagram.end());
  }
  void Clear() {
    entries.clear();
    bytes.clear();
  }
};

struct WireState : std::enable_shared_from_this<WireState> {
  explicit WireState(process::Runtime& the_runtime) : runtime(the_runtime) {}

  process::Runtime& runtime;
  MemoryWire::Filter filter;
  std::vector<std::shared_ptr<HostState>> hosts;
  Batch waiting;              // For the next delivery.
  Batch under_way;            // Being handed on; handlers fill `waiting` meanwhile.
  std::vector<Datagram> run;  // Of one socket.
  bool is_scheduled = false;

  void Put(const std::shared_ptr<SocketState>& to,
           const Endpoint& from,
           std::span<const std::byte> datagram) {
    waiting.Add(to, from, datagram);
    if (is_scheduled) return;
    is_scheduled = true;
    runtime.After(0, [weak = weak_from_this()] {
      if (const auto wire = weak.lock()) wire->Deliver();
    });
  }

  void PutLater(std::int64_t delay_us,
                const std::shared_ptr<SocketState>& to,
                const Endpoint& from,
                std::span<const std::byte> datagram) {
    runtime.After(delay_us,
                  [weak = weak_from_this(),
                   to,
                   from,
                   copy = std::vector<std::byte>(datagram.begin(), datagram.end())] {
                    if (const auto wire = weak.lock()) wire->Put(to, from, copy);
                  });
  }

  void Deliver() {
    is_scheduled = false;
    under_way.Clear();  // A handler that threw left it full.
    std::swap(waiting, under_way);
    const std::int64_t now_utime = runtime.UtimeNow();
    const std::vector<Batch::Entry>& entries = under_way.entries;
    for (std::size_t begin = 0; begin < entries.size();) {
      std::size_t end = begin;
      while (end < entries.size() && entries[end].to == entries[begin].to) ++end;
      HandOn(begin, end, now_utime);
      begin = end;
    }
  }

  void HandOn(std::size_t begin, std::size_t end, std::int64_t now_utime) {
    const std::shared_ptr<SocketState> socket = under_way.entries[begin].to;
    run.clear();
    for (std::size_t i = begin; i < end; ++i) {
      const Batch::Entry& entry = under_way.entries[i];
      if (entry.length > kMaxDatagramBytes) {
        ++socket->counts.truncated;
        continue;
      }
      run.push_back(
          {entry.from, std::span(under_way.bytes).subspan(entry.begin, entry.length), now_utime});
    }
    if (!socket->is_open || run.empty()) return;
    socket->counts.received += static_cast<std::int64_t>(run.size());
    socket->handler(run);
  }

  bool Send(const HostState& host,
            const SocketState& socket,
            const Endpoint& to,
            std::span<const std::byte> datagram) {
    if (to.port == 0 || datagram.size() > MemoryHost::kMaxUdpBytes) return false;
    if (to.ip == core::kBroadcastIpv4) return SendToAll(host, socket, to.port, datagram);
    const Interface* way = host.WayTo(to.ip);
    if (way == nullptr) return false;
    const bool stays = host.Owns(to.ip);
    const bool is_loopback = way == &host.interfaces.front();
    const bool from_loopback =
        socket.local.ip != core::kAnyIpv4 && host.interfaces.front().Reaches(socket.local.ip);
    if (from_loopback && !stays) return false;
    const Ipv4 own = is_loopback || !stays ? way->ip : to.ip;
    const Endpoint from{socket.local.ip == core::kAnyIpv4 ? own : socket.local.ip,
                        socket.local.port};
    if (stays) {
      if (const auto target = host.Find(to)) Put(target, from, datagram);
      return true;
    }
    if (host.is_plugged) SendOut(from, to, datagram);
    return true;
  }

  bool SendToAll(const HostState& host,
                 const SocketState& socket,
                 std::uint16_t port,
                 std::span<const std::byte> datagram) {
    if (!socket.settings.can_broadcast || host.interfaces.size() < 2) return false;
    const Ipv4 own = socket.local.ip == core::kAnyIpv4 ? host.interfaces[1].ip : socket.local.ip;
    const Endpoint from{own, socket.local.port};
    for (const std::shared_ptr<HostState>& other : hosts) {
      const auto found = other->sockets.find({core::kAnyIpv4, port});
      if (found == other->sockets.end()) continue;
      if (other.get() == &host) {
        Put(found->second, from, datagram);
      } else if (host.is_plugged && other->is_plugged) {
        Carry(found->second, from, {core::kBroadcastIpv4, port}, datagram);
      }
    }
    return true;
  }

  void SendOut(const Endpoint& from, const Endpoint& to, std::span<const std::byte> datagram) {
    for (const std::shared_ptr<HostState>& other : hosts) {
      if (!other->is_plugged || !other->Owns(to.ip)) continue;
      if (const auto target = other->Find(to)) Carry(target, from, to, datagram);
    }
  }

  void Carry(const std::shared_ptr<SocketState>& target,
             const Endpoint& from,
             const Endpoint& to,
             std::span<const std::byte> datagram) {
    if (!filter) return Put(target, from, datagram);
    const std::optional<std::int64_t> delay_us = filter(from, to, datagram);
    if (!delay_us) return;
    if (*delay_us > 0) return PutLater(*delay_us, target, from, datagram);
    Put(target, from, datagram);
  }
};

}  // namespace internal

namespace {

constexpr Ipv4 kLoopback = 0x7F000001;
constexpr Ipv4 kLoopbackMask = 0xFF000000;
constexpr Ipv4 kMask = 0xFFFFFF00;
constexpr std::uint16_t kFirstFreePort = 32768;

class MemorySocket final : public Socket {
 public:
  MemorySocket(std::shared_ptr<internal::WireState> wire,
               std::shared_ptr<internal::HostState> host,
               std::shared_ptr<internal::SocketState> state)
      : wire_(std::move(wire)), host_(std::move(host)), state_(std::move(state)) {}
  ~MemorySocket() override {
    state_->is_open = false;
    host_->sockets.erase(state_->local);
  }
  MemorySocket(const MemorySocket&) = delete;
  MemorySocket& operator=(const MemorySocket&) = delete;

  bool Send(const Endpoint& to, std::span<const std::byte> bytes) override {
    const bool is_sent = wire_->Send(*host_, *state_, to, bytes);
    ++(is_sent ? state_->counts.sent : state_->counts.send_failures);
    return is_sent;
  }
  [[nodiscard]] Endpoint local() const override { return state_->local; }
  [[nodiscard]] SocketCounts counts() const override { return state_->counts; }
  [[nodiscard]] int receive_buffer_bytes() const override { return -1; }

 private:
  std::shared_ptr<internal::WireState> wire_;
  std::shared_ptr<internal::HostState> host_;
  std::shared_ptr<internal::SocketState> state_;
};

bool IsTaken(const internal::HostState& host, const Endpoint& wanted) {
  return std::any_of(host.sockets.begin(), host.sockets.end(), [&wanted](const auto& entry) {
    const Endpoint& bound = entry.first;
    return bound.port == wanted.port &&
           (bound.ip == wanted.ip || bound.ip == core::kAnyIpv4 || wanted.ip == core::kAnyIpv4);
  });
}

Endpoint FreeEndpoint(const internal::HostState& host, const Endpoint& wanted) {
  Endpoint endpoint = wanted;
  if (endpoint.port != 0) {
    if (IsTaken(host, endpoint)) {
      throw NetworkError("cannot listen on UDP " + core::ToString(endpoint) +
                         ": another socket of this host in memory has the port");
    }
    return endpoint;
  }
  for (endpoint.port = kFirstFreePort; endpoint.port != 0; ++endpoint.port) {
    if (!IsTaken(host, endpoint)) return endpoint;
  }
  throw NetworkError("cannot listen on UDP " + core::ToString(wanted) + ": no port is free");
}

}  // namespace

MemoryWire::MemoryWire(process::Runtime& runtime)
    : state_(std::make_shared<internal::WireState>(runtime)) {}

void MemoryWire::SetFilter(Filter filter) {
  state_->filter = std::move(filter);
}

MemoryHost::MemoryHost(MemoryWire& wire, std::vector<Ipv4> addresses)
    : wire_(wire.state_), state_(std::make_shared<internal::HostState>()) {
  state_->interfaces.push_back({"lo", kLoopback, kLoopbackMask});
  for (const Ipv4 address : addresses) {
    if (state_->interfaces.front().Reaches(address)) continue;  // Every host has these.
    for (const auto& other : wire_->hosts) {
      if (other->Owns(address)) {
        throw std::invalid_argument("MemoryHost: another host has " + core::ToString(address));
      }
    }
    state_->interfaces.push_back(
        {"mem" + std::to_string(state_->interfaces.size() - 1), address, kMask});
  }
  wire_->hosts.push_back(state_);
}

MemoryHost::~MemoryHost() {
  std::erase(wire_->hosts, state_);
}

std::unique_ptr<Socket> MemoryHost::Open(const SocketSettings& settings, Handler handler) {
  const Ipv4 ip = settings.bind.ip;
  if (ip != core::kAnyIpv4 && !state_->Owns(ip)) {
    throw NetworkError("cannot listen on UDP " + core::ToString(settings.bind) +
                       ": no interface of this host in memory has that address");
  }
  auto socket = std::make_shared<internal::SocketState>();
  socket->settings = settings;
  socket->local = FreeEndpoint(*state_, settings.bind);
  socket->handler = std::move(handler);
  state_->sockets[socket->local] = socket;
  return std::make_unique<MemorySocket>(wire_, state_, std::move(socket));
}

std::vector<Interface> MemoryHost::Interfaces() const {
  return state_->interfaces;
}

void MemoryHost::SetPlugged(bool is_plugged) {
  state_->is_plugged = is_plugged;
}

}  // namespace clearway::net
