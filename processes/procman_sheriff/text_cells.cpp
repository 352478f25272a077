// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/text_cells.hpp"

#include <algorithm>
#include <array>

namespace clearway::screen {
namespace {

struct Range {
  char32_t first;
  char32_t last;
};

// Source: Unicode 15 EastAsianWidth.txt, W and F, with what lies unassigned between them.
constexpr std::array kWide = {
    Range{0x1100, 0x115F},   Range{0x231A, 0x231B},   Range{0x2329, 0x232A},
    Range{0x23E9, 0x23EC},   Range{0x23F0, 0x23F0},   Range{0x23F3, 0x23F3},
    Range{0x25FD, 0x25FE},   Range{0x2614, 0x2615},   Range{0x2648, 0x2653},
    Range{0x267F, 0x267F},   Range{0x2693, 0x2693},   Range{0x26A1, 0x26A1},
    Range{0x26AA, 0x26AB},   Range{0x26BD, 0x26BE},   Range{0x26C4, 0x26C5},
    Range{0x26CE, 0x26CE},   Range{0x26D4, 0x26D4},   Range{0x26EA, 0x26EA},
    Range{0x26F2, 0x26F3},   Range{0x26F5, 0x26F5},   Range{0x26FA, 0x26FA},
    Range{0x26FD, 0x26FD},   Range{0x2705, 0x2705},   Range{0x270A, 0x270B},
    Range{0x2728, 0x2728},   Range{0x274C, 0x274C},   Range{0x274E, 0x274E},
    Range{0x2753, 0x2755},   Range{0x2757, 0x2757},   Range{0x2795, 0x2797},
    Range{0x27B0, 0x27B0},   Range{0x27BF, 0x27BF},   Range{0x2B1B, 0x2B1C},
    Range{0x2B50, 0x2B50},   Range{0x2B55, 0x2B55},   Range{0x2E80, 0x303E},
    Range{0x3041, 0x4DBF},   Range{0x4E00, 0xA4CF},   Range{0xA960, 0xA97C},
    Range{0xAC00, 0xD7A3},   Range{0xF900, 0xFAFF},   Range{0xFE10, 0xFE19},
    Range{0xFE30, 0xFE6B},   Range{0xFF01, 0xFF60},   Range{0xFFE0, 0xFFE6},
    Range{0x16FE0, 0x18CFF}, Range{0x1AFF0, 0x1B2FB}, Range{0x1F004, 0x1F004},
    Range{0x1F0CF, 0x1F0CF}, Range{0x1F18E, 0x1F18E}, Range{0x1F191, 0x1F19A},
    Range{0x1F200, 0x1F320}, Range{0x1F32D, 0x1F335}, Range{0x1F337, 0x1F37C},
    Range{0x1F37E, 0x1F393}, Range{0x1F3A0, 0x1F3CA}, Range{0x1F3CF, 0x1F3D3},
    Range{0x1F3E0, 0x1F3F0}, Range{0x1F3F4, 0x1F3F4}, Range{0x1F3F8, 0x1F43E},
    Range{0x1F440, 0x1F440}, Range{0x1F442, 0x1F4FC}, Range{0x1F4FF, 0x1F53D},
    Range{0x1F54B, 0x1F54E}, Range{0x1F550, 0x1F567}, Range{0x1F57A, 0x1F57A},
    Range{0x1F595, 0x1F596}, Range{0x1F5A4, 0x1F5A4}, Range{0x1F5FB, 0x1F64F},
    Range{0x1F680, 0x1F6C5}, Range{0x1F6CC, 0x1F6CC}, Range{0x1F6D0, 0x1F6D2},
    Range{0x1F6D5, 0x1F6DF}, Range{0x1F6EB, 0x1F6EC}, Range{0x1F6F4, 0x1F6FC},
    Range{0x1F7E0, 0x1F7F0}, Range{0x1F90C, 0x1F93A}, Range{0x1F93C, 0x1F945},
    Range{0x1F947, 0x1F9FF}, Range{0x1FA70, 0x1FAFF}, Range{0x20000, 0x3FFFD}};

// Marks that combine in the scripts that most logs hold, and what has no shape of its own.
constexpr std::array kUnseen = {
    Range{0x0000, 0x001F}, Range{0x007F, 0x009F},   Range{0x00AD, 0x00AD},   Range{0x0300, 0x036F},
    Range{0x0483, 0x0489}, Range{0x0591, 0x05BD},   Range{0x05BF, 0x05BF},   Range{0x05C1, 0x05C2},
    Range{0x05C4, 0x05C5}, Range{0x05C7, 0x05C7},   Range{0x0600, 0x0605},   Range{0x0610, 0x061C},
    Range{0x064B, 0x065F}, Range{0x0670, 0x0670},   Range{0x06D6, 0x06DD},   Range{0x06DF, 0x06E4},
    Range{0x06E7, 0x06E8}, Range{0x06EA, 0x06ED},   Range{0x0E31, 0x0E31},   Range{0x0E34, 0x0E3A},
    Range{0x0E47, 0x0E4E}, Range{0x1160, 0x11FF},   Range{0x180B, 0x180F},   Range{0x1AB0, 0x1AFF},
    Range{0x1DC0, 0x1DFF}, Range{0x200B, 0x200F},   Range{0x2028, 0x202E},   Range{0x2060, 0x206F},
    Range{0x20D0, 0x20FF}, Range{0x302A, 0x302D},   Range{0x3099, 0x309A},   Range{0xD800, 0xDFFF},
    Range{0xFE00, 0xFE0F}, Range{0xFE20, 0xFE2F},   Range{0xFEFF, 0xFEFF},   Range{0xFFF0, 0xFFFB},
    Range{0xFFFE, 0xFFFF}, Range{0x1F3FB, 0x1F3FF}, Range{0xE0000, 0x10FFFF}};

template <typename Ranges>
bool Holds(const Ranges& ranges, char32_t code) {
  const auto after = std::upper_bound(
      ranges.begin(), ranges.end(), code, [](char32_t c, const Range& r) { return c < r.first; });
  return after != ranges.begin() && code <= std::prev(after)->last;
}

// Bytes of the character that this byte begins, and the least code that may take so many; 0: none.
struct Lead {
  std::size_t bytes;
  char32_t bits;
  char32_t least;
};
Lead LeadOf(unsigned char byte) {
  if (byte < 0x80) return {1, byte, 0};
  if (byte >= 0xC2 && byte < 0xE0) return {2, byte & 0x1FU, 0x80};
  if (byte >= 0xE0 && byte < 0xF0) return {3, byte & 0x0FU, 0x800};
  if (byte >= 0xF0 && byte < 0xF5) return {4, byte & 0x07U, 0x10000};
  return {0, 0, 0};
}

}  // namespace

Utf8Step FirstCharacter(std::string_view text) {
  if (text.empty()) return {};
  const Lead lead = LeadOf(static_cast<unsigned char>(text[0]));
  if (lead.bytes == 0) return {.bytes = 1};
  char32_t code = lead.bits;
  for (std::size_t i = 1; i < lead.bytes; ++i) {
    if (i == text.size()) return {.bytes = i, .is_cut = true};
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte & 0xC0U) != 0x80) return {.bytes = i};
    code = (code << 6U) | (byte & 0x3FU);
  }
  const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < lead.least || code > 0x10FFFF || is_surrogate) return {.bytes = lead.bytes};
  return {.code = code, .bytes = lead.bytes};
}

