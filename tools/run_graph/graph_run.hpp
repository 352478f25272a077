// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/host/child_process.hpp"
#include "common/io/lcm_log.hpp"
#include "common/process/live_runtime.hpp"
#include "common/process/node.hpp"
#include "tools/run_graph/run_statistics.hpp"

namespace clearway::run_graph {

/// Where a run's scans come from.
enum class InputKind {
  kPlayed,  ///< A folder, list, file or scene, by clearway-play.
  kLog,     ///< An LCM log, by lcm-logplayer; inputs only.
  kLive,    ///< Whatever publishes LIDAR_POINTS.
};

/// What is run.
struct RunSettings {
  InputKind kind = InputKind::kPlayed;
  std::filesystem::path input;               ///< Not for kLive.
  std::filesystem::path program_folder;      ///< Where the programs are.
  std::filesystem::path output_folder;       ///< For what the programs write to stderr.
  std::vector<std::string> child_arguments;  ///< --config and what else every process gets.
  std::string lcm_url;                       ///< Of the local bus, for lcm-logplayer.
  std::string channel_prefix;
  bool with_map_server = false;
  bool wait_for_map = false;      ///< Feeding waits until the preprocessor has its map.
  bool with_pose_source = false;  ///< POSE of a log is then not played.
  std::optional<double> stop_after_s;
  std::filesystem::path log;  ///< Everything is written to this LCM log; empty: nothing.
  bool show_progress = true;
};

/// What the machine spent on the processes of the graph (without the player and this program).
struct MachineUse {
  double cpu_cores = 0.0;
  double pss_mb = 0.0;
};

/// Starts the processes of the graph as programs of their own, waits until they are ready, feeds
/// them, listens, and ends them. Ends by itself when the input is over and its last scan has gone
/// through, or after stop_after_s, or on SIGINT.
class GraphRun {
 public:
  GraphRun(process::LiveRuntime& runtime, process::Node& node, const RunSettings& settings);

  /// Runs to the end. Throws std::runtime_error when a process does not start, does not become
  /// ready, or dies: with its last words.
  void Run();

  [[nodiscard]] const RunStatistics& statistics() const { return statistics_; }
  [[nodiscard]] const std::optional<MachineUse>& machine_use() const { return machine_use_; }

  /// What went wrong with a part of the input (scans that could not be read); empty: nothing.
  [[nodiscard]] const std::string& input_problem() const { return input_problem_; }

 private:
  enum class Phase { kStarting, kFeeding, kDraining, kDone };

  void Listen();
  template <typename Message>
  void LogChannel(const messages::Channel<Message>& channel);
  [[nodiscard]] std::vector<std::string> ProcessNames() const;
  void StartProcesses();
  void StartFeeding();
  void Supervise();
  [[nodiscard]] bool HasMap() const;
  void CheckForDeaths();
  void RefuseForeign(const status_t& status) const;
  [[nodiscard]] std::string WhoIsNotReady() const;
  [[nodiscard]] bool IsInputOver();
  void StopProcesses();
  void MeasureMachine();
  [[nodiscard]] double GraphCpuSeconds() const;
  void ShowProgress();

  process::LiveRuntime& runtime_;
  process::Node& node_;
  RunSettings settings_;
  RunStatistics statistics_;
  std::unique_ptr<io::LcmLogWriter> log_;
  std::vector<std::unique_ptr<host::ChildProcess>> processes_;
  std::unique_ptr<host::ChildProcess> feeder_;
  Phase phase_ = Phase::kStarting;
  std::int64_t phase_start_us_ = 0;
  std::int64_t feeding_start_us_ = 0;
  double cpu_at_start_s_ = 0.0;
  std::optional<MachineUse> machine_use_;
  std::string input_problem_;
};

}  // namespace clearway::run_graph
