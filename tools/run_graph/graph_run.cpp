// SPDX-License-Identifier: BSD-3-Clause
#include "tools/run_graph/graph_run.hpp"

#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdio>
#include <stdexcept>

#include "common/messages/channels.hpp"

namespace clearway::run_graph {
namespace {

namespace channels = messages::channels;

constexpr std::int64_t kSuperviseUs = 20'000;
constexpr std::int64_t kProgressUs = 200'000;
constexpr std::int64_t kReadyTimeoutUs = 30'000'000;
constexpr std::int64_t kDrainTimeoutUs = 3'000'000;
constexpr std::int64_t kLiveSilenceUs = 3'000'000;
constexpr int kStopTimeoutMs = 3000;
constexpr std::int64_t kLastWordsUs = 100'000;  // For the last status of each process.

// The channels of a log that may be played into the graph, as a regular expression of
// lcm-logplayer, which anchors it at both ends. POSE has one publisher.
std::string InputsOf(const RunSettings& settings) {
  std::string prefix;
  for (const char c : settings.channel_prefix) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') prefix += '\\';
    prefix += c;
  }
  return prefix + (settings.with_pose_source ? "(LIDAR_POINTS|ODOMETRY)"
                                             : "(LIDAR_POINTS|ODOMETRY|POSE|POSE_STATUS)");
}

std::string ProgramOf(std::string process) {
  std::replace(process.begin(), process.end(), '_', '-');
  return "clearway-" + process;
}

}  // namespace

GraphRun::GraphRun(process::LiveRuntime& runtime, process::Node& node, const RunSettings& settings)
    : runtime_(runtime), node_(node), settings_(settings) {
  if (!settings_.log.empty()) log_ = std::make_unique<io::LcmLogWriter>(settings_.log);
}

void GraphRun::Run() {
  Listen();
  StartProcesses();
  phase_start_us_ = runtime_.MonotonicUs();
  runtime_.Every(kSuperviseUs, [this] { Supervise(); });
  process::Runtime::TimerId progress = 0;
  if (settings_.show_progress) {
    progress = runtime_.Every(kProgressUs, [this] { ShowProgress(); });
  }
  runtime_.Run();
  if (settings_.show_progress) {
    runtime_.Cancel(progress);
    ShowProgress();
    std::fputc('\n', stderr);
  }
  StopProcesses();
}

template <typename Message>
void GraphRun::LogChannel(const messages::Channel<Message>& channel) {
  if (!log_) return;
  runtime_.Subscribe(channel.bus, channel.name, [this, channel](std::span<const std::byte> bytes) {
    log_->Write(runtime_.UtimeNow(), settings_.channel_prefix + channel.name, bytes);
  });
}

void GraphRun::Listen() {
  node_.Subscribe<lidar_points_t>(channels::kLidarPoints, [this](const auto& m) {
    statistics_.OnLidarPoints(m, runtime_.MonotonicUs());
  });
  node_.Subscribe<obstacle_points_t>(channels::kObstaclePoints,
                                     [this](const auto& m) { statistics_.OnObstaclePoints(m); });
  node_.Subscribe<removed_points_t>(channels::kRemovedPoints,
                                    [this](const auto& m) { statistics_.OnRemovedPoints(m); });
  node_.Subscribe<pose_t>(channels::kPose, [this](const auto& m) { statistics_.OnPose(m); });
  node_.Subscribe<map_tile_t>(channels::kMap, [this](const auto& m) { statistics_.OnMap(m); });
  node_.Subscribe<floor_t>(channels::kFloor, [this](const auto& m) { statistics_.OnFloor(m); });
  node_.Subscribe<detections_t>(channels::kDetections, [this](const auto& m) {
    statistics_.OnDetections(m, runtime_.MonotonicUs());
  });
  node_.Subscribe<drive_permit_t>(channels::kDrivePermit, [this](const auto& m) {
    statistics_.OnDrivePermit(m, runtime_.MonotonicUs());
  });
  for (const auto& channel : {channels::kPreprocessorStatus,
                              channels::kClustererStatus,
                              channels::kStopGuardStatus,
                              channels::kMapServerStatus,
                              channels::kPoseSourceStatus,
                              channels::kPlayStatus}) {
    node_.Subscribe<status_t>(channel, [this](const auto& m) { statistics_.OnStatus(m); });
    LogChannel(channel);
  }
  LogChannel(channels::kLidarPoints);
  LogChannel(channels::kObstaclePoints);
  LogChannel(channels::kFloor);
  LogChannel(channels::kDetections);
  LogChannel(channels::kDrivePermit);
  LogChannel(channels::kOdometry);
  LogChannel(channels::kPose);
  LogChannel(channels::kPoseStatus);
  LogChannel(channels::kMapRequest);
  LogChannel(channels::kMap);
  LogChannel(channels::kLocalMap);
  LogChannel(channels::kRemovedPoints);
}

std::vector<std::string> GraphRun::ProcessNames() const {
  std::vector<std::string> names{"preprocessor", "clusterer", "stop_guard"};
  if (settings_.with_map_server) names.emplace_back("map_server");
  if (settings_.with_pose_source) names.emplace_back("pose_source");
  return names;
}

void GraphRun::StartProcesses() {
  for (const std::string& process : ProcessNames()) {
    std::vector<std::string> command{settings_.program_folder / ProgramOf(process)};
    command.insert(
        command.end(), settings_.child_arguments.begin(), settings_.child_arguments.end());
    processes_.push_back(std::make_unique<host::ChildProcess>(
        process, command, settings_.output_folder / (process + ".log")));
  }
}

