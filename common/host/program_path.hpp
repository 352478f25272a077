// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace clearway::host {

/// The program that execvp() would run: a name with a slash as it is, any other in the folders of
/// `path_variable`, which ':' separates; an empty one is the working folder. It is a regular file
/// that this process may execute. Nothing when there is none.
[[nodiscard]] std::optional<std::filesystem::path> FindProgram(const std::string& name,
                                                               const std::string& path_variable);

}  // namespace clearway::host
