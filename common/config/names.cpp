// SPDX-License-Identifier: BSD-3-Clause
#include "common/config/names.hpp"

#include <algorithm>
#include <numeric>

#include "common/config/values.hpp"

namespace clearway::config::internal {
namespace {

/// A longer name is no slip of the pen; nothing is suggested for it.
constexpr std::size_t kLongestName = 64;

}  // namespace

std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

std::string_view NearestName(std::string_view name, const std::vector<std::string_view>& known) {
  if (name.size() > kLongestName) return {};
  std::string_view nearest;
  std::size_t least = (name.size() + 2) / 3 + 1;
  for (const std::string_view candidate : known) {
    const std::size_t distance = EditDistance(name, candidate);
    if (distance >= least) continue;
    least = distance;
    nearest = candidate;
  }
  return nearest;
}

std::string DescribeUnknown(std::string_view kind,
                            std::string_view name,
                            const std::vector<std::string_view>& known) {
  std::string text = "unknown " + std::string(kind) + " \"" + Shown(name) + "\"; ";
  const std::string_view nearest = NearestName(name, known);
  if (!nearest.empty()) text += Concat({"did you mean \"", nearest, "\"? "});
  text += "known:";
  for (const std::string_view candidate : known) text += Concat({" ", candidate});
  return known.empty() ? text + " none" : text;
}

}  // namespace clearway::config::internal
