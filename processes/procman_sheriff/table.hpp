// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/procman/deployment.hpp"
#include "common/core/procman/sheriff_view.hpp"

namespace clearway {

/// What came from the network, fit for a terminal: control characters become '?'.
[[nodiscard]] std::string Printable(std::string_view text);

/// Two tables, of hosts and of commands, with a line for another sheriff; no line's end at the end.
[[nodiscard]] std::string StatusTable(const core::procman::Snapshot& snapshot);

/// The same as JSON, described in README.md; `result` and `text` are the verb's.
[[nodiscard]] std::string StatusJson(const core::procman::Snapshot& snapshot,
                                     const std::string& result,
                                     const std::string& text);

/// One line of the history.
[[nodiscard]] std::string ChangeLine(const core::procman::Change& change);
[[nodiscard]] std::string ChangeJson(const core::procman::Change& change);

/// What `check` says of a file: commands by deputy and group, and scripts.
[[nodiscard]] std::string Summary(const core::procman::Deployment& deployment);

/// UTC with milliseconds; a stamp that is none is written as a number.
[[nodiscard]] std::string IsoTime(std::int64_t utime);

}  // namespace clearway
