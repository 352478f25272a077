// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/drive_permit.hpp"

#include <cmath>

namespace clearway::messages {
namespace {

std::int8_t PathOf(const core::Permit& permit) {
  if (permit.is_closed()) return drive_permit_t::PATH_WATCHDOG;
  switch (permit.reason) {
    case core::PermitReason::kObstacle:
      return drive_permit_t::PATH_POINTS;
    case core::PermitReason::kNoDetections:
      return drive_permit_t::PATH_WATCHDOG;
    default:
      return drive_permit_t::PATH_NONE;
  }
}

}  // namespace

drive_permit_t ToLcm(const core::Permit& permit) {
  drive_permit_t message{};
  message.forward_mps = permit.forward_mps();
  message.backward_mps = permit.backward_mps();
  message.turn_left_radps = permit.turn_left_radps();
  message.turn_right_radps = permit.turn_right_radps();
  message.reason = static_cast<std::int8_t>(permit.reason);
  message.path = PathOf(permit);
  message.latched = 0;
  const core::DirectionPermit& cause = permit[permit.cause_direction];
  if (cause.has_cause) {
    for (int i = 0; i < 3; ++i) message.cause[i] = static_cast<double>(cause.cause_vehicle[i]);
  }
  const double ahead = permit[core::Direction::kForward].free_way;
  message.free_distance_m = std::isfinite(ahead) ? ahead : -1.0;
  return message;
}

const char* ReasonText(core::PermitReason reason) {
  switch (reason) {
    case core::PermitReason::kFree:
      return "free";
    case core::PermitReason::kObstacle:
      return "obstacle in the way";
    case core::PermitReason::kUnseen:
      return "no sensor looks there";
    case core::PermitReason::kNoDetections:
      return "DETECTIONS are missing";
    case core::PermitReason::kStarting:
      return "a sensor has not been heard yet";
    case core::PermitReason::kSensorSilent:
      return "a sensor has fallen silent";
    case core::PermitReason::kSlicesLate:
      return "a sensor's slices come late";
    case core::PermitReason::kTwoPublishers:
      return "two publishers send one sensor's slices";
    case core::PermitReason::kNoReturns:
      return "a sensor has no returns: is it covered?";
    case core::PermitReason::kNoOdometry:
      return "ODOMETRY is missing";
  }
  return "unknown";
}

}  // namespace clearway::messages
