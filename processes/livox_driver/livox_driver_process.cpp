// SPDX-License-Identifier: BSD-3-Clause
#include "processes/livox_driver/livox_driver_process.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "common/process/log.hpp"

namespace clearway {
namespace {

using core::Ipv4;
using core::livox::Broadcast;
using core::livox::CommandCode;
using core::livox::DeviceType;
using core::livox::LinkEvent;
using core::livox::LinkState;

constexpr std::int64_t kTick_us = 5'000;
constexpr std::size_t kMaxHeard = 32;  // Announcers beyond that are not remembered.

core::livox::Extrinsic ExtrinsicOf(const core::SensorConfig& sensor) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const auto deg = [](double rad) { return static_cast<float>(rad * kDegrees); };
  const auto mm = [](double m) { return static_cast<std::int32_t>(std::lround(m * 1000.0)); };
  return {.roll_deg = deg(sensor.roll_rad),
          .pitch_deg = deg(sensor.pitch_rad),
          .yaw_deg = deg(sensor.yaw_rad),
          .x_mm = mm(sensor.x_m),
          .y_mm = mm(sensor.y_m),
          .z_mm = mm(sensor.z_m)};
}

core::livox::LinkConfig LinkConfigOf(const core::livox::DriverConfig& driver,
                                     const core::livox::LidarConfig& lidar,
                                     const core::SensorConfig& sensor) {
  return {.command_port = static_cast<std::uint16_t>(driver.command_port),
          .data_port = static_cast<std::uint16_t>(driver.data_port),
          .imu_port = static_cast<std::uint16_t>(driver.imu_port),
          .heartbeat_us = driver.heartbeat_us,
          .answer_timeout_us = driver.answer_timeout_us,
          .lost_after_us = driver.lost_after_us,
          .return_mode = lidar.return_mode,
          .coordinates = lidar.coordinates,
          .extrinsic = ExtrinsicOf(sensor),
          .write_extrinsic = lidar.write_extrinsic};
}

}  // namespace

void CheckSensors(const core::livox::DriverConfig& config, const core::VehicleConfig& vehicle) {
  for (const core::livox::LidarConfig& lidar : config.lidars) {
    if (vehicle.FindSensor(lidar.sensor)) continue;
    std::string known;
    for (const core::SensorConfig& sensor : vehicle.sensors) {
      known += (known.empty() ? "\"" : ", \"") + sensor.name + '"';
    }
    throw std::runtime_error("livox_driver.lidar: sensor=\"" + lidar.sensor +
                             "\" is none of the vehicle's sensors: " + known);
  }
}

LivoxDriverProcess::LivoxDriverProcess(const core::livox::DriverConfig& config,
                                       const core::VehicleConfig& vehicle,
                                       process::Node& node,
                                       net::Network& network)
    : config_(config), node_(node), network_(network), started_us_(NowUs()) {
  CheckSensors(config, vehicle);
  for (const core::livox::LidarConfig& lidar : config_.lidars) {
    const auto sensor = static_cast<std::size_t>(*vehicle.FindSensor(lidar.sensor));
    lidars_.push_back(std::make_unique<Lidar>(
        lidar, LinkConfigOf(config_, lidar, vehicle.sensors[sensor]), config_, node_));
  }
  const auto open = [&](int port, int buffer_bytes, auto handler) {
    return network_.Open({.bind = {core::kAnyIpv4, static_cast<std::uint16_t>(port)},
                          .receive_buffer_bytes = buffer_bytes},
                         [this, handler](auto datagrams) { (this->*handler)(datagrams); });
  };
  broadcast_socket_ = open(config_.broadcast_port, 0, &LivoxDriverProcess::OnBroadcasts);
  command_socket_ = open(config_.command_port, 0, &LivoxDriverProcess::OnCommands);
  data_socket_ = open(config_.data_port, config_.receive_buffer_bytes, &LivoxDriverProcess::OnData);
  const int granted = data_socket_->receive_buffer_bytes();
  if (granted >= 0 && granted < config_.receive_buffer_bytes) {
    process::LogWarning("the kernel gives " + std::to_string(granted) + " of " +
                        std::to_string(config_.receive_buffer_bytes) +
                        " bytes of receive buffer: raise net.core.rmem_max");
  }
  timer_ = node_.runtime().Every(kTick_us, [this] { Tick(); });
  node_.BeforeStatus([this] { Refresh(); });
  Tick();
  Refresh();
}

