// SPDX-License-Identifier: BSD-3-Clause
#include "tools/run_graph/graph_run.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "common/messages/channels.hpp"
#include "tools/run_graph/graph_deployment.hpp"

namespace clearway::run_graph {
namespace {

namespace channels = messages::channels;

constexpr std::int64_t kSuperviseUs = 20'000;
constexpr std::int64_t kProgressUs = 200'000;
constexpr std::int64_t kReadyTimeoutUs = 30'000'000;
constexpr std::int64_t kDrainTimeoutUs = 3'000'000;
constexpr std::int64_t kLiveSilenceUs = 3'000'000;
constexpr std::int64_t kStopTimeoutUs = 4'000'000;  // The deputy kills after 3 s.
constexpr std::int64_t kStepUs = 10'000;
constexpr std::int64_t kLastWordsUs = 100'000;  // For the last status of each process.

}  // namespace

GraphRun::GraphRun(process::LiveRuntime& runtime, process::Node& node, const RunSettings& settings)
    : runtime_(runtime),
      node_(node),
      settings_(settings),
      deputy_(runtime, settings),
      feeder_(FeederName(settings)) {
  if (!settings_.log.empty()) log_ = std::make_unique<io::LcmLogWriter>(settings_.log);
}

void GraphRun::Run() {
  Listen();
  deputy_.Start(kGraphGroup);
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
                              channels::kPlayStatus,
                              channels::kLivoxDriverStatus,
                              channels::kSimulatorStatus}) {
    node_.Subscribe<status_t>(channel, [this](const auto& m) { statistics_.OnStatus(m); });
    LogChannel(channel);
  }
  LogChannel(channels::kLidarPoints);
  LogChannel(channels::kObstaclePoints);
  LogChannel(channels::kFloor);
  LogChannel(channels::kDetections);
  LogChannel(channels::kDrivePermit);
  LogChannel(channels::kOdometry);
  LogChannel(channels::kDriveRequest);
  LogChannel(channels::kDriveCommand);
  LogChannel(channels::kTruth);
  LogChannel(channels::kPose);
  LogChannel(channels::kPoseStatus);
  LogChannel(channels::kMapRequest);
  LogChannel(channels::kMap);
  LogChannel(channels::kLocalMap);
  LogChannel(channels::kRemovedPoints);
  LogChannel(channels::kPmInfo);
  LogChannel(channels::kPmOrders);
  LogChannel(channels::kPmOutput);
  LogChannel(channels::kPmHealth);
}

void GraphRun::StartFeeding() {
  phase_ = Phase::kFeeding;
  phase_start_us_ = feeding_start_us_ = runtime_.MonotonicUs();
  cpu_at_start_s_ = CpuSeconds();
  deputy_.Start(kInputGroup);
}

// Statuses of a graph that somebody else runs on the same bus.
void GraphRun::RefuseForeign(const status_t& status) const {
  if (deputy_.IsOwn(status)) return;
  throw std::runtime_error("another " + status.process + " (process " + std::to_string(status.pid) +
                           " on " + status.host +
                           ") runs on this bus: stop it, or use --channel-prefix or --lcm-url");
}

std::string GraphRun::WhoIsNotReady() const {
  for (const std::string& process : ProcessNames(settings_)) {
    if (!deputy_.IsReady(process)) return process + " (" + deputy_.StateOf(process) + ")";
  }
  if (settings_.wait_for_map && !HasMap()) return "the map on its way to the preprocessor";
  return {};
}

bool GraphRun::HasMap() const {
  const status_t* const status = statistics_.StatusOf("preprocessor");
  if (status == nullptr) return false;
  return std::any_of(
      status->counters.begin(), status->counters.end(), [](const counter_t& counter) {
        return counter.name == "map_epoch" && counter.value > 0;
      });
}

