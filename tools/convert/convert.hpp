// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "tools/convert/sinks.hpp"
#include "tools/convert/slice_source.hpp"

namespace clearway::convert {

struct Settings {
  SourceSettings source;
  std::filesystem::path output;
};

/// What a conversion read and wrote.
struct Report {
  Format from = Format::kLvx;
  Format to = Format::kLog;
  SourceCounts read;
  SinkCounts written;
};

/// Reads the input to its end and writes the output. `on_progress` is called now and then with the
/// share that is done, 0..1. Throws std::runtime_error: formats that are the same, an input that
/// cannot be used, an output that cannot be written or holds the input.
Report Convert(const Settings& settings, const std::function<void(double)>& on_progress);

/// One line: scans, points, packets, lost, zero returns, and what was left out.
[[nodiscard]] std::string Describe(const Report& report);

}  // namespace clearway::convert
