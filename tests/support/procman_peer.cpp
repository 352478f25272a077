// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/procman_peer.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"

namespace clearway::test {
namespace {

namespace channels = messages::channels;

constexpr std::int64_t kStep_us = 5'000;

}  // namespace

ProcmanPeer::ProcmanPeer(const std::string& url, std::string sheriff_id)
    : sheriff_id_(std::move(sheriff_id)), lcm_(url) {
  if (!lcm_.good()) throw std::runtime_error("cannot open LCM at " + url);
  lcm_.subscribe("PM_.*", &ProcmanPeer::OnMessage, this)->setQueueCapacity(0);
}

std::int64_t ProcmanPeer::NowUs() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

void ProcmanPeer::Send(const std::string& channel, const std::vector<std::byte>& bytes) {
  lcm_.publish(channel, bytes.data(), static_cast<unsigned>(bytes.size()));
}

void ProcmanPeer::Order(const std::string& deputy,
                        const std::vector<core::procman::DesiredCommand>& commands) {
  last_utime_ = std::max(last_utime_ + 1, NowUs() + clock_off_us);
  Send(channels::kPmOrders.name,
       messages::Encode(messages::ToLcm(core::procman::Orders{.utime = last_utime_,
                                                              .deputy_id = deputy,
                                                              .sheriff_id = sheriff_id_,
                                                              .commands = commands})));
}

void ProcmanPeer::Discover(const std::string& transmitter_id, std::int64_t nonce) {
  procman_lcm::discovery_t message;
  message.utime = NowUs();
  message.transmitter_id = transmitter_id;
  message.nonce = nonce;
  Send(channels::kPmDiscover.name, messages::Encode(message));
}

bool ProcmanPeer::Await(const std::function<bool()>& done, std::int64_t timeout_us) {
  const std::int64_t deadline_us = NowUs() + timeout_us;
  while (!done()) {
    const std::int64_t left_us = deadline_us - NowUs();
    if (left_us <= 0) return false;
    lcm_.handleTimeout(static_cast<int>(std::min(left_us, kStep_us) / 1000 + 1));
  }
  return true;
}

bool ProcmanPeer::AwaitDeputy(const std::string& deputy) {
  return Await([&] { return reports.contains(deputy); });
}

bool ProcmanPeer::AwaitRunning(const std::string& deputy,
                               const std::string& id,
                               std::int32_t run_id) {
  return Await(
      [&] { return Command(deputy, id).pid != 0 && Command(deputy, id).run_id == run_id; });
}

bool ProcmanPeer::AwaitStopped(const std::string& deputy, const std::string& id) {
  return Await([&] { return reports.contains(deputy) && Command(deputy, id).pid == 0; });
}

bool ProcmanPeer::AwaitState(const std::string& deputy,
                             const std::string& id,
                             core::procman::CommandState state) {
  return Await([&] {
    const auto report = HealthOf(deputy, id);
    return report.id == id && report.state == state;
  });
}

core::procman::CommandReport ProcmanPeer::Command(const std::string& deputy,
                                                  const std::string& id) const {
  const auto report = reports.find(deputy);
  if (report == reports.end()) return {};
  for (const core::procman::CommandReport& command : report->second.commands) {
    if (command.spec.id == id) return command;
  }
  return {};
}

core::procman::CommandHealthReport ProcmanPeer::HealthOf(const std::string& deputy,
                                                         const std::string& id) const {
  const auto report = health.find(deputy);
  if (report == health.end()) return {};
  for (const core::procman::CommandHealthReport& command : report->second.commands) {
    if (command.id == id) return command;
  }
  return {};
}

void ProcmanPeer::OnMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
  const std::span<const std::byte> bytes{static_cast<const std::byte*>(buffer->data),
                                         std::size_t{buffer->data_size}};
  if (channel == channels::kPmInfo.name) {
    const auto message = messages::Decode<procman_lcm::deputy_info_t>(bytes);
    if (!message) return;
    report_times_us[message->deputy_id].push_back(buffer->recv_utime);
    reports[message->deputy_id] = messages::FromLcm(*message);
  } else if (channel == channels::kPmHealth.name) {
    const auto slice = messages::Decode<deputy_health_t>(bytes);
    if (!slice) return;
    const auto whole = assemblers_[slice->deputy_id].Add(*slice);
    if (whole) health[whole->deputy_id] = *whole;
  } else if (channel == channels::kPmOutput.name) {
    largest_output_bytes = std::max(largest_output_bytes, bytes.size());
    const auto message = messages::Decode<procman_lcm::output_t>(bytes);
    if (!message) return;
    for (std::size_t i = 0; i < message->text.size(); ++i) {
      output[{message->deputy_id, message->command_ids[i]}] += message->text[i];
    }
  } else if (channel == channels::kPmOrders.name) {
    const auto message = messages::Decode<procman_lcm::orders_t>(bytes);
    if (message) orders.push_back(*message);
  } else if (channel == channels::kPmDiscover.name) {
    ++discoveries;
  }
}

core::procman::DesiredCommand Wanted(const std::string& id,
                                     const std::string& exec,
                                     std::int32_t run_id) {
  core::procman::DesiredCommand command;
  command.spec.id = id;
  command.spec.exec = exec;
  command.spec.stop_time_allowed_s = 5.0F;
  command.run_id = run_id;
  return command;
}

core::procman::DesiredCommand Unwanted(core::procman::DesiredCommand command) {
  command.force_quit = true;
  return command;
}

}  // namespace clearway::test