void GraphRun::StartFeeding() {
  phase_ = Phase::kFeeding;
  phase_start_us_ = feeding_start_us_ = runtime_.MonotonicUs();
  cpu_at_start_s_ = GraphCpuSeconds();
  std::vector<std::string> command;
  if (settings_.kind == InputKind::kPlayed) {
    command = {settings_.program_folder / "clearway-play", "--input", settings_.input};
    command.insert(
        command.end(), settings_.child_arguments.begin(), settings_.child_arguments.end());
  } else if (settings_.kind == InputKind::kLog) {
    command = {
        "lcm-logplayer", "-l", settings_.lcm_url, "-e", InputsOf(settings_), settings_.input};
  } else {
    return;
  }
  feeder_ =
      std::make_unique<host::ChildProcess>("play", command, settings_.output_folder / "play.log");
}

// Statuses of a graph that somebody else runs on the same bus.
void GraphRun::RefuseForeign(const status_t& status) const {
  const bool is_ours =
      std::any_of(processes_.begin(), processes_.end(), [&status](const auto& process) {
        return process->pid() == status.pid;
      });
  if (is_ours) return;
  throw std::runtime_error("another " + status.process + " (process " + std::to_string(status.pid) +
                           " on " + status.host +
                           ") runs on this bus: stop it, or use --channel-prefix or --lcm-url");
}

std::string GraphRun::WhoIsNotReady() const {
  for (const std::string& process : ProcessNames()) {
    const status_t* const status = statistics_.StatusOf(process);
    if (status == nullptr) return process + " (nothing heard from it)";
    if (status->ready == 0) return process + " (" + status->text + ")";
  }
  if (settings_.wait_for_map && !HasMap()) return "the map on its way to the preprocessor";
  return {};
}

bool GraphRun::HasMap() const {
  const status_t* const status = statistics_.StatusOf("preprocessor");
  return std::any_of(
      status->counters.begin(), status->counters.end(), [](const counter_t& counter) {
        return counter.name == "map_epoch" && counter.value > 0;
      });
}

void GraphRun::CheckForDeaths() {
  for (const auto& process : processes_) {
    if (const auto status = process->ExitStatus()) {
      throw std::runtime_error(process->name() + " ended with status " + std::to_string(*status) +
                               ":\n" + process->LastWords());
    }
  }
}

bool GraphRun::IsInputOver() {
  if (feeder_) {
    const std::optional<int> status = feeder_->ExitStatus();
    if (status.value_or(0) != 0) {
      input_problem_ =
          "the input ended with status " + std::to_string(*status) + ":\n" + feeder_->LastWords();
      if (statistics_.num_played() == 0) throw std::runtime_error(input_problem_);
    }
    return status.has_value();
  }
  const std::optional<std::int64_t> last_us = statistics_.last_input_us();
  return last_us && runtime_.MonotonicUs() - *last_us > kLiveSilenceUs;
}

void GraphRun::Supervise() {
  if (phase_ == Phase::kDone) return;
  CheckForDeaths();
  for (const std::string& process : ProcessNames()) {
    if (const status_t* const status = statistics_.StatusOf(process)) RefuseForeign(*status);
  }
  const std::int64_t now_us = runtime_.MonotonicUs();
  const std::int64_t phase_us = now_us - phase_start_us_;
  switch (phase_) {
    case Phase::kStarting: {
      const std::string waiting_for = WhoIsNotReady();
      if (waiting_for.empty()) {
        StartFeeding();
      } else if (phase_us > kReadyTimeoutUs) {
        throw std::runtime_error("not ready after 30 s: " + waiting_for);
      }
      break;
    }
    case Phase::kFeeding: {
      const bool time_is_up =
          settings_.stop_after_s && static_cast<double>(phase_us) > *settings_.stop_after_s * 1e6;
      if (!time_is_up && !IsInputOver()) break;
      MeasureMachine();
      if (time_is_up) feeder_.reset();
      phase_ = Phase::kDraining;
      phase_start_us_ = now_us;
      break;
    }
    case Phase::kDraining:
      if (statistics_.num_detected() >= statistics_.num_played() || phase_us > kDrainTimeoutUs) {
        phase_ = Phase::kDone;
        runtime_.Stop();
      }
      break;
    case Phase::kDone:
      break;
  }
}

double GraphRun::GraphCpuSeconds() const {
  double sum_s = 0.0;
  for (const auto& process : processes_)
    sum_s += process->Use().value_or(host::ResourceUse{}).cpu_s;
  return sum_s;
}

void GraphRun::MeasureMachine() {
  MachineUse use;
  const double elapsed_s = static_cast<double>(runtime_.MonotonicUs() - feeding_start_us_) * 1e-6;
  use.cpu_cores = (GraphCpuSeconds() - cpu_at_start_s_) / elapsed_s;
  for (const auto& process : processes_) {
    use.pss_mb += process->Use().value_or(host::ResourceUse{}).pss_mb;
  }
  machine_use_ = use;
}

void GraphRun::StopProcesses() {
  if (phase_ == Phase::kFeeding && !machine_use_) MeasureMachine();
  feeder_.reset();
  for (const auto& process : processes_) process->Signal(SIGINT);
  for (const auto& process : processes_) process->WaitOrKill(kStopTimeoutMs);
  phase_ = Phase::kDone;
  runtime_.RunFor(kLastWordsUs);
}

void GraphRun::ShowProgress() {
  if (phase_ == Phase::kStarting) {
    std::fprintf(stderr, "\rwaiting for %-60s", WhoIsNotReady().c_str());
    return;
  }
  std::fprintf(stderr,
               "\rscans played %zu, detected %zu%-40s",
               statistics_.num_played(),
               statistics_.num_detected(),
               settings_.kind == InputKind::kLive && !statistics_.last_input_us()
                   ? ", waiting for LIDAR_POINTS"
                   : "");
}

}  // namespace clearway::run_graph
