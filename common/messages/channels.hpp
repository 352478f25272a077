// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include <clearway/deputy_health_t.hpp>
#include <clearway/detections_t.hpp>
#include <clearway/drive_command_t.hpp>
#include <clearway/drive_permit_t.hpp>
#include <clearway/drive_request_t.hpp>
#include <clearway/estop_ack_t.hpp>
#include <clearway/estop_t.hpp>
#include <clearway/floor_t.hpp>
#include <clearway/lidar_points_t.hpp>
#include <clearway/local_map_t.hpp>
#include <clearway/map_request_t.hpp>
#include <clearway/map_tile_t.hpp>
#include <clearway/obstacle_points_t.hpp>
#include <clearway/odometry_t.hpp>
#include <clearway/pose_status_t.hpp>
#include <clearway/pose_t.hpp>
#include <clearway/removed_points_t.hpp>
#include <clearway/status_t.hpp>
#include <clearway/truth_t.hpp>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <procman_lcm/output_t.hpp>

#include "common/messages/channel.hpp"

/// Every channel of the graph. lcmtypes/README.md tells who publishes and who listens.
namespace clearway::messages::channels {

inline constexpr Channel<lidar_points_t> kLidarPoints{"LIDAR_POINTS", BusId::kLocal};
inline constexpr Channel<odometry_t> kOdometry{"ODOMETRY", BusId::kLocal};
inline constexpr Channel<removed_points_t> kRemovedPoints{"REMOVED_POINTS", BusId::kLocal};
inline constexpr Channel<drive_permit_t> kDrivePermit{"DRIVE_PERMIT", BusId::kLocal};
inline constexpr Channel<drive_request_t> kDriveRequest{"DRIVE_REQUEST", BusId::kLocal};
inline constexpr Channel<drive_command_t> kDriveCommand{"DRIVE_COMMAND", BusId::kLocal};
inline constexpr Channel<estop_t> kEstop{"ESTOP", BusId::kLocal};
inline constexpr Channel<estop_ack_t> kEstopAck{"ESTOP_ACK", BusId::kLocal};
inline constexpr Channel<truth_t> kTruth{"TRUTH", BusId::kLocal};

inline constexpr Channel<pose_t> kPose{"POSE", BusId::kShared};
inline constexpr Channel<pose_status_t> kPoseStatus{"POSE_STATUS", BusId::kShared};
inline constexpr Channel<obstacle_points_t> kObstaclePoints{"OBSTACLE_POINTS", BusId::kShared};
inline constexpr Channel<floor_t> kFloor{"FLOOR", BusId::kShared};
inline constexpr Channel<detections_t> kDetections{"DETECTIONS", BusId::kShared};
inline constexpr Channel<map_request_t> kMapRequest{"MAP_REQUEST", BusId::kShared};
inline constexpr Channel<map_tile_t> kMap{"MAP", BusId::kShared};
inline constexpr Channel<map_tile_t> kMapUpdate{"MAP_UPDATE", BusId::kShared};
inline constexpr Channel<local_map_t> kLocalMap{"LOCAL_MAP", BusId::kShared};

inline constexpr Channel<status_t> kPlayStatus{"PLAY_STATUS", BusId::kShared};
inline constexpr Channel<status_t> kRunStatus{"RUN_STATUS", BusId::kShared};
inline constexpr Channel<status_t> kLivoxDriverStatus{"LIVOX_DRIVER_STATUS", BusId::kShared};
inline constexpr Channel<status_t> kSimulatorStatus{"SIMULATOR_STATUS", BusId::kShared};
inline constexpr Channel<status_t> kPreprocessorStatus{"PREPROCESSOR_STATUS", BusId::kShared};
inline constexpr Channel<status_t> kClustererStatus{"CLUSTERER_STATUS", BusId::kShared};
inline constexpr Channel<status_t> kStopGuardStatus{"STOP_GUARD_STATUS", BusId::kShared};
inline constexpr Channel<status_t> kMapServerStatus{"MAP_SERVER_STATUS", BusId::kShared};
inline constexpr Channel<status_t> kPoseSourceStatus{"POSE_SOURCE_STATUS", BusId::kShared};

/// All of them, for who looks at all processes.
inline constexpr std::array kAllStatuses{kPlayStatus,
                                         kRunStatus,
                                         kLivoxDriverStatus,
                                         kSimulatorStatus,
                                         kPreprocessorStatus,
                                         kClustererStatus,
                                         kStopGuardStatus,
                                         kMapServerStatus,
                                         kPoseSourceStatus};

inline constexpr Channel<procman_lcm::deputy_info_t> kPmInfo{"PM_INFO", BusId::kShared};
inline constexpr Channel<procman_lcm::orders_t> kPmOrders{"PM_ORDERS", BusId::kShared};
inline constexpr Channel<procman_lcm::output_t> kPmOutput{"PM_OUTPUT", BusId::kShared};
inline constexpr Channel<procman_lcm::discovery_t> kPmDiscover{"PM_DISCOVER", BusId::kShared};
inline constexpr Channel<deputy_health_t> kPmHealth{"PM_HEALTH", BusId::kShared};

}  // namespace clearway::messages::channels
