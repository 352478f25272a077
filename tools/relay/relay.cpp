// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/relay.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <optional>
#include <poll.h>
#include <stdexcept>
#include <sys/prctl.h>
#include <unistd.h>

#include "tools/relay/report.hpp"

namespace clearway::relay {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr int kFramesPerTurn = 64;  // Of one port, before the others have theirs.
constexpr std::size_t kMaxLineBytes = 4096;

volatile std::sig_atomic_t stop_asked = 0;

std::int64_t Now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * kSecond_ns + time.tv_nsec;
}

// Blocked but while it waits, so that none comes between looking and waiting.
void SetUpSignals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = 1; };
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM}) {
    sigaction(signal, &action, nullptr);
    sigaddset(&signals, signal);
  }
  sigprocmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);  // Nobody may be there to read the answers.
}

std::vector<std::string> NamesOf(const std::vector<RelayPort>& ports) {
  std::vector<std::string> names;
  for (const RelayPort& port : ports) names.push_back(port.name);
  return names;
}

}  // namespace

Relay::Relay(const RelaySettings& settings)
    : until_eof_(settings.until_eof),
      interval_start_ns_(Now()),
      buffer_(PacketSocket::kMaxPacketBytes),
      hub_(NamesOf(settings.ports),
           {.seed = settings.seed,
            .max_delayed_bytes = settings.max_delayed_bytes,
            .packet_header_bytes = PacketSocket::kHeaderBytes},
           [this](std::size_t port, std::span<const std::byte> packet) {
             return sockets_[port]->Send(packet);
           }) {
  for (const std::string& line : settings.commands) hub_.Follow(ParseCommand(line));
  for (const RelayPort& port : settings.ports) {
    sockets_.push_back(std::make_unique<PacketSocket>(port.interface_name));
  }
}

void Relay::Run() {
  SetUpSignals();
  prctl(PR_SET_TIMERSLACK, 1000);  // [ns] Delays are kept to a few microseconds.
  std::puts("ready");
  std::fflush(stdout);
  while (!is_done_ && stop_asked == 0) WaitForEvents();
}

void Relay::WaitForEvents() {
  std::vector<pollfd> waiting;
  for (const auto& socket : sockets_) waiting.push_back({socket->file_descriptor(), POLLIN, 0});
  waiting.push_back({is_input_open_ ? STDIN_FILENO : -1, POLLIN, 0});
  timespec timeout{};
  const auto due_ns = hub_.next_due_ns();
  if (due_ns) {
    const std::int64_t left_ns = std::max<std::int64_t>(0, *due_ns - Now());
    timeout = {.tv_sec = left_ns / kSecond_ns, .tv_nsec = left_ns % kSecond_ns};
  }
  sigset_t none;
  sigemptyset(&none);
  if (ppoll(waiting.data(), waiting.size(), due_ns ? &timeout : nullptr, &none) < 0) {
    if (errno == EINTR) return;
    throw std::runtime_error(std::string("ppoll: ") + std::strerror(errno));
  }
  hub_.SendDue(Now());
  for (std::size_t port = 0; port < sockets_.size(); ++port) {
    if (waiting[port].revents != 0) ReadFrames(port);
  }
  if (waiting.back().revents != 0) ReadCommands();
}

void Relay::ReadFrames(std::size_t port) {
  for (int i = 0; i < kFramesPerTurn; ++i) {
    const auto packet = sockets_[port]->Receive(buffer_);
    if (!packet) return;
    hub_.OnPacket(port, *packet, Now());
  }
}

void Relay::ReadCommands() {
  std::array<char, kMaxLineBytes> bytes{};
  const ssize_t length = read(STDIN_FILENO, bytes.data(), bytes.size());
  if (length < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (length <= 0) {
    is_input_open_ = false;
    is_done_ = until_eof_;
    return;
  }
  input_.append(bytes.data(), static_cast<std::size_t>(length));
  for (std::size_t end = 0; !is_done_ && (end = input_.find('\n')) != std::string::npos;) {
    const std::string line = input_.substr(0, end);
    input_.erase(0, end + 1);
    Answer(line);
  }
  if (input_.size() > kMaxLineBytes) input_.clear();  // No command is that long.
}

void Relay::Answer(const std::string& line) {
  try {
    Follow(line);
    std::puts("ok");
  } catch (const CommandError& error) {
    std::fprintf(stderr, "clearway-relay: %s\n", error.what());
    std::puts("refused");
  }
  std::fflush(stdout);
}

void Relay::Follow(const std::string& line) {
  const Command command = ParseCommand(line);
  switch (command.verb) {
    case Command::Verb::kStatistics:
      PrintStatistics();
      return;
    case Command::Verb::kQuit:
      is_done_ = true;
      return;
    default:
      hub_.Follow(command);
  }
}

void Relay::PrintStatistics() {
  std::vector<std::uint64_t> drops;
  for (const auto& socket : sockets_) drops.push_back(socket->KernelDrops());
  const std::int64_t now_ns = Now();
  const double interval_s = static_cast<double>(now_ns - interval_start_ns_) * 1e-9;
  std::puts(FormatStatistics(hub_, drops, interval_s).c_str());
  interval_start_ns_ = now_ns;
  hub_.StartInterval();
}

}  // namespace clearway::relay
