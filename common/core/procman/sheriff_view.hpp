// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What a sheriff shows to people: tables, JSON and screens are made from it.
namespace clearway::core::procman {

/// What a command is doing, as far as a sheriff can tell.
enum class Status : std::int8_t {
  kUnknown = 0,   ///< Its deputy is not heard (any more).
  kStopped,       ///< Does not run, and nothing went wrong: never started, done, or told to stop.
  kFailed,        ///< Does not run: it ended by itself, and not well.
  kStarting,      ///< Was told to run and does not yet.
  kGettingReady,  ///< Runs, and has not said yet that it is ready.
  kRunning,       ///< Runs and, where its deputy can tell, is ready.
  kUnhealthy,     ///< Runs, but its status stopped or says that it cannot work.
  kBackingOff,    ///< Ended by itself; its deputy starts it again after a pause.
  kGaveUp,        ///< Ended too early too often: stays down until somebody starts it.
  kRefused,       ///< Its host does not allow it, or it cannot be started.
  kRestarting,    ///< Was told to run anew; the old run has not ended yet.
  kStopping,      ///< Was told to stop and has not yet.
  kMoving,        ///< Is to run on this deputy and still has to end on another.
  kRemoving,      ///< Is to end and to be forgotten.
};
inline constexpr int kStatusCount = 14;

/// For programs: "unknown", "stopped", "failed", "starting", "getting_ready", ...: never changes.
[[nodiscard]] std::string_view NameOf(Status status);
/// For people: "Unknown", "Stopped", "Failed", "Starting", "Getting ready", ...
[[nodiscard]] std::string_view WordsFor(Status status);

/// Has a process as far as is known.
[[nodiscard]] constexpr bool IsUp(Status status) {
  return status == Status::kGettingReady || status == Status::kRunning ||
         status == Status::kUnhealthy || status == Status::kRestarting ||
         status == Status::kStopping;
}
/// Somebody ought to look at it.
[[nodiscard]] constexpr bool IsTrouble(Status status) {
  return status == Status::kFailed || status == Status::kUnhealthy ||
         status == Status::kBackingOff || status == Status::kGaveUp || status == Status::kRefused;
}

/// One line of a table of commands.
struct CommandView {
  std::string id;
  std::string group;   ///< Path; empty: none.
  std::string deputy;  ///< Where it is to run; of a stray copy: where that runs.
  std::string exec;
  bool auto_respawn = false;
  bool is_in_file = false;  ///< Else it is known from a deputy or from another sheriff only.
  bool is_stray = false;    ///< A second copy, on a deputy where it is not to run.
  Status status = Status::kUnknown;
  bool is_ready = false;  ///< Running, and ready where its deputy tells.
  /// What `status` says is no news. Up: for half a second, or since before this sheriff looked.
  /// Down: its deputy cannot be about to start it once more before it takes the order to stop.
  bool is_settled = false;
  std::string text;     ///< Why, in words; may be empty.
  std::string differs;  ///< What runs is not what the file says: how; empty: it is.
  std::int32_t pid = 0;
  std::int32_t run_id = 0;          ///< As its deputy reports it.
  std::int32_t desired_run_id = 0;  ///< As this sheriff orders it.
  bool force_quit = false;
  bool was_stopped = false;    ///< Somebody told it to stop, as far as is known.
  std::int32_t exit_code = 0;  ///< Of the last run, as wait() gives it.
  float cpu_usage = 0.0F;      ///< Share of all processors, 0 to 1.
  std::int64_t mem_rss_bytes = 0;
  std::int64_t mem_vsize_bytes = 0;
  std::int32_t starts = -1;               ///< Since its deputy has known it; -1: not told.
  std::int32_t deaths = 0;                ///< By itself, in a row, in this run.
  std::int64_t running_us = -1;           ///< Since its start; -1: does not run, or not told.
  std::int64_t dropped_output_bytes = 0;  ///< Not sent; the log on its host has them.
};

/// One line of a table of hosts.
struct DeputyView {
  std::string id;
  bool is_in_file = false;   ///< The file names it.
  bool is_heard = false;     ///< Within the last 3 s.
  std::int64_t age_us = -1;  ///< Since its last report; -1: never heard.
  std::string host;          ///< These four where the deputy tells more than procman's protocol.
  std::string version;
  std::string config_digest;
  std::string sheriff_id;  ///< Whose orders it last took.
  bool tells_health = false;
  std::string text;  ///< What is wrong with it; empty: nothing.
  float cpu_load = -1.0F;
  std::int64_t phys_mem_total_bytes = 0;
  std::int64_t phys_mem_free_bytes = 0;
  std::int64_t swap_total_bytes = 0;
  std::int64_t swap_free_bytes = 0;
  int commands = 0;  ///< That it lists.
};

/// A group of commands, with those of the groups below it.
struct GroupView {
  std::string path;
  int commands = 0;
  int ready = 0;
  int up = 0;       ///< Have a process.
  int trouble = 0;  ///< Somebody ought to look.
  int unknown = 0;
};

struct OtherSheriff {
  std::string id;
  std::int64_t age_us = 0;  ///< Of its newest orders that are known of.
  bool was_heard = false;   ///< By ourselves; else a deputy says so.
};

/// All that there is to show.
struct Snapshot {
  std::string file;  ///< Of the deployment; empty: none was loaded.
  std::string sheriff_id;
  bool is_observer = false;
  std::optional<OtherSheriff> other;  ///< Another sheriff that is active.
  std::vector<DeputyView> deputies;   ///< By id.
  std::vector<GroupView> groups;      ///< By path; "" is everything.
  std::vector<CommandView> commands;  ///< As in the file, then the others by id.
};

/// One line of the history.
struct Change {
  enum class Kind {
    kCommand,  ///< From one status to another.
    kDeputy,   ///< Heard or silent.
    kSheriff,  ///< A deputy's orders come from somebody else now.
  };
  std::int64_t sequence = 0;  ///< From 0, without gaps.
  std::int64_t utime = 0;     ///< Of the message that showed it [us since the epoch].
  Kind kind = Kind::kCommand;
  std::string deputy;
  std::string command;               ///< kCommand only.
  std::string from;                  ///< Status in words, or what was; may be empty.
  std::string to;                    ///< Empty: the command is gone.
  Status before = Status::kUnknown;  ///< kCommand only: what `from` means; `status` likewise `to`.
  Status status = Status::kUnknown;
  std::string text;
};

}  // namespace clearway::core::procman
