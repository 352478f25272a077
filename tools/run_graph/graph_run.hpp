// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/io/lcm_log.hpp"
#include "common/process/live_runtime.hpp"
#include "common/process/node.hpp"
#include "tools/run_graph/own_deputy.hpp"
#include "tools/run_graph/run_settings.hpp"
#include "tools/run_graph/run_statistics.hpp"

namespace clearway::run_graph {

/// What the machine spent on one process.
struct ProcessUse {
  double cpu_cores = 0.0;
  double pss_mb = 0.0;
};

/// What the machine spent on the processes of the graph (without the player or simulator, the
/// deputy and this program).
struct MachineUse {
  double cpu_cores = 0.0;
  double pss_mb = 0.0;
  std::map<std::string, ProcessUse> processes;  ///< Each by itself, the simulator too.
};

/// Has a deputy of its own start the processes of the graph, waits until they are ready, feeds
/// them, listens, and has them stopped. Ends by itself when the input is over and its last scan has
/// gone through, or after stop_after_s, or on SIGINT.
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
  enum class Phase { kStarting, kFeeding, kDraining, kStopping };

  void Listen();
  template <typename Message>
  void LogChannel(const messages::Channel<Message>& channel);
  void StartFeeding();
  void Supervise();
  [[nodiscard]] bool HasMap() const;
  void CheckForDeaths();
  void RefuseForeign(const status_t& status) const;
  [[nodiscard]] std::string WhoIsNotReady() const;
  [[nodiscard]] bool IsInputOver();
  [[nodiscard]] bool IsFeederDown() const;
  [[nodiscard]] bool HasDrained() const;
  void StopProcesses();
  void RunUntil(const std::function<bool()>& holds);
  void MeasureMachine();
  [[nodiscard]] std::vector<std::string> MeasuredProcesses() const;
  [[nodiscard]] std::map<std::string, double> CpuSeconds() const;
  void ShowProgress();

  process::LiveRuntime& runtime_;
  process::Node& node_;
  RunSettings settings_;
  RunStatistics statistics_;
  std::unique_ptr<io::LcmLogWriter> log_;
  OwnDeputy deputy_;
  Phase phase_ = Phase::kStarting;
  std::int64_t phase_start_us_ = 0;
  std::int64_t feeding_start_us_ = 0;
  std::string feeder_;
  std::map<std::string, double> cpu_at_start_s_;
  std::optional<MachineUse> machine_use_;
  std::string input_problem_;
};

}  // namespace clearway::run_graph
