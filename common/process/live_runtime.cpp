// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/live_runtime.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <limits>
#include <poll.h>
#include <random>
#include <stdexcept>
#include <sys/signalfd.h>
#include <unistd.h>

#include "common/process/lcm_connection.hpp"
#include "common/process/log.hpp"

namespace clearway::process {
namespace {

// Messages of one bus that are handled before timers get their turn.
constexpr int kMessagesInARow = 64;
// Nor do timers wait for longer than this when each message is much work.
constexpr std::int64_t kTimersWaitUs = 10'000;
constexpr std::int64_t kLongestWaitUs = 1'000'000;
constexpr std::int64_t kReconnectUs = 1'000'000;

template <typename Clock>
std::int64_t NowUs() {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch())
      .count();
}

int OpenSignalFd() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGCHLD, SIGWINCH}) {
    sigaddset(&signals, signal);
  }
  // Blocked before LCM starts its thread, so that no thread takes them but ours.
  if (pthread_sigmask(SIG_BLOCK, &signals, nullptr) != 0) {
    throw std::runtime_error("cannot block signals");
  }
  const int fd = signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK);
  if (fd < 0) throw std::runtime_error(std::string("signalfd: ") + std::strerror(errno));
  return fd;
}

bool AsksToEnd(std::uint32_t signal) {
  return signal != SIGCHLD && signal != SIGWINCH;
}

}  // namespace

LiveRuntime::LiveRuntime(const BusesConfig& buses,
                         std::string channel_prefix,
                         MissingNetwork missing_network)
    : buses_(buses), channel_prefix_(std::move(channel_prefix)), signal_fd_(OpenSignalFd()) {
  connections_.push_back(std::make_unique<LcmConnection>(buses.local, missing_network));
  if (buses.shared.url != buses.local.url) {
    connections_.push_back(std::make_unique<LcmConnection>(buses.shared, missing_network));
  }
  if (missing_network == MissingNetwork::kWait) {
    if (!IsConnected()) LogWarning("no network yet: " + connections_.back()->problem());
    Every(kReconnectUs, [this] { KeepConnected(); });
  }
}

LiveRuntime::~LiveRuntime() {
  close(signal_fd_);
}

LcmConnection& LiveRuntime::ConnectionOf(messages::BusId bus) const {
  return bus == messages::BusId::kLocal ? *connections_.front() : *connections_.back();
}

void LiveRuntime::Run() {
  std::vector<bool> readable(connections_.size());
  while (!stop_) {
    const std::vector<int> ready = WaitForEvents(readable);
    // What has arrived comes before what is due: a process that did not get the processor for a
    // while must not judge its input as missing before it has looked.
    const std::int64_t until_us = MonotonicUs() + kTimersWaitUs;
    for (std::size_t i = 0; i < connections_.size(); ++i) {
      for (int n = 0; n < kMessagesInARow && readable[i] && !stop_; ++n) {
        if (!connections_[i]->HandleOne() || MonotonicUs() >= until_us) break;
      }
    }
    HandleDescriptors(ready);
    RunDueTimers();
  }
}

void LiveRuntime::RunFor(std::int64_t duration_us) {
  // Cancelled also when an exception leaves: it must not end a later Run().
  struct StopTimer {
    LiveRuntime& runtime;
    TimerId id;
    ~StopTimer() { runtime.Cancel(id); }
  };
  stop_ = false;
  const StopTimer timer{*this, After(duration_us, [this] { Stop(); })};
  Run();
}

std::vector<int> LiveRuntime::WaitForEvents(std::vector<bool>& readable) {
  const std::int64_t due_us = timers_.NextDue().value_or(std::numeric_limits<std::int64_t>::max());
  const std::int64_t wait_us = std::clamp<std::int64_t>(due_us - MonotonicUs(), 0, kLongestWaitUs);
  const timespec timeout{wait_us / 1'000'000, (wait_us % 1'000'000) * 1000};
  std::vector<pollfd> events{{signal_fd_, POLLIN, 0}};
  for (const auto& connection : connections_) {
    events.push_back({connection->file_descriptor(), POLLIN, 0});  // -1 is ignored by poll.
  }
  const std::size_t first_watched = events.size();
  for (const auto& [fd, handler] : watched_) events.push_back({fd, POLLIN, 0});
  const int count = ppoll(events.data(), events.size(), &timeout, nullptr);
  if (count < 0 && errno != EINTR) {
    throw std::runtime_error(std::string("ppoll: ") + std::strerror(errno));
  }
  if (count <= 0) {
    readable.assign(readable.size(), false);
    return {};
  }
  for (std::size_t i = 0; i < readable.size(); ++i) {
    readable[i] = (events[i + 1].revents & POLLIN) != 0;
  }
  if (events[0].revents != 0) TakeSignals();
  std::vector<int> ready;
  for (std::size_t i = first_watched; i < events.size(); ++i) {
    if (events[i].revents != 0) ready.push_back(events[i].fd);
  }
  return ready;
}

