// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <clearway/obstacle_points_t.hpp>

namespace clearway::messages {

/// True when points that the map explains were taken out of a scan with this map_state.
[[nodiscard]] inline bool IsFiltered(std::int8_t map_state) {
  return map_state == obstacle_points_t::MAP_FILTERED ||
         map_state == obstacle_points_t::OUTSIDE_MAP;
}

/// obstacle_points_t.map_state in words.
[[nodiscard]] inline const char* MapStateInWords(std::int8_t map_state) {
  switch (map_state) {
    case obstacle_points_t::MAP_OFF:
      return "the map filter is off";
    case obstacle_points_t::MAP_FILTERED:
      return "filtered";
    case obstacle_points_t::MAP_MISSING:
      return "no map: nothing was removed";
    case obstacle_points_t::POSE_MISSING:
      return "no pose: nothing was removed";
    case obstacle_points_t::POSE_OLD:
      return "pose too old: nothing was removed";
    case obstacle_points_t::POSE_LOST:
      return "pose lost: nothing was removed";
    case obstacle_points_t::OUTSIDE_MAP:
      return "filtered, but most points are off the map or in unknown cells";
    default:
      return "state not known";
  }
}

}  // namespace clearway::messages
