// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/hub.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace clearway::relay {
namespace {

using Verb = Command::Verb;

// A stream of random numbers for each direction: the traffic of others does not change it.
std::uint64_t SeedOf(std::uint64_t seed, std::size_t from, std::size_t to) {
  constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15;
  return (seed * kOdd + from) * kOdd + to;
}

void Set(FaultSettings& settings, const Command& command) {
  const auto nanoseconds = [](double ms) { return std::llround(ms * 1e6); };
  switch (command.verb) {
    case Verb::kLoss:
      settings.loss = command.value;
      return;
    case Verb::kDuplicate:
      settings.duplicate = command.value;
      return;
    case Verb::kDelay:
      settings.delay_ns = nanoseconds(command.value);
      return;
    case Verb::kJitter:
      settings.jitter_ns = nanoseconds(command.value);
      return;
    case Verb::kCut:
    case Verb::kMend:
    case Verb::kStatistics:
    case Verb::kQuit:
      return;
  }
}

}  // namespace

Hub::Hub(const std::vector<std::string>& port_names, const Settings& settings, Send send)
    : settings_(settings),
      send_(std::move(send)),
      ports_(port_names.size()),
      delayed_(settings.max_delayed_bytes) {
  if (ports_.size() < 2) throw std::invalid_argument("a relay needs two ports at least");
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    if (std::count(port_names.begin(), port_names.end(), port_names[i]) > 1) {
      throw std::invalid_argument("two ports are named " + port_names[i]);
    }
    ports_[i].name = port_names[i];
  }
  for (std::size_t from = 0; from < ports_.size(); ++from) {
    for (std::size_t to = 0; to < ports_.size(); ++to) {
      if (from == to) continue;
      directions_.push_back(
          {.from = from, .to = to, .faults = Faults(SeedOf(settings.seed, from, to))});
    }
  }
}

Hub::Port& Hub::PortOf(const std::string& name) {
  std::string known;
  for (Port& port : ports_) {
    if (port.name == name) return port;
    known += ' ' + port.name;
  }
  throw CommandError("there is no port \"" + name + "\"; there are:" + known);
}

Hub::Direction& Hub::DirectionOf(std::size_t from, std::size_t to) {
  return directions_[from * (ports_.size() - 1) + to - (to > from ? 1 : 0)];
}

void Hub::Follow(const Command& command) {
  if (command.verb == Verb::kCut || command.verb == Verb::kMend) {
    PortOf(command.from).is_cut = command.verb == Verb::kCut;
    return;
  }
  for (const std::string& name : {command.from, command.to}) {
    if (name != "*") (void)PortOf(name);
  }
  if (command.from == command.to && command.from != "*") {
    throw CommandError("nothing goes from " + command.from + " to itself");
  }
  for (Direction& direction : directions_) {
    if ((command.from == "*" || command.from == ports_[direction.from].name) &&
        (command.to == "*" || command.to == ports_[direction.to].name)) {
      Set(direction.faults.settings, command);
    }
  }
}

void Hub::OnPacket(std::size_t from, std::span<const std::byte> packet, std::int64_t now_ns) {
  if (packet.size() < settings_.packet_header_bytes) return;
  SendDue(now_ns);  // First, so that what waits in this direction goes before this packet.
  Port& port = ports_[from];
  const auto frame = packet.subspan(settings_.packet_header_bytes);
  ++port.in_frames;
  port.in_bytes += frame.size();
  port.traffic.Count(frame);
  SharedPacket shared;
  for (std::size_t to = 0; to < ports_.size(); ++to) {
    if (to != from) Forward(DirectionOf(from, to), packet, shared, now_ns);
  }
}

void Hub::Forward(Direction& direction,
                  std::span<const std::byte> packet,
                  SharedPacket& shared,
                  std::int64_t now_ns) {
  const Faults::Verdict verdict = direction.faults.Decide(now_ns);
  if (ports_[direction.from].is_cut || ports_[direction.to].is_cut) {
    ++direction.cut;
    return;
  }
  if (verdict.copies == 0) ++direction.lost;
  if (verdict.copies == 2) ++direction.duplicated;
  for (int copy = 0; copy < verdict.copies; ++copy) {
    if (verdict.due_ns <= now_ns) {
      SendNow(direction, packet);
      continue;
    }
    if (!shared) {
      shared = std::make_shared<const std::vector<std::byte>>(packet.begin(), packet.end());
    }
    if (!delayed_.Push({verdict.due_ns, direction.from, direction.to, shared})) {
      ++direction.overflowed;
    }
  }
}

void Hub::SendNow(Direction& direction, std::span<const std::byte> packet) {
  Port& port = ports_[direction.to];
  if (!send_(direction.to, packet)) {
    ++port.refused;
    return;
  }
  ++direction.delivered;
  ++port.out_frames;
  port.out_bytes += packet.size() - settings_.packet_header_bytes;
}

void Hub::SendDue(std::int64_t now_ns) {
  while (const auto packet = delayed_.PopDue(now_ns)) {
    Direction& direction = DirectionOf(packet->from, packet->to);
    if (ports_[packet->to].is_cut) {
      ++direction.cut;
    } else {
      SendNow(direction, *packet->bytes);
    }
  }
}

void Hub::StartInterval() {
  for (Port& port : ports_) port.traffic.StartInterval();
}

}  // namespace clearway::relay