LivoxDriverProcess::~LivoxDriverProcess() {
  node_.runtime().Cancel(timer_);
  node_.BeforeStatus({});
  for (const auto& lidar : lidars_) {
    lidar->link.Close();
    Flush(*lidar);
  }
}

void LivoxDriverProcess::OnBroadcasts(std::span<const net::Datagram> datagrams) {
  for (const net::Datagram& datagram : datagrams) {
    const core::livox::ParsedFrame parsed = core::livox::ParseFrame(datagram.bytes);
    ++frame_defects_[static_cast<std::size_t>(parsed.defect)];
    if (!parsed.frame) continue;
    const bool is_broadcast = parsed.frame->type == core::livox::FrameType::kMessage &&
                              core::livox::CodeOf(*parsed.frame) == CommandCode::kBroadcast;
    const auto body = is_broadcast ? core::livox::ParseBroadcast(parsed.frame->data) : std::nullopt;
    if (body) {
      OnBroadcast(datagram.from, *body);
    } else {
      ++foreign_frames_;
    }
  }
}

void LivoxDriverProcess::OnBroadcast(const core::Endpoint& from, const Broadcast& body) {
  const auto known = heard_.find(body.broadcast_code);
  if (known == heard_.end() && heard_.size() >= kMaxHeard) return;
  Heard& heard = heard_[body.broadcast_code];
  if (known == heard_.end()) {
    process::LogInfo("heard a " + std::string(core::livox::DeviceName(body.type)) + ", " +
                     body.broadcast_code + " at " + core::ToString(from.ip));
  }
  heard = {.type = body.type, .ip = from.ip, .last_us = NowUs()};
  const std::size_t index = LidarFor(body, from.ip);
  if (index == lidars_.size()) return;
  Lidar& lidar = *lidars_[index];
  const std::optional<Ipv4> host_ip = HostFor(from.ip, lidar.subnet_problem);
  if (!host_ip) return;
  lidar.link.OnBroadcast(from, *host_ip, NowUs());
  Flush(lidar);
}

// Which lidar of the configuration this is; their number when it is none.
std::size_t LivoxDriverProcess::LidarFor(const Broadcast& body, Ipv4 ip) const {
  const auto find = [this](const auto& is_it) {
    const auto found = std::find_if(
        lidars_.begin(), lidars_.end(), [&](const auto& lidar) { return is_it(lidar->config); });
    return static_cast<std::size_t>(found - lidars_.begin());
  };
  using core::livox::LidarConfig;
  std::size_t index =
      find([&](const LidarConfig& lidar) { return lidar.broadcast_code == body.broadcast_code; });
  if (index < lidars_.size()) return index;
  index = find([&](const LidarConfig& lidar) {
    return lidar.broadcast_code.empty() && !lidar.ip.empty() && core::ParseIpv4(lidar.ip) == ip;
  });
  if (index < lidars_.size()) return index;
  if (body.type != DeviceType::kMid70 || !IsOnlyUnclaimed(body.broadcast_code)) {
    return lidars_.size();
  }
  return find(
      [](const LidarConfig& lidar) { return lidar.broadcast_code.empty() && lidar.ip.empty(); });
}

bool LivoxDriverProcess::IsClaimed(const std::string& code, const Heard& heard) const {
  return std::any_of(lidars_.begin(), lidars_.end(), [&](const auto& lidar) {
    const core::livox::LidarConfig& config = lidar->config;
    if (!config.broadcast_code.empty()) return config.broadcast_code == code;
    return !config.ip.empty() && core::ParseIpv4(config.ip) == heard.ip;
  });
}

// True when no other MID-70 that is heard could be meant as well.
bool LivoxDriverProcess::IsOnlyUnclaimed(const std::string& code) const {
  return std::none_of(heard_.begin(), heard_.end(), [&](const auto& entry) {
    return entry.first != code && entry.second.type == DeviceType::kMid70 &&
           NowUs() - entry.second.last_us < config_.lost_after_us &&
           !IsClaimed(entry.first, entry.second);
  });
}

