// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace clearway::screen {

/// What a piece of text is, for the terminal to show as it can. None says anything that words or
/// marks beside it do not say too.
enum class Style {
  kPlain,
  kTitle,    ///< The first line.
  kBanner,   ///< What nobody may overlook.
  kHeader,   ///< Over the columns of a table, and between parts.
  kStrong,   ///< Groups, names, keys.
  kTrouble,  ///< Somebody ought to look at it.
  kBusy,     ///< On its way.
  kDim,      ///< Not known, or not important.
};

struct Span {
  std::string text;  ///< Printable (text_cells.hpp).
  Style style = Style::kPlain;
};

/// One row of the screen, never wider than it.
struct Line {
  std::vector<Span> spans;
  bool is_selected = false;
};

[[nodiscard]] std::string TextOf(const Line& line);

/// Writes one line from left to right; what does not fit is cut. All text may come from outside: it
/// is made printable here.
class LineWriter {
 public:
  explicit LineWriter(int cells) : cells_(cells) {}

  [[nodiscard]] int column() const { return column_; }
  [[nodiscard]] int left() const { return cells_ - column_; }

  LineWriter& Add(std::string_view text, Style style = Style::kPlain);
  /// Exactly `cells` and one blank after them.
  LineWriter& Cell(std::string_view text, int cells, Style style = Style::kPlain);
  /// The same, to the right.
  LineWriter& RightCell(std::string_view text, int cells, Style style = Style::kPlain);
  LineWriter& SkipTo(int column, Style style = Style::kPlain);
  /// Blanks to the right edge.
  LineWriter& Fill(Style style) { return SkipTo(cells_, style); }
  [[nodiscard]] Line Take() { return std::move(line_); }

 private:
  void Append(std::string printable, Style style);

  int cells_;
  int column_ = 0;
  Line line_;
};

/// Short numbers with their unit: "12 MB", "1.4 GB"; "0.3 s", "12 s", "4 min", "2.5 h", "3 d".
[[nodiscard]] std::string BytesInWords(std::int64_t bytes);
[[nodiscard]] std::string TimeInWords(std::int64_t us);
/// 0 to 1 as "7", "0.4", "100": percent without their sign.
[[nodiscard]] std::string Percent(float share);

}  // namespace clearway::screen
