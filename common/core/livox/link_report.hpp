// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/core/endpoint.hpp"
#include "common/core/livox/little_endian.hpp"

namespace clearway::core::livox {

/// How far the conversation with a sensor has come.
enum class LinkState : std::uint8_t {
  kSearching,    ///< No address is known.
  kHandshaking,  ///< It is asked for a connection.
  kConfiguring,  ///< Connected; it is asked and told what it needs to know.
  kStarting,     ///< Set up; waited for until it works normally and samples.
  kSampling,     ///< It has agreed to send points.
  kClosed,
};
inline constexpr std::size_t kNumLinkStates = 6;
/// In one word.
[[nodiscard]] const char* LinkStateName(LinkState state);

/// How well a sensor serves.
enum class Health : std::uint8_t {
  kOk,        ///< Points arrive, and nothing is wrong.
  kWaiting,   ///< No points; it takes its time, or nobody is there.
  kDegraded,  ///< Points arrive, but something is wrong.
  kFault,     ///< No points, and none will come until somebody does something.
};

/// How a sensor is, for a user.
struct LinkReport {
  LinkState state = LinkState::kSearching;
  Health health = Health::kWaiting;
  std::string text;  ///< What is, and what can be done about it; without the sensor's name.
};

/// Something worth a line in the log.
struct LinkEvent {
  enum class Kind : std::uint8_t {
    kConnected,
    kSampling,
    kLost,       ///< Heartbeats were not answered.
    kRestarted,  ///< It announced itself although it was connected.
    kMoved,      ///< It has another address.
    kRefused,    ///< It said no to something.
    kTold,       ///< Anything else.
  };
  Kind kind = Kind::kTold;
  std::string text;
};

/// What has been counted since the start.
struct LinkCounts {
  std::int64_t handshakes = 0;   ///< Sent.
  std::int64_t connections = 0;  ///< Handshakes that were agreed to.
  std::int64_t losses = 0;       ///< Connections that ended by silence.
  std::int64_t restarts = 0;     ///< Connections that ended by the sensor's own announcement.
  std::int64_t repeats = 0;      ///< Commands sent once more for want of an answer.
  std::int64_t refusals = 0;     ///< Commands answered with no.
  std::int64_t odd_frames = 0;   ///< Answers that nobody had asked for, or of a wrong form.
  std::int64_t broadcasts_while_connected = 0;  ///< That were no restart: points went on.
};

/// A datagram to send from the command port.
struct OutgoingFrame {
  Endpoint to;
  Bytes bytes;
};

}  // namespace clearway::core::livox
