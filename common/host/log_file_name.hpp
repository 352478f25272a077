// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace clearway::host {

/// The name of a command's log: its id with ".log", where letters, digits, '_', '-', and '.' but at
/// the beginning stay as they are and any other byte becomes %XX. Two ids never share a name, nor a
/// name that RotatingLog makes of one, and none leaves its folder. Names longer than 200 bytes are
/// cut and told apart by a 128-bit hash of the id.
[[nodiscard]] std::string FileNameOf(std::string_view command_id);

}  // namespace clearway::host
