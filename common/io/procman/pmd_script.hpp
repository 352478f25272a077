// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/io/procman/pmd_content.hpp"
#include "common/io/procman/pmd_cursor.hpp"

namespace clearway::io::internal {

/// Reads a script into the content, or as much of it as can be read.
/// @pre the cursor is at the word script.
void ParsePmdScript(PmdCursor& cursor, PmdContent& content);

}  // namespace clearway::io::internal
