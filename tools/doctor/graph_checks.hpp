// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "tools/doctor/finding.hpp"
#include "tools/doctor/heard.hpp"

/// What is to be said of what was heard on the buses. Nothing is read here.
namespace clearway::doctor {

/// Where this program runs and what it is.
struct Here {
  std::string host;
  std::string deputy;  ///< Id of this host's deputy.
  std::string version;
  std::string deputy_config;  ///< The graph's configuration that this host's file names; or empty.
};

/// A graph that another one would disturb.
[[nodiscard]] Findings CheckTraffic(const Heard& heard, const Here& here);

/// A configuration of the graph, as far as it was read.
struct ConfigFacts {
  std::string path;                   ///< Empty: none was named.
  std::vector<std::string> problems;  ///< Empty: it is good.
  std::string digest;
  std::string effective_digest;  ///< With this program's --lcm-url; the same without one.
};

[[nodiscard]] Findings CheckConfig(const ConfigFacts& config);

/// The same configuration on all hosts and in all processes.
[[nodiscard]] Findings CheckDigests(const Heard& heard,
                                    const ConfigFacts& config,
                                    const Here& here);

/// The same program version everywhere.
[[nodiscard]] Findings CheckVersions(const Heard& heard, const Here& here);

/// Deputies that are to run commands: are they there, and well?
[[nodiscard]] Findings CheckDeputies(const Heard& heard,
                                     const std::vector<std::string>& wanted_ids,
                                     const Here& here);

}  // namespace clearway::doctor
