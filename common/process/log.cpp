// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/log.hpp"

#include <stdexcept>

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace clearway::process {

void SetUpLog(const std::string& program, const std::string& level) {
  const spdlog::level::level_enum parsed = spdlog::level::from_str(level);
  if (parsed == spdlog::level::off && level != "off") {
    throw std::invalid_argument("log level \"" + level +
                                "\": expected trace, debug, info, warn, error or off");
  }
  auto logger =
      std::make_shared<spdlog::logger>(program, std::make_shared<spdlog::sinks::stderr_sink_st>());
  logger->set_pattern("%Y-%m-%dT%H:%M:%S.%e%z %l %n: %v");
  logger->set_level(parsed);
  spdlog::set_default_logger(std::move(logger));
}

void LogDebug(const std::string& message) {
  spdlog::debug("{}", message);
}
void LogInfo(const std::string& message) {
  spdlog::info("{}", message);
}
void LogWarning(const std::string& message) {
  spdlog::warn("{}", message);
}
void LogError(const std::string& message) {
  spdlog::error("{}", message);
}

}  // namespace clearway::process
