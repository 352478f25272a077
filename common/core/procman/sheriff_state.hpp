// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/core/procman/orders.hpp"
#include "common/core/procman/sheriff_view.hpp"

/// What a Sheriff remembers. Times are of this host's monotonic clock [us].
namespace clearway::core::procman {

/// Ids come from outside: what claims more is not believed.
inline constexpr std::size_t kMaxDeputies = 1000;
inline constexpr std::size_t kMaxCommands = 10000;

/// Orders come at 1 Hz: who has given none for this long gives none any more.
inline constexpr std::int64_t kOrdersActiveUs = 3'000'000;

/// One command in the last report of one deputy, and what its reports before that add.
struct ReportedCommand {
  CommandReport report;
  /// The deputy's health is older than this run: not to be believed.
  bool is_health_old = false;
  std::int32_t starts = -1;    ///< As its health counted in this run; -1: not told.
  bool was_seen_up = false;    ///< In this run id.
  bool was_seen_down = false;  ///< Before this process, so its start was watched.
  std::int64_t since_us = 0;   ///< When this pid was first seen.
  std::int32_t deaths = 0;     ///< Seen, of this run id.
};

struct KnownDeputy {
  std::string id;
  std::optional<DeputyReport> report;  ///< Its commands are in `commands`.
  std::int64_t heard_us = 0;           ///< That report.
  std::map<std::string, ReportedCommand> commands;
  std::optional<DeputyHealth> health;  ///< Its commands are in `healths`.
  std::int64_t health_us = 0;
  std::map<std::string, CommandHealthReport> healths;
  int stamps_back = 0;  ///< Reports whose stamp was long before the one before them.
  std::int64_t stamp_back_us = 0;

  std::string orders_by;       ///< Whose orders for it were last heard.
  std::int64_t orders_us = 0;  ///< And when.
  bool is_changed = false;     ///< Orders are due at once.
  std::optional<std::int64_t> sent_us;
  std::vector<DesiredCommand> sent;
  std::map<std::string, std::int64_t> told_to_run_us;  ///< Commands, and when orders said so last.
  bool was_heard = false;                              ///< For the history.
};

struct KnownCommand {
  CommandSpec spec = {};    ///< The file's, else the deputy's.
  std::string deputy = {};  ///< Where it is to run.
  bool is_in_file = false;
  std::size_t position = 0;  ///< In the file.

  std::int32_t run_id = 0;
  bool force_quit = false;
  bool was_stopped = false;  ///< It was told to end: dying by a signal is no failure then.
  bool is_asked = false;     ///< Somebody asked this sheriff for a start, stop or restart of it.
  bool is_forced = false;
  bool is_removed = false;
  bool is_mirrored = false;  ///< An observer: the last orders held it.
  std::optional<bool> waits_to_restart =
      std::nullopt;  ///< Asked while its deputy was not heard; false: start.
  std::int64_t asked_us = 0;
  /// It was ordered to stay down until it has ended elsewhere, which may have ended it here too.
  bool is_held = false;
  bool stop_needs_time = false;  ///< When it was asked to stop it was between two starts, maybe.
  std::int64_t held_back_until_us = 0;  ///< It was being stopped when we came.

  std::int32_t old_exec_pid = 0;  ///< This process runs what `old_exec` says.
  std::string old_exec = {};

  std::optional<Status> noted = std::nullopt;  ///< The last in the history.
};

}  // namespace clearway::core::procman
