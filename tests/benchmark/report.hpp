// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "tests/benchmark/measure.hpp"

namespace clearway::bench {

/// {"rows": [...]}; a figure that was not measured has no member.
[[nodiscard]] std::string ToJson(const std::vector<Row>& rows);

/// One line a row under a heading; "-" where nothing was measured.
[[nodiscard]] std::string ToTable(const std::vector<Row>& rows);

}  // namespace clearway::bench
