// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>

#include <CLI/CLI.hpp>

namespace clearway::graph {

/// A check of command-line numbers that refuses NaN and infinities, which CLI11's ranges let pass.
inline CLI::Validator Finite() {
  return CLI::Validator(
      [](const std::string& text) {
        double value = 0.0;
        const bool is_finite = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
        return is_finite ? std::string() : "expected a finite number, not " + text;
      },
      "");
}

}  // namespace clearway::graph
