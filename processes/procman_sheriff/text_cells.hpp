// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

/// Text by the cells that it takes on a terminal. Knows no locale: the width of a character is what
/// Unicode's East Asian Width says.
namespace clearway::screen {

inline constexpr char32_t kReplacement = 0xFFFD;

/// The first character of a text.
struct Utf8Step {
  char32_t code = kReplacement;  ///< kReplacement where the bytes are no UTF-8.
  std::size_t bytes = 0;         ///< That it takes; 0: the text is empty.
  bool is_cut = false;           ///< The text ends within a character that is well so far.
};
[[nodiscard]] Utf8Step FirstCharacter(std::string_view text);

void AppendUtf8(char32_t code, std::string& text);

/// 0: it is not shown (controls, marks that combine, what steers the direction of writing), 1 or 2.
[[nodiscard]] int CellsOf(char32_t code);

/// Cells of a text that Printable() has passed.
[[nodiscard]] int CellsOf(std::string_view text);

/// One line of valid UTF-8 in which every character takes one or two cells: breaks and tabs become
/// blanks, bytes that are no UTF-8 U+FFFD, and what takes no cell is left out.
[[nodiscard]] std::string Printable(std::string_view text);

/// @pre text is printable. At most `cells` of it, without any sign that it was cut.
[[nodiscard]] std::string_view FirstCells(std::string_view text, int cells);

/// @pre text is printable. At most `cells`; one that was cut ends in "..".
[[nodiscard]] std::string Shortened(std::string_view text, int cells);

/// @pre text is printable. Pieces of at most `cells` > 1 each; not empty. Breaks at a blank where
/// one is in the last third of the piece.
[[nodiscard]] std::vector<std::string> Wrapped(std::string_view text, int cells);

}  // namespace clearway::screen
