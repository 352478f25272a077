// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace clearway::graph {

/// A program's outputs replace files: never one that it reads. Throws std::runtime_error when one
/// of `written` is one of `read`, by whatever name. Empty paths and files that are not there count
/// for nothing.
void RefuseToOverwrite(const std::vector<std::filesystem::path>& written,
                       const std::vector<std::filesystem::path>& read);

/// Replaces the file by `text`. Throws std::runtime_error with the file and the system's reason.
void WriteFile(const std::filesystem::path& path, const std::string& text);

}  // namespace clearway::graph