std::optional<Ipv4> LivoxDriverProcess::HostFor(Ipv4 sensor, std::string& problem) const {
  problem.clear();
  if (!config_.host_ip.empty()) return core::ParseIpv4(config_.host_ip);
  const std::vector<net::Interface> interfaces = network_.Interfaces();
  const net::Interface* best = nullptr;
  std::string own;
  for (const net::Interface& interface : interfaces) {
    own += (own.empty() ? "" : ", ") + core::ToString(interface.ip) + " (" + interface.name + ')';
    if (interface.Reaches(sensor) && (best == nullptr || interface.mask > best->mask)) {
      best = &interface;
    }
  }
  if (best != nullptr) return best->ip;
  problem = core::ToString(sensor) + " is in another subnet than this host, which has " + own +
            ": give this host an address there, or set livox_driver.host_ip";
  return std::nullopt;
}

void LivoxDriverProcess::OnCommands(std::span<const net::Datagram> datagrams) {
  for (const net::Datagram& datagram : datagrams) {
    const auto found = std::find_if(lidars_.begin(), lidars_.end(), [&](const auto& lidar) {
      const auto address = lidar->link.address();
      return address && address->ip == datagram.from.ip;
    });
    if (found == lidars_.end()) {
      ++foreign_frames_;
      continue;
    }
    const core::livox::ParsedFrame parsed = core::livox::ParseFrame(datagram.bytes);
    ++frame_defects_[static_cast<std::size_t>(parsed.defect)];
    if (!parsed.frame) continue;
    (*found)->link.OnFrame(*parsed.frame, NowUs());
    Flush(**found);
  }
}

void LivoxDriverProcess::OnData(std::span<const net::Datagram> datagrams) {
  for (const net::Datagram& datagram : datagrams) {
    std::size_t index = 0;
    while (index < lidars_.size() && !(lidars_[index]->link.accepts_data() &&
                                       lidars_[index]->link.address()->ip == datagram.from.ip)) {
      ++index;
    }
    if (index == lidars_.size()) {
      ++foreign_packets_;
      continue;
    }
    Lidar& lidar = *lidars_[index];
    const auto status_code = lidar.output.OnPacket(datagram.bytes, datagram.arrival_utime);
    if (!status_code) continue;
    lidar.link.OnData(*status_code, NowUs());
    if (tap_) tap_(index, datagram);
  }
  const std::int64_t now_utime = node_.runtime().UtimeNow();
  for (const auto& lidar : lidars_) lidar->output.PublishDue(now_utime);
}

void LivoxDriverProcess::OfferKnownAddress(Lidar& lidar) {
  const std::optional<Ipv4> ip = core::ParseIpv4(lidar.config.ip);
  if (!ip || lidar.link.state() != LinkState::kSearching) return;
  const std::optional<Ipv4> host_ip = HostFor(*ip, lidar.subnet_problem);
  if (host_ip) lidar.link.Offer({*ip, core::livox::kDevicePort}, *host_ip, NowUs());
}

void LivoxDriverProcess::Tick() {
  const std::int64_t now_utime = node_.runtime().UtimeNow();
  for (const auto& lidar : lidars_) {
    OfferKnownAddress(*lidar);
    lidar->link.Advance(NowUs());
    Flush(*lidar);
    lidar->output.PublishDue(now_utime);
  }
}

// Sends what the link has to say to its sensor, and tells what happened.
void LivoxDriverProcess::Flush(Lidar& lidar) {
  for (const core::livox::OutgoingFrame& frame : lidar.link.TakeOutgoing()) {
    command_socket_->Send(frame.to, frame.bytes);
  }
  const std::vector<LinkEvent> events = lidar.link.TakeEvents();
  for (const LinkEvent& event : events) {
    const bool is_trouble = event.kind == LinkEvent::Kind::kLost ||
                            event.kind == LinkEvent::Kind::kRestarted ||
                            event.kind == LinkEvent::Kind::kRefused;
    const std::string line = lidar.config.sensor + ": " + event.text;
    is_trouble ? process::LogWarning(line) : process::LogInfo(line);
    if (event.kind == LinkEvent::Kind::kConnected) lidar.output.Restart();
  }
  if (!events.empty() && lidar.link.state() != LinkState::kClosed) Refresh();
}

}  // namespace clearway
