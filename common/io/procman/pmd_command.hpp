// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/io/procman/pmd_content.hpp"
#include "common/io/procman/pmd_cursor.hpp"

namespace clearway::io::internal {

/// Reads a command into the content, or as much of it as can be read.
/// @param group path of the groups around it.
/// @pre the cursor is at the word cmd.
void ParsePmdCommand(PmdCursor& cursor, const std::string& group, PmdContent& content);

}  // namespace clearway::io::internal
