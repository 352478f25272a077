// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "tools/doctor/finding.hpp"

namespace clearway::doctor {

/// Who was looked at.
struct Patient {
  std::string version;  ///< Of this program.
  std::string host;     ///< Name of the host.
  std::string deputy;   ///< Id of the deputy that this host's commands are for.
};

/// A line for each finding, indented lines `mend: COMMAND` below it, and a line of counts.
[[nodiscard]] std::string FormatText(const Findings& findings);

/// Described in README.md.
[[nodiscard]] std::string FormatJson(const Patient& patient, const Findings& findings);

/// 1 when there is a problem, else 0.
[[nodiscard]] int ExitStatusOf(const Findings& findings);

}  // namespace clearway::doctor
