// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/core/procman/deployment.hpp"
#include "common/io/read_error.hpp"

namespace clearway::io {

/// A longer file is refused: it is no deployment [bytes].
inline constexpr std::size_t kMaxPmdBytes = 262'144;
/// Longest id of a command and name of a deputy, group or script [bytes].
inline constexpr std::size_t kMaxPmdNameBytes = 255;
/// Groups nest no deeper.
inline constexpr std::size_t kMaxPmdGroupDepth = 32;
/// No more problems are reported; there may be more.
inline constexpr std::size_t kMaxPmdProblems = 20;
/// Longest time that a command may be given to stop [s].
inline constexpr int kMaxStopTime_s = 3600;
/// Longest wait of a script: a day [ms].
inline constexpr int kMaxScriptWait_ms = 86'400'000;

/// Reads a deployment in the reference procman's grammar:
///
///     file    = { command | group | script }
///     command = "cmd" STRING "{" { attribute } "}"
///     attribute = name "=" STRING ";" with the name exec, deputy or host (one of the two), group,
///                 auto_respawn ("true", "yes", "false" or "no", in any case)
///               | name "=" INTEGER ";" with the name stop_signal (1 to 64), stop_time_allowed [s]
///     group   = "group" STRING "{" { command | group } "}"
///     script  = "script" STRING "{" { action } "}"
///     action  = ( "start" | "stop" | "restart" ) target [ "wait" status ] ";"
///             | "wait" "ms" INTEGER ";"
///             | "wait" ( "cmd" | "group" ) STRING "status" status ";"
///             | "run_script" STRING ";"
///     target  = "everything" | ( "cmd" | "group" ) STRING
///     status  = "running" | "stopped", in quotes
///
/// White space is free, a comment goes from # to the line's end. A string ends in its line; in it
/// \n, \r and \t are control characters and any other \x is x. exec and deputy are required. A
/// command's id and a group's name have no '/'; a group's path joins the names from the outermost
/// by '/', and surplus slashes around and in the path that an action names do not count. A group
/// may be written in several places. A command's attribute `group` means nothing, as in the
/// reference: the groups around it count.
///
/// Stricter than the reference: an attribute given twice, other values than those above, a blank
/// name, an exec that ParseExecLine() refuses, and a NUL are problems, and so are an unknown
/// command, group or script in an action and a script that runs itself, also through others.
///
/// Throws ReadError with all problems that can be told apart, in the file's order, one line each:
/// `file:line:column: what is there: what was expected`. After a problem of the syntax reading goes
/// on behind the next ';' or '}'; names in scripts are then not looked at, nor is more than one
/// such problem of a line reported. `file` is the name for messages.
[[nodiscard]] core::procman::Deployment ParsePmd(std::string_view bytes, const std::string& file);

/// The same for a file. Throws ReadError also when it cannot be read or is empty.
[[nodiscard]] core::procman::Deployment ReadPmd(const std::filesystem::path& path);

}  // namespace clearway::io
