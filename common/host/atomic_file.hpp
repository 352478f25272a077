// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string_view>

namespace clearway::host {

/// Puts a file in place whole or not at all, also through a power cut: it is written beside its
/// place, brought to the disk and renamed. A file that is there keeps its permissions; a symbolic
/// link is replaced, not followed. Throws std::runtime_error with the reason.
void ReplaceFile(const std::filesystem::path& path, std::string_view bytes);

}  // namespace clearway::host
