// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace clearway::config::internal {

/// Levenshtein distance: insertions, deletions and replacements of single characters.
/// O(a.size() * b.size()) time, O(b.size()) memory.
[[nodiscard]] std::size_t EditDistance(std::string_view a, std::string_view b);

/// The known name nearest to `name`, the first of equals. Empty when none is near: more than a
/// third of the name would have to change.
[[nodiscard]] std::string_view NearestName(std::string_view name,
                                           const std::vector<std::string_view>& known);

/// `unknown attribute "leafm"; did you mean "leaf_m"? known: leaf_m min_points`.
[[nodiscard]] std::string DescribeUnknown(std::string_view kind,
                                          std::string_view name,
                                          const std::vector<std::string_view>& known);

}  // namespace clearway::config::internal
