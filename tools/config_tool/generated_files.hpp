// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace clearway::config_tool {

/// What config/default.xml holds: every value of a graph's configuration, with its help.
[[nodiscard]] std::string DefaultXml();

/// What config/reference.md holds: all elements of a configuration, then those of a scene file.
[[nodiscard]] std::string ReferenceMarkdown();

}  // namespace clearway::config_tool
