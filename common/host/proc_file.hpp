// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace clearway::host {

/// Reads the beginning of a file of /proc into the buffer, without allocating; `folder_fd` as of
/// openat(). Empty when it cannot be read: processes come and go.
[[nodiscard]] std::string_view ReadProcFile(int folder_fd,
                                            const char* name,
                                            std::span<char> buffer);

/// Reads a file of /proc to its end, for at most `max_bytes`. Nothing when it cannot be read.
[[nodiscard]] std::optional<std::string> ReadProcFile(const std::string& path,
                                                      std::size_t max_bytes);

/// "what: the system's reason" of the present errno.
[[nodiscard]] std::string WithReason(const std::string& what);

}  // namespace clearway::host
