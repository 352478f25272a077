// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/procman/deployment.hpp"

/// What sheriffs and deputies tell each other. All but DeputyHealth is the reference procman's
/// protocol, member by member.
namespace clearway::core::procman {

/// What a sheriff wants of one command.
struct DesiredCommand {
  CommandSpec spec;
  std::int32_t run_id = 0;  ///< Another value than the actual one: run (again). 0: leave it alone.
  bool force_quit = false;  ///< Stop it and keep it stopped.
  friend bool operator==(const DesiredCommand&, const DesiredCommand&) = default;
};

/// The whole desired state of one deputy: a command that is missing is to be stopped and forgotten.
struct Orders {
  std::int64_t utime = 0;  ///< Grows from one order of a sheriff to its next [us since the epoch].
  std::string deputy_id;
  std::string sheriff_id;
  std::vector<DesiredCommand> commands;
};

/// What a deputy says of one command.
struct CommandReport {
  CommandSpec spec;
  std::int32_t pid = 0;        ///< 0: does not run.
  std::int32_t run_id = 0;     ///< That it was last started with; 0: never.
  std::int32_t exit_code = 0;  ///< As wait() gives it; 0 while it runs.
  float cpu_usage = 0.0F;      ///< Share of all processors, with children, 0 to 1.
  std::int64_t mem_vsize_bytes = 0;
  std::int64_t mem_rss_bytes = 0;
};

/// What a deputy says of itself at 1 Hz and on change.
struct DeputyReport {
  std::int64_t utime = 0;
  std::string deputy_id;
  float cpu_load = -1.0F;  ///< Of the host, 0 to 1; -1 before the first sample.
  std::int64_t phys_mem_total_bytes = 0;
  std::int64_t phys_mem_free_bytes = 0;
  std::int64_t swap_total_bytes = 0;
  std::int64_t swap_free_bytes = 0;
  std::vector<CommandReport> commands;
};

/// What a command is doing, as its deputy sees it.
enum class CommandState : std::int8_t {
  kStopped = 0,  ///< Is not to run.
  kBackingOff,   ///< Ended too early; starts again after a pause.
  kRunning,
  kStopping,  ///< Was told to end and has not yet.
  kEnded,     ///< Ended by itself, and is not to be started again.
  kGaveUp,    ///< Ended too early too often; only a new run id starts it.
  kRefused,   ///< Is not allowed on this host, or cannot be started: see the text.
};

/// What the status message of a command says, where one is expected.
enum class CommandHealth : std::int8_t {
  kNotExpected = 0,  ///< It counts as ready while it runs.
  kNotReady,         ///< Has not said yet that it is ready.
  kReady,
  kUnhealthy,  ///< Its status stopped, or says that it cannot work: see the text.
};

/// What a deputy knows of a command beyond procman's protocol.
struct CommandHealthReport {
  std::string id;
  CommandState state = CommandState::kStopped;
  CommandHealth health = CommandHealth::kNotExpected;
  std::string text;                       ///< Both in words.
  std::int32_t starts = 0;                ///< Since the deputy has known it.
  std::int32_t quick_deaths = 0;          ///< In a row.
  std::int64_t running_us = -1;           ///< Since its last start; -1: does not run.
  std::int64_t dropped_output_bytes = 0;  ///< Not sent on PM_OUTPUT; the log on disk has them.
};

/// Channel PM_HEALTH, beside the protocol: at 1 Hz and on change.
struct DeputyHealth {
  std::string deputy_id;
  std::string host;
  std::string version;        ///< Of the deputy's program.
  std::string config_digest;  ///< Of the graph's configuration file that it was told of; or empty.
  std::string sheriff_id;     ///< Whose orders it last took; empty: nobody's yet.
  std::int64_t orders_age_us = -1;  ///< Since that; -1: never.
  std::string text;                 ///< What is wrong with the deputy itself; empty: nothing.
  std::vector<CommandHealthReport> commands;
};

/// Runs, and is ready where that can be told.
[[nodiscard]] inline bool IsReady(const CommandHealthReport& report) {
  return report.state == CommandState::kRunning &&
         (report.health == CommandHealth::kNotExpected || report.health == CommandHealth::kReady);
}

}  // namespace clearway::core::procman
