// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/io/procman/pmd_content.hpp"
#include "common/io/procman/pmd_problems.hpp"

namespace clearway::io::internal {

/// Notes names in scripts that the file does not define, and scripts that run themselves, directly
/// or through others. O(n log n) time.
/// @pre the whole file could be read.
void CheckPmdContent(const PmdContent& content, PmdProblems& problems);

}  // namespace clearway::io::internal
