// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/lcm_connection.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <netinet/in.h>
#include <stdexcept>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

#include <dirent.h>
#include <lcm/lcm.h>

#include "common/process/live_runtime.hpp"

namespace clearway::process {
namespace {

// Messages that may wait while a handler runs. LCM drops the newest beyond it, silently; the
// sequence numbers of our types then show the gap.
constexpr int kQueueCapacity = 2000;

// Where there is a route but nothing comes back, behind a firewall say, LCM's test of itself waits
// 10 s for its message. The pause after an attempt is so many times as long as it took, so that who
// waits for a network has most of his time for other work.
constexpr int kPauseOfTries = 10;

constexpr char kAdvice[] =
    " (LCM needs a multicast route; on a machine without a network: "
    "ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo)";

// What the kernel will grant, so that LCM does not warn about the rest.
int GrantableBufferBytes(int wanted) {
  std::ifstream file("/proc/sys/net/core/rmem_max");
  int limit = wanted;
  file >> limit;
  return std::min(wanted, limit);
}

sockaddr_in GroupOf(const std::string& url) {
  const std::size_t begin = std::strlen("udpm://");
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(PortOf(url)));
  inet_pton(AF_INET, url.substr(begin, url.rfind(':') - begin).c_str(), &address.sin_addr);
  return address;
}

std::string EscapeRegex(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (std::strchr("\\^$.|?*+()[]{}", c) != nullptr) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

// The address by which this host would send to the group; empty when it could not.
std::string SourceAddress(const BusConfig& config) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return {};
  const sockaddr_in group = GroupOf(config.url);
  sockaddr_in source{};
  socklen_t length = sizeof(source);
  const bool found = connect(fd, reinterpret_cast<const sockaddr*>(&group), sizeof(group)) == 0 &&
                     getsockname(fd, reinterpret_cast<sockaddr*>(&source), &length) == 0;
  close(fd);
  std::array<char, INET_ADDRSTRLEN> text{};
  if (!found || inet_ntop(AF_INET, &source.sin_addr, text.data(), text.size()) == nullptr)
    return {};
  return text.data();
}

// Granted buffer of the UDP socket that is bound to `port`; -1 when `fd` is no such socket.
std::int64_t BufferOfSocket(int fd, int port) {
  sockaddr_in address{};
  socklen_t length = sizeof(address);
  if (getsockname(fd, reinterpret_cast<sockaddr*>(&address), &length) != 0) return -1;
  if (address.sin_family != AF_INET || ntohs(address.sin_port) != port) return -1;
  int bytes = 0;
  length = sizeof(bytes);
  if (getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, &length) != 0) return -1;
  return bytes / 2;  // The kernel doubles the value for its own bookkeeping.
}

}  // namespace

std::string FullUrl(const BusConfig& config) {
  return config.url + "?ttl=" + std::to_string(config.ttl) +
         "&recv_buf_size=" + std::to_string(GrantableBufferBytes(config.receive_buffer_bytes));
}

LcmConnection::LcmConnection(const BusConfig& config, MissingNetwork missing_network)
    : config_(config),
      full_url_(FullUrl(config)),
      may_wait_(missing_network == MissingNetwork::kWait) {
  if (!Open() && !may_wait_) throw std::runtime_error(problem_);
}

LcmConnection::~LcmConnection() {
  Close();
}

bool LcmConnection::Open() {
  source_address_ = SourceAddress(config_);
  lcm_ = lcm_create(full_url_.c_str());
  problem_ = lcm_ == nullptr ? "cannot open LCM at " + full_url_ + kAdvice : std::string();
  for (Subscription& subscription : subscriptions_) {
    if (lcm_ == nullptr || !SubscribeInLcm(subscription)) break;
  }
  if (lcm_ != nullptr && !problem_.empty()) Close();
  return lcm_ != nullptr;
}

void LcmConnection::Close() {
  if (lcm_ != nullptr) lcm_destroy(lcm_);
  lcm_ = nullptr;
  file_descriptor_ = -1;
}

bool LcmConnection::KeepOpen() {
  if (is_open()) {
    const std::string address = SourceAddress(config_);
    if (address == source_address_) return false;
    // Without a way out nothing is gained by closing: what comes back may be the same network.
    if (address.empty()) {
      source_address_.clear();
      return false;
    }
    Close();
  }
  const auto begin = std::chrono::steady_clock::now();
  if (begin < next_try_) return false;
  const bool was_opened = Open();
  const auto end = std::chrono::steady_clock::now();
  next_try_ = end + kPauseOfTries * (end - begin);
  return was_opened;
}

bool LcmConnection::Publish(const std::string& channel, std::span<const std::byte> bytes) {
  if (!is_open()) return false;
  errno = 0;
  const auto size = static_cast<unsigned>(bytes.size());
  const bool sent = lcm_publish(lcm_, channel.c_str(), bytes.data(), size) == 0;
  if (!sent && !has_sent_ && !may_wait_) {
    throw std::runtime_error("cannot publish " + std::to_string(bytes.size()) + " bytes on " +
                             channel + " at " + full_url_ + ": " + std::strerror(errno) + kAdvice);
  }
  has_sent_ = has_sent_ || sent;
  return sent;
}

void LcmConnection::Subscribe(const std::string& channel, BytesHandler handler) {
  subscriptions_.push_back({this, channel, std::move(handler)});
  if (!is_open() || SubscribeInLcm(subscriptions_.back())) return;
  if (may_wait_) {
    Close();
  } else {
    subscriptions_.pop_back();
    throw std::runtime_error(problem_);
  }
}

bool LcmConnection::SubscribeInLcm(Subscription& subscription) {
  lcm_subscription_t* const handle = lcm_subscribe(
      lcm_, EscapeRegex(subscription.channel).c_str(), &LcmConnection::OnMessage, &subscription);
  if (handle == nullptr) {
    problem_ = "cannot receive from LCM at " + full_url_ + kAdvice;
    return false;
  }
  lcm_subscription_set_queue_capacity(handle, kQueueCapacity);
  file_descriptor_ = lcm_get_fileno(lcm_);
  return true;
}

void LcmConnection::OnMessage(const lcm_recv_buf_t* buffer, const char* /*channel*/, void* user) {
  const Subscription& subscription = *static_cast<Subscription*>(user);
  LcmConnection& connection = *subscription.connection;
  if (connection.handler_error_) return;  // Unwinding: the error of another handler leaves first.
  try {
    subscription.handler(
        {static_cast<const std::byte*>(buffer->data), std::size_t{buffer->data_size}});
  } catch (...) {
    connection.handler_error_ = std::current_exception();
  }
}

bool LcmConnection::HandleOne() {
  if (file_descriptor_ < 0) return false;
  const int handled = lcm_handle_timeout(lcm_, 0);
  if (handler_error_) std::rethrow_exception(std::exchange(handler_error_, nullptr));
  if (handled < 0 && errno != EINTR) {
    throw std::runtime_error("cannot receive from LCM at " + full_url_ + ": " +
                             std::strerror(errno));
  }
  return handled > 0;
}

std::int64_t LcmConnection::ReceiveBufferBytes() const {
  if (file_descriptor_ < 0) return -1;
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(opendir("/proc/self/fd"), &closedir);
  std::int64_t largest = -1;  // LCM's sending socket is not bound to the port.
  for (const dirent* entry = folder ? readdir(folder.get()) : nullptr; entry != nullptr;
       entry = readdir(folder.get())) {
    largest = std::max(largest, BufferOfSocket(std::atoi(entry->d_name), PortOf(config_.url)));
  }
  return largest;
}

}  // namespace clearway::process
