// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace clearway::process {

/// Lines on stderr: ISO time with milliseconds, level, program, message.
/// `level` is one of trace, debug, info, warn, error, off. Throws std::invalid_argument on others.
void SetUpLog(const std::string& program, const std::string& level);

void LogDebug(const std::string& message);
void LogInfo(const std::string& message);
void LogWarning(const std::string& message);
void LogError(const std::string& message);

}  // namespace clearway::process
