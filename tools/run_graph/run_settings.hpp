// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/process/buses_config.hpp"

namespace clearway::run_graph {

/// Where a run's scans come from.
enum class InputKind {
  kPlayed,     ///< A folder, list, file or scene, by clearway-play.
  kLog,        ///< An LCM log, by lcm-logplayer; inputs only.
  kLvx,        ///< An LVX file, by the sensor's driver.
  kLive,       ///< Whatever publishes LIDAR_POINTS.
  kSimulated,  ///< The simulator's sensors, by the driver; the simulated robot drives.
};

/// What is run.
struct RunSettings {
  InputKind kind = InputKind::kPlayed;
  std::filesystem::path input;               ///< Not for kLive.
  std::filesystem::path program_folder;      ///< Where the programs are.
  std::filesystem::path output_folder;       ///< For what the programs write.
  std::vector<std::string> child_arguments;  ///< --config and what else every process gets.
  process::BusesConfig buses;
  std::string channel_prefix;
  bool with_map_server = false;
  bool wait_for_map = false;      ///< Feeding waits until the preprocessor has its map.
  bool with_pose_source = false;  ///< POSE of a log is then not played.
  std::optional<double> stop_after_s;
  std::filesystem::path log;  ///< Everything is written to this LCM log; empty: nothing.
  bool show_progress = true;
};

}  // namespace clearway::run_graph
