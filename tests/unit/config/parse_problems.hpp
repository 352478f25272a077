// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "common/config/config.hpp"
#include "tests/unit/config/sample_config.hpp"

namespace clearway::config {

/// Problems of a text that is read as site.xml; empty when it loads.
template <typename Root = sample::Root>
std::vector<std::string> ProblemsOf(const std::string& xml,
                                    const std::vector<std::string>& overrides = {}) {
  try {
    (void)Parse<Root>(xml, "site.xml", overrides);
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

/// The text inside <clearway version="1">, all on line 1.
inline std::string InRoot(const std::string& inner) {
  return "<clearway version=\"1\">" + inner + "</clearway>";
}

}  // namespace clearway::config
