// SPDX-License-Identifier: BSD-3-Clause
// A participant of an LCM bus that a test holds by its standard input and output.
//   lcm_probe URL
// `send CHANNEL COUNT BYTES INTERVAL_US` on stdin is answered by `sent CHANNEL COUNT`; every
// message on PROBE_... that comes in gives `got CHANNEL SEQUENCE BYTES LATENCY_US good|damaged`.
// The clock is the machine's monotonic one, which all network namespaces share.
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <map>
#include <memory>
#include <poll.h>
#include <sstream>
#include <string>
#include <unistd.h>
#include <vector>

#include <lcm/lcm.h>

namespace clearway::test {
namespace {

struct Head {
  std::int64_t sent_ns = 0;
  std::uint64_t sequence = 0;
};

std::int64_t Now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * std::int64_t{1'000'000'000} + time.tv_nsec;
}

std::uint8_t PatternAt(std::size_t i, std::uint64_t sequence) {
  return static_cast<std::uint8_t>(i * 31 + sequence);
}

void OnMessage(const lcm_recv_buf_t* message, const char* channel, void* /*user*/) {
  const std::int64_t now_ns = Now();
  Head head;
  bool is_good = message->data_size >= sizeof(head);
  if (is_good) std::memcpy(&head, message->data, sizeof(head));
  const auto* const bytes = static_cast<const std::uint8_t*>(message->data);
  for (std::size_t i = sizeof(head); i < message->data_size; ++i) {
    is_good = is_good && bytes[i] == PatternAt(i, head.sequence);
  }
  std::printf("got %s %llu %u %.1f %s\n",
              channel,
              static_cast<unsigned long long>(head.sequence),
              message->data_size,
              static_cast<double>(now_ns - head.sent_ns) * 1e-3,
              is_good ? "good" : "damaged");
}

class Probe {
 public:
  explicit Probe(const char* url) : lcm_(lcm_create(url), lcm_destroy) {
    if (!lcm_) return;
    lcm_subscription_t* const subscription =
        lcm_subscribe(lcm_.get(), "PROBE_.*", &OnMessage, nullptr);
    lcm_subscription_set_queue_capacity(subscription, 0);
  }

  [[nodiscard]] bool is_open() const { return lcm_ != nullptr; }

  void Run() {
    std::array<pollfd, 2> waiting{pollfd{lcm_get_fileno(lcm_.get()), POLLIN, 0},
                                  pollfd{STDIN_FILENO, POLLIN, 0}};
    Print("ready");
    while (poll(waiting.data(), waiting.size(), -1) > 0) {
      if (waiting[0].revents != 0) lcm_handle(lcm_.get());
      if (waiting[1].revents != 0 && !ReadCommands()) return;
      std::fflush(stdout);
    }
  }

 private:
  static void Print(const std::string& line) {
    std::puts(line.c_str());
    std::fflush(stdout);
  }

  // False at the end.
  bool ReadCommands() {
    std::array<char, 4096> bytes{};
    const ssize_t length = read(STDIN_FILENO, bytes.data(), bytes.size());
    if (length <= 0) return false;
    input_.append(bytes.data(), static_cast<std::size_t>(length));
    for (std::size_t end = 0; (end = input_.find('\n')) != std::string::npos;) {
      Send(input_.substr(0, end));
      input_.erase(0, end + 1);
    }
    return true;
  }

  void Send(const std::string& line) {
    std::istringstream words(line);
    std::string verb;
    std::string channel;
    std::uint64_t count = 0;
    std::size_t bytes = 0;
    std::int64_t interval_us = 0;
    words >> verb >> channel >> count >> bytes >> interval_us;
    if (!words || verb != "send" || bytes < sizeof(Head)) return Print("refused " + line);
    std::vector<std::uint8_t> message(bytes);
    const std::int64_t start_ns = Now();
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::int64_t due_ns = start_ns + static_cast<std::int64_t>(i) * interval_us * 1000;
      const timespec due{due_ns / 1'000'000'000, due_ns % 1'000'000'000};
      if (interval_us > 0) clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr);
      Publish(channel, message);
    }
    Print("sent " + channel + ' ' + std::to_string(count));
  }

  void Publish(const std::string& channel, std::vector<std::uint8_t>& message) {
    Head head{.sent_ns = 0, .sequence = sequences_[channel]++};
    for (std::size_t i = sizeof(head); i < message.size(); ++i) {
      message[i] = PatternAt(i, head.sequence);
    }
    head.sent_ns = Now();
    std::memcpy(message.data(), &head, sizeof(head));
    lcm_publish(lcm_.get(), channel.c_str(), message.data(), static_cast<unsigned>(message.size()));
  }

  std::unique_ptr<lcm_t, decltype(&lcm_destroy)> lcm_;
  std::string input_;
  std::map<std::string, std::uint64_t> sequences_;
};

}  // namespace
}  // namespace clearway::test

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: lcm_probe URL\n", stderr);
    return 64;
  }
  clearway::test::Probe probe(argv[1]);
  if (!probe.is_open()) return 70;
  probe.Run();
  return 0;
}
