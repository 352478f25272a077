// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/screen_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "processes/procman_sheriff/text_cells.hpp"

namespace clearway::screen {
namespace {

// Two digits at least: "1.4", "14", "140".
std::string Rounded(double value) {
  std::array<char, 32> text{};
  // What is rounded to 10 has no digit after the point either.
  std::snprintf(text.data(), text.size(), value < 9.95 ? "%.1f" : "%.0f", value);
  return text.data();
}

}  // namespace

std::string TextOf(const Line& line) {
  std::string text;
  for (const Span& span : line.spans) text += span.text;
  return text;
}

void LineWriter::Append(std::string printable, Style style) {
  if (printable.empty()) return;
  column_ += CellsOf(std::string_view(printable));
  if (!line_.spans.empty() && line_.spans.back().style == style) {
    line_.spans.back().text += printable;
  } else {
    line_.spans.push_back({std::move(printable), style});
  }
}

LineWriter& LineWriter::Add(std::string_view text, Style style) {
  if (left() > 0) Append(Shortened(Printable(text), left()), style);
  return *this;
}

LineWriter& LineWriter::Cell(std::string_view text, int cells, Style style) {
  const int end = column_ + cells;
  if (left() > 0) Append(Shortened(Printable(text), std::min(cells, left())), style);
  return SkipTo(end + 1);
}

LineWriter& LineWriter::RightCell(std::string_view text, int cells, Style style) {
  const int width = CellsOf(std::string_view(Printable(text)));
  const int end = column_ + cells;
  SkipTo(end - std::min(width, cells));
  return Cell(text, end - column_, style);
}

LineWriter& LineWriter::SkipTo(int column, Style style) {
  const int blanks = std::min(column, cells_) - column_;
  if (blanks > 0) Append(std::string(static_cast<std::size_t>(blanks), ' '), style);
  return *this;
}

std::string BytesInWords(std::int64_t bytes) {
  constexpr std::array kUnits = {" B", " kB", " MB", " GB", " TB", " PB", " EB"};
  auto value = static_cast<double>(bytes);
  std::size_t unit = 0;
  while (value >= 999.5 && unit + 1 < kUnits.size()) {
    value /= 1024;
    ++unit;
  }
  return (unit == 0 ? std::to_string(bytes) : Rounded(value)) + kUnits.at(unit);
}

std::string TimeInWords(std::int64_t us) {
  const double seconds = static_cast<double>(std::max<std::int64_t>(us, 0)) / 1e6;
  if (seconds < 99.5) return Rounded(seconds) + " s";
  if (seconds < 99.5 * 60) return Rounded(seconds / 60) + " min";
  if (seconds < 47.5 * 3600) return Rounded(seconds / 3600) + " h";
  return Rounded(seconds / 86400) + " d";
}

std::string Percent(float share) {
  if (!std::isfinite(share) || share < 0) return "-";
  return Rounded(std::min(static_cast<double>(share), 99.0) * 100);
}

}  // namespace clearway::screen
