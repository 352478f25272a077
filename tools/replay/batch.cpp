// SPDX-License-Identifier: BSD-3-Clause
#include "tools/replay/batch.hpp"

#include <algorithm>
#include <optional>
#include <span>

#include "common/config/config.hpp"
#include "common/io/lcm_log.hpp"
#include "common/io/map/map_file.hpp"
#include "processes/simulator/simulator_setting.hpp"
#include "tools/replay/memory_graph.hpp"

namespace clearway::replay {
namespace {

constexpr std::int64_t kStep_us = 100'000;

MemoryGraphSettings SettingsOf(const graph::GraphConfig& config, const BatchSettings& settings) {
  MemoryGraphSettings graph{.start_utime = kBatchStartUtime,
                            .version = settings.version,
                            .config_digest = config::Digest(config),
                            .simulation = LoadSetting(config, {})};
  const std::filesystem::path map = config.MapFile();
  if (settings.with_graph && !map.empty()) graph.map = io::LoadMap(map).grid;
  if (!settings.with_graph) {
    graph.parts = {.map_server = false,
                   .pose_source = false,
                   .preprocessor = false,
                   .clusterer = false,
                   .stop_guard = false,
                   .livox_driver = true};
  }
  return graph;
}

}  // namespace

run_graph::RunSummary RunBatch(const graph::GraphConfig& config, const BatchSettings& settings) {
  std::optional<io::LcmLogWriter> log;
  if (!settings.log.empty()) log.emplace(settings.log);
  run_graph::RunStatistics statistics;
  MemoryGraph graph(config, SettingsOf(config, settings));
  process::SimulatedRuntime& runtime = graph.runtime();
  runtime.SetTap(
      [&](messages::BusId, const std::string& channel, std::span<const std::byte> bytes) {
        if (log) log->Write(runtime.UtimeNow(), settings.channel_prefix + channel, bytes);
        statistics.OnMessage(channel, bytes, runtime.MonotonicUs());
      });
  const std::int64_t end_utime =
      kBatchStartUtime + static_cast<std::int64_t>(settings.duration_s * 1e6);
  for (std::int64_t utime = kBatchStartUtime; utime < end_utime;) {
    utime = std::min(utime + kStep_us, end_utime);
    runtime.RunUntil(utime);
    if (settings.on_progress) {
      settings.on_progress(static_cast<double>(utime - kBatchStartUtime) * 1e-6);
    }
  }
  graph.PublishStatuses();
  return run_graph::WithoutDurations(statistics.Summarise());
}

}  // namespace clearway::replay
