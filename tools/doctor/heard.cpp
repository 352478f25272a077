// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/heard.hpp"

#include <algorithm>
#include <tuple>

#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"

namespace clearway::doctor {
namespace {

namespace channels = messages::channels;

// Of what is kept from a network that anyone may fill.
constexpr std::size_t kMost = 1000;

template <typename Container>
bool IsFull(const Container& container) {
  return container.size() >= kMost;
}

}  // namespace

void Listener::OnMessage(const std::string& channel, std::span<const std::byte> bytes) {
  if (!IsFull(channels_)) channels_.insert(channel);
  // A prefix may stand before each name.
  if (channel.ends_with(channels::kPmInfo.name)) {
    OnInfo(bytes);
  } else if (channel.ends_with(channels::kPmHealth.name)) {
    OnHealth(bytes);
  } else if (channel.ends_with("_STATUS") && !IsFull(processes_)) {
    const auto status = messages::Decode<status_t>(bytes);
    if (!status) return;  // POSE_STATUS is of another type.
    processes_[{channel, status->session}] = {.channel = channel,
                                              .host = status->host,
                                              .pid = status->pid,
                                              .version = status->version,
                                              .config_digest = status->config_digest};
  }
}

void Listener::OnInfo(std::span<const std::byte> bytes) {
  const auto message = messages::Decode<procman_lcm::deputy_info_t>(bytes);
  if (!message || IsFull(deputies_)) return;
  HeardDeputy& deputy = deputies_[message->deputy_id];
  deputy.id = message->deputy_id;
  for (const auto& command : messages::FromLcm(*message).commands) {
    if (command.pid > 0) deputy.pids.insert(command.pid);
  }
}

void Listener::OnHealth(std::span<const std::byte> bytes) {
  const auto slice = messages::Decode<deputy_health_t>(bytes);
  if (!slice || IsFull(assemblers_)) return;
  const auto whole = assemblers_[slice->deputy_id].Add(*slice);
  if (!whole) return;
  HeardDeputy& deputy = deputies_[whole->deputy_id];
  deputy.id = whole->deputy_id;
  deputy.is_ours = true;
  deputy.host = whole->host;
  deputy.version = whole->version;
  deputy.config_digest = whole->config_digest;
  deputy.problem = whole->text;
}

Heard Listener::Result() const {
  Heard heard;
  heard.channels = channels_;
  for (const auto& [key, process] : processes_) heard.processes.push_back(process);
  std::sort(heard.processes.begin(),
            heard.processes.end(),
            [](const HeardProcess& a, const HeardProcess& b) {
              return std::tie(a.channel, a.host, a.pid) < std::tie(b.channel, b.host, b.pid);
            });
  for (const auto& [id, deputy] : deputies_) heard.deputies.push_back(deputy);
  return heard;
}

}  // namespace clearway::doctor
