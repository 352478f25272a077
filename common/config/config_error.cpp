// SPDX-License-Identifier: BSD-3-Clause
#include "common/config/config_error.hpp"

#include <utility>

namespace clearway::config {
namespace {

std::string JoinLines(const std::vector<std::string>& lines) {
  std::string joined;
  for (const std::string& line : lines) {
    if (!joined.empty()) joined += '\n';
    joined += line;
  }
  return joined;
}

}  // namespace

ConfigError::ConfigError(std::vector<std::string> problems)
    : std::runtime_error(JoinLines(problems)), problems_(std::move(problems)) {}

}  // namespace clearway::config