void GraphRun::CheckForDeaths() {
  deputy_.CheckAlive();
  for (const std::string& process : ProcessNames(settings_)) {
    if (const auto status = deputy_.ExitStatusOf(process)) {
      throw std::runtime_error(process + " ended with status " + std::to_string(*status) + ":\n" +
                               deputy_.LastWordsOf(process));
    }
  }
}

bool GraphRun::IsInputOver() {
  if (settings_.kind != InputKind::kLive) {
    const std::optional<int> status = deputy_.ExitStatusOf(feeder_);
    if (status.value_or(0) != 0) {
      input_problem_ = "the input ended with status " + std::to_string(*status) + ":\n" +
                       deputy_.LastWordsOf(feeder_);
      if (statistics_.num_played() == 0) throw std::runtime_error(input_problem_);
    }
    return status.has_value();
  }
  const std::optional<std::int64_t> last_us = statistics_.last_input_us();
  return last_us && runtime_.MonotonicUs() - *last_us > kLiveSilenceUs;
}

bool GraphRun::IsFeederDown() const {
  return deputy_.PidOf(feeder_) == 0;
}

bool GraphRun::HasDrained() const {
  return IsFeederDown() && statistics_.num_detected() >= statistics_.num_played();
}

void GraphRun::Supervise() {
  if (phase_ == Phase::kStopping) return;
  CheckForDeaths();
  for (const std::string& process : ProcessNames(settings_)) {
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
      if (time_is_up) deputy_.Stop(kInputGroup);
      phase_ = Phase::kDraining;
      phase_start_us_ = now_us;
      break;
    }
    case Phase::kDraining:
      if (HasDrained() || phase_us > kDrainTimeoutUs) runtime_.Stop();
      break;
    case Phase::kStopping:
      break;
  }
}

std::vector<std::string> GraphRun::MeasuredProcesses() const {
  std::vector<std::string> names = ProcessNames(settings_);
  if (settings_.kind == InputKind::kSimulated) names.push_back(feeder_);
  return names;
}

std::map<std::string, double> GraphRun::CpuSeconds() const {
  std::map<std::string, double> seconds;
  for (const std::string& process : MeasuredProcesses()) {
    seconds[process] = host::UseOf(deputy_.PidOf(process)).value_or(host::ResourceUse{}).cpu_s;
  }
  return seconds;
}

void GraphRun::MeasureMachine() {
  MachineUse use;
  const double elapsed_s = static_cast<double>(runtime_.MonotonicUs() - feeding_start_us_) * 1e-6;
  for (const std::string& process : MeasuredProcesses()) {
    const auto now = host::UseOf(deputy_.PidOf(process)).value_or(host::ResourceUse{});
    const ProcessUse one{.cpu_cores = (now.cpu_s - cpu_at_start_s_[process]) / elapsed_s,
                         .pss_mb = now.pss_mb};
    use.processes[process] = one;
    if (process == feeder_) continue;
    use.cpu_cores += one.cpu_cores;
    use.pss_mb += one.pss_mb;
  }
  machine_use_ = use;
}

void GraphRun::StopProcesses() {
  if (phase_ == Phase::kFeeding && !machine_use_) MeasureMachine();
  phase_ = Phase::kStopping;
  deputy_.Stop(kInputGroup);
  RunUntil([this] { return IsFeederDown(); });
  deputy_.Stop(kGraphGroup);
  RunUntil([this] {
    const auto names = ProcessNames(settings_);
    return std::all_of(names.begin(), names.end(), [this](const std::string& process) {
      return deputy_.PidOf(process) == 0;
    });
  });
  runtime_.RunFor(kLastWordsUs);
}

// Also after a signal, which only ends the present step.
void GraphRun::RunUntil(const std::function<bool()>& holds) {
  const std::int64_t until_us = runtime_.MonotonicUs() + kStopTimeoutUs;
  while (!holds() && !deputy_.has_ended() && runtime_.MonotonicUs() < until_us) {
    runtime_.RunFor(kStepUs);
  }
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