void AppendUtf8(char32_t code, std::string& text) {
  const auto rest = [&](unsigned shift) {
    text += static_cast<char>(0x80U | ((code >> shift) & 0x3FU));
  };
  if (code < 0x80) {
    text += static_cast<char>(code);
  } else if (code < 0x800) {
    text += static_cast<char>(0xC0U | (code >> 6U));
    rest(0);
  } else if (code < 0x10000) {
    text += static_cast<char>(0xE0U | (code >> 12U));
    rest(6);
    rest(0);
  } else {
    text += static_cast<char>(0xF0U | (code >> 18U));
    rest(12);
    rest(6);
    rest(0);
  }
}

int CellsOf(char32_t code) {
  if (code >= 0x20 && code < 0x7F) return 1;
  if (Holds(kUnseen, code)) return 0;
  return Holds(kWide, code) ? 2 : 1;
}

int CellsOf(std::string_view text) {
  int cells = 0;
  while (!text.empty()) {
    const Utf8Step step = FirstCharacter(text);
    cells += CellsOf(step.code);
    text.remove_prefix(step.bytes);
  }
  return cells;
}

std::string Printable(std::string_view text) {
  std::string printable;
  printable.reserve(text.size());
  while (!text.empty()) {
    const Utf8Step step = FirstCharacter(text);
    text.remove_prefix(step.bytes);
    const bool is_blank = step.code == '\n' || step.code == '\t' || step.code == '\r';
    if (is_blank) {
      printable += ' ';
    } else if (CellsOf(step.code) > 0) {
      AppendUtf8(step.code, printable);
    }
  }
  return printable;
}

std::string_view FirstCells(std::string_view text, int cells) {
  std::size_t bytes = 0;
  while (bytes < text.size()) {
    const Utf8Step step = FirstCharacter(text.substr(bytes));
    cells -= CellsOf(step.code);
    if (cells < 0) break;
    bytes += step.bytes;
  }
  return text.substr(0, bytes);
}

std::string Shortened(std::string_view text, int cells) {
  const std::string_view first = FirstCells(text, cells);
  if (first.size() == text.size() || cells < 4) return std::string(first);
  return std::string(FirstCells(text, cells - 2)) + "..";
}

std::vector<std::string> Wrapped(std::string_view text, int cells) {
  std::vector<std::string> pieces;
  do {
    std::string_view piece = FirstCells(text, cells);
    std::size_t next = piece.size();
    if (piece.empty() && !text.empty()) break;  // Narrower than one character.
    if (piece.size() < text.size() && text[piece.size()] == ' ') {
      ++next;  // The break takes the blank's place.
    } else if (const std::size_t blank = piece.rfind(' '); piece.size() < text.size() &&
                                                           blank != std::string_view::npos &&
                                                           blank > piece.size() * 2 / 3) {
      piece = piece.substr(0, blank);
      next = blank + 1;
    }
    pieces.emplace_back(piece);
    text.remove_prefix(next);
  } while (!text.empty());
  if (pieces.empty()) pieces.emplace_back();
  return pieces;
}

}  // namespace clearway::screen