// All are taken off the queue, so that a later RunFor() is not ended by the same signal.
void LiveRuntime::TakeSignals() {
  signalfd_siginfo signal{};
  while (read(signal_fd_, &signal, sizeof(signal)) == sizeof(signal)) {
    if (on_signal_) {
      on_signal_(static_cast<int>(signal.ssi_signo));
    } else if (AsksToEnd(signal.ssi_signo)) {
      stop_ = true;
    }
  }
}

void LiveRuntime::HandleDescriptors(const std::vector<int>& ready) {
  for (const int fd : ready) {
    const auto found = watched_.find(fd);
    if (found == watched_.end() || stop_) continue;       // Unwatched by a handler before it.
    const std::function<void()> handler = found->second;  // It may unwatch itself.
    handler();
  }
}

void LiveRuntime::WatchDescriptor(int fd, std::function<void()> handler) {
  watched_[fd] = std::move(handler);
}

bool LiveRuntime::IsConnected() const {
  return std::all_of(connections_.begin(), connections_.end(), [](const auto& connection) {
    return connection->is_open();
  });
}

void LiveRuntime::KeepConnected() {
  for (const auto& connection : connections_) {
    if (connection->KeepOpen()) LogInfo("the network is there: " + connection->url());
  }
}

void LiveRuntime::RunDueTimers() {
  const std::int64_t now_us = MonotonicUs();
  while (!stop_ && timers_.RunOne(now_us)) {
  }
}

std::int64_t LiveRuntime::MonotonicUs() const {
  return NowUs<std::chrono::steady_clock>();
}

std::int64_t LiveRuntime::UtimeNow() const {
  return NowUs<std::chrono::system_clock>();
}

std::int64_t LiveRuntime::NewSession() {
  std::random_device random;
  return std::uniform_int_distribution<std::int64_t>(
      1, std::numeric_limits<std::int64_t>::max())(random);
}

std::string LiveRuntime::HostName() const {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

int LiveRuntime::ProcessId() const {
  return getpid();
}

void LiveRuntime::Publish(messages::BusId bus,
                          const std::string& channel,
                          std::span<const std::byte> bytes) {
  const bool sent = ConnectionOf(bus).Publish(channel_prefix_ + channel, bytes);
  if (!sent) ++send_failures_;
  if (sent == last_send_failed_) {
    LogWarning(sent ? "sending works again" : "cannot send " + channel + ": is the network gone?");
  }
  last_send_failed_ = !sent;
}

void LiveRuntime::Subscribe(messages::BusId bus, const std::string& channel, BytesHandler handler) {
  ConnectionOf(bus).Subscribe(channel_prefix_ + channel, std::move(handler));
}

Runtime::TimerId LiveRuntime::Every(std::int64_t period_us, std::function<void()> callback) {
  if (period_us <= 0) throw std::invalid_argument("Runtime::Every: period must be positive");
  return timers_.Add(MonotonicUs() + period_us, period_us, std::move(callback));
}

Runtime::TimerId LiveRuntime::After(std::int64_t delay_us, std::function<void()> callback) {
  return timers_.Add(MonotonicUs() + std::max<std::int64_t>(delay_us, 0), 0, std::move(callback));
}

std::size_t LiveRuntime::MaxMessageBytes(messages::BusId bus) const {
  const BusConfig& config = bus == messages::BusId::kLocal ? buses_.local : buses_.shared;
  return static_cast<std::size_t>(config.max_message_bytes);
}

std::int64_t LiveRuntime::BurstIntervalUs(messages::BusId bus) const {
  return bus == messages::BusId::kLocal ? buses_.local.burst_interval_us
                                        : buses_.shared.burst_interval_us;
}

std::int64_t LiveRuntime::ReceiveBufferBytes() const {
  std::int64_t least = -1;
  for (const auto& connection : connections_) {
    const std::int64_t bytes = connection->ReceiveBufferBytes();
    if (bytes >= 0 && (least < 0 || bytes < least)) least = bytes;
  }
  return least;
}

}  // namespace clearway::process
