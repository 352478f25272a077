// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include "common/config/problems.hpp"
#include "common/config/schema.hpp"

namespace clearway::config::internal {

/// Applies `element.attribute=value` texts in order; the last one for a value wins. White space
/// around the path and the value is ignored; a text value may be in quotes, as it is printed.
void ApplyOverrides(std::span<const std::string> overrides, Element& root, Problems& problems);

}  // namespace clearway::config::internal
