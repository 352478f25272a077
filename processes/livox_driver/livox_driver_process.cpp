// SPDX-License-Identifier: BSD-3-Clause
#include "processes/livox_driver/livox_driver_process.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "common/process/log.hpp"
#include "processes/livox_driver/answer_address.hpp"

namespace clearway {
namespace {

using core::Ipv4;
using core::livox::Broadcast;
using core::livox::CommandCode;
using core::livox::LinkEvent;
using core::livox::LinkState;

constexpr std::int64_t kTick_us = 5'000;
// How often this host's own addresses are looked at.
constexpr std::int64_t kRenew_us = 1'000'000;

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
    : config_(config), node_(node), network_(network), heard_(config.lidars), started_us_(NowUs()) {
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
  const HeardSensors::Verdict verdict = heard_.Hear(body, from, NowUs());
  if (verdict.is_new) {
    process::LogInfo("heard a " + std::string(core::livox::DeviceName(body.type)) + ", " +
                     body.broadcast_code + " at " + core::ToString(from.ip));
  }
  if (verdict.lidar) Approach(*lidars_[*verdict.lidar], from);
}

std::vector<net::Interface> LivoxDriverProcess::OwnInterfaces() const {
  try {
    return network_.Interfaces();
  } catch (const net::NetworkError& error) {
    // Once running, nothing ends a driver; the problem shows as "no address".
    process::LogWarning(error.what());
    return {};
  }
}

// The sensor has announced itself from there.
void LivoxDriverProcess::Approach(Lidar& lidar, const core::Endpoint& sensor) {
  const AnswerAddress answer = AnswerAddressFor(sensor.ip, config_.host_ip, OwnInterfaces());
  lidar.address_problem = answer.problem;
  if (!answer.ip) return;
  lidar.link.OnBroadcast(sensor, *answer.ip, NowUs());
  Flush(lidar);
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
  // By the arrival of the newest, not by the clock: after a while without the processor more
  // packets wait in the socket, and no slice may be judged before they are seen.
  for (const auto& lidar : lidars_) lidar->output.PublishDue(datagrams.back().arrival_utime);
}

// Sensors with a known address are asked without a broadcast, and whoever is asked hears where this
// host is now.
void LivoxDriverProcess::RenewAddresses() {
  const std::vector<net::Interface> interfaces = OwnInterfaces();
  for (const auto& lidar : lidars_) {
    const auto state = lidar->link.state();
    const bool is_asked = state == LinkState::kHandshaking;
    const std::optional<Ipv4> ip =
        is_asked ? lidar->link.address()->ip : core::ParseIpv4(lidar->config.ip);
    if (!ip || (state != LinkState::kSearching && !is_asked)) continue;
    const AnswerAddress answer = AnswerAddressFor(*ip, config_.host_ip, interfaces);
    lidar->address_problem = answer.problem;
    if (answer.ip) lidar->link.Offer({*ip, core::livox::kDevicePort}, *answer.ip, NowUs());
  }
}

void LivoxDriverProcess::Tick() {
  if (addresses_renewed_us_ == 0 || NowUs() - addresses_renewed_us_ >= kRenew_us) {
    addresses_renewed_us_ = NowUs();
    RenewAddresses();
  }
  if (const auto choice = heard_.Choose(NowUs())) Approach(*lidars_[choice->lidar], choice->from);
  const std::int64_t now_utime = node_.runtime().UtimeNow();
  for (const auto& lidar : lidars_) {
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
