// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace clearway::messages {

/// The two buses of the graph. With everything on one host both may be the same LCM URL.
enum class BusId {
  kLocal,   ///< Never leaves the host: raw points and everything that moves the robot.
  kShared,  ///< May cross to other hosts when it is configured to.
};

/// A channel: its name, the bus it is on and the one type that it carries. Constants of this type
/// in channels.hpp are the only place where channel names stand.
template <typename MessageType>
struct Channel {
  using Message = MessageType;
  const char* name;
  BusId bus;
};

}  // namespace clearway::messages
