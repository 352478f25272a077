// SPDX-License-Identifier: BSD-3-Clause
#include "tools/replay/replay.hpp"

#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "common/config/config.hpp"
#include "common/io/map/map_file.hpp"
#include "common/io/read_error.hpp"
#include "common/messages/encoding.hpp"
#include "tools/replay/memory_graph.hpp"

namespace clearway::replay {
namespace {

namespace channels = messages::channels;

double Seconds(std::int64_t us) {
  return static_cast<double>(us) / 1e6;
}

// Hears the bus: writes the output, keeps the figures.
class Listener {
 public:
  Listener(const ReplaySettings& settings, const process::SimulatedRuntime& runtime)
      : settings_(settings), runtime_(runtime) {
    if (!settings.output.empty()) log_.emplace(settings.output);
  }

  // `is_input`: the next message is one that was fed.
  void Expect(bool is_input) { is_input_ = is_input; }

  void OnMessage(const std::string& channel, std::span<const std::byte> bytes) {
    if (log_ && (!is_input_ || settings_.with_inputs)) {
      log_->Write(runtime_.UtimeNow(), settings_.channel_prefix + channel, bytes);
    }
    is_input_ = false;
    Count(channel, bytes);
  }

  run_graph::RunStatistics statistics;
  DetectionsOfRun detections{"this replay"};

 private:
  void Count(const std::string& channel, std::span<const std::byte> bytes) {
    statistics.OnMessage(channel, bytes, runtime_.MonotonicUs());
    if (channel != channels::kDetections.name) return;
    if (const auto message = messages::Decode<detections_t>(bytes)) detections.Add(*message);
  }

  const ReplaySettings& settings_;
  const process::SimulatedRuntime& runtime_;
  std::optional<io::LcmLogWriter> log_;
  bool is_input_ = false;
};

constexpr const char* kProcesses[] = {"map_server",
                                      "pose_source",
                                      "preprocessor",
                                      "clusterer",
                                      "stop_guard"};

ReplayResult ResultOf(Listener& listener, const LogInputs& inputs) {
  ReplayResult result;
  result.summary = run_graph::WithoutDurations(listener.statistics.Summarise());
  result.inputs = inputs.counts();
  result.channels = inputs.ChannelsSeen();
  for (const char* const process : kProcesses) {
    const status_t* const status = listener.statistics.StatusOf(process);
    if (status == nullptr) continue;
    result.dropped += status->dropped;
    result.invalid += status->invalid;
  }
  result.detections = std::move(listener.detections);
  return result;
}

std::string NoInputs(const LogInputs& inputs) {
  std::string text =
      "no LIDAR_POINTS, ODOMETRY or POSE to feed; channels in this log: " + inputs.ChannelsSeen();
  if (inputs.counts().refused > 0) {
    text += "; refused: " + std::to_string(inputs.counts().refused) + " inputs, the first " +
            inputs.counts().first_refused;
  }
  return text;
}

std::optional<core::OccupancyGrid> LoadMapOf(const graph::GraphConfig& config) {
  const std::filesystem::path file = config.MapFile();
  if (file.empty()) return std::nullopt;
  return io::LoadMap(file).grid;
}

}  // namespace

ReplayResult Replay(const graph::GraphConfig& config, const ReplaySettings& settings) {
  LogInputs inputs({.log = settings.log,
                    .channel_prefix = settings.channel_prefix,
                    .with_pose = config.pose_source.mode == core::PoseSourceMode::kOff});
  std::optional<Input> input = inputs.Next();
  if (!input) throw io::ErrorInFile(settings.log.string(), NoInputs(inputs));
  const std::int64_t first_utime = input->utime;
  std::optional<core::OccupancyGrid> map = LoadMapOf(config);
  MemoryGraph graph(config,
                    {.start_utime = first_utime - (map ? kSettleWithMapUs : kSettleUs),
                     .version = settings.version,
                     .config_digest = config::Digest(config),
                     .map = std::move(map)});
  process::SimulatedRuntime& runtime = graph.runtime();
  Listener listener(settings, runtime);
  runtime.SetTap([&listener](messages::BusId, const std::string& channel, auto bytes) {
    listener.OnMessage(channel, bytes);
  });

  std::int64_t last_utime = first_utime;
  for (; input; input = inputs.Next()) {
    last_utime = input->utime;
    runtime.RunUntil(last_utime);  // Nothing is pending after it: the next message is the input.
    listener.Expect(true);
    runtime.Publish(input->bus, input->channel, input->bytes);
    runtime.RunUntil(last_utime);
    if (settings.on_progress) {
      settings.on_progress({inputs.ShareRead(), Seconds(last_utime - first_utime)});
    }
  }
  const status_t* const status = listener.statistics.StatusOf("preprocessor");
  const std::string preprocessor_says = status != nullptr ? status->text : "";
  runtime.RunUntil(last_utime + kDrainUs);
  graph.PublishStatuses();

  ReplayResult result = ResultOf(listener, inputs);
  result.recorded_s = Seconds(last_utime - first_utime);
  result.preprocessor_says = preprocessor_says;
  return result;
}

}  // namespace clearway::replay
