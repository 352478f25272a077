// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "common/io/procman/pmd_content.hpp"
#include "common/io/procman/pmd_problems.hpp"

namespace clearway::io::internal {

/// Reads a whole file, or as much of it as can be read, and notes the problems. O(n log n) time.
[[nodiscard]] PmdContent ParsePmdContent(std::string_view text, PmdProblems& problems);

}  // namespace clearway::io::internal
