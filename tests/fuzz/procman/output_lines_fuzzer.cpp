// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as the output of a command, cut anywhere: the lines hold nothing that would steer a
// terminal, are as long as they may be, and do not depend on the cut.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "processes/procman_sheriff/output_lines.hpp"
#include "processes/procman_sheriff/text_cells.hpp"

namespace {

using clearway::screen::CellsOf;
using clearway::screen::OutputLines;

void Require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::size_t cut = bytes.size() * data[0] / 255;
  OutputLines whole;
  OutputLines parts;

  whole.Add(bytes);
  parts.Add(bytes.substr(0, cut));
  parts.Add(bytes.substr(cut));

  Require(whole.first() == parts.first() && whole.end() == parts.end());
  for (std::int64_t i = whole.first(); i < whole.end(); ++i) {
    const std::string& text = whole.At(i).text;
    Require(text == parts.At(i).text);
    Require(text == clearway::screen::Printable(text));
    Require(CellsOf(std::string_view(text)) <= OutputLines::kMaxCells);
    for (const std::string& piece : clearway::screen::Wrapped(text, 7)) {
      Require(CellsOf(std::string_view(piece)) <= 7);
    }
  }
  return 0;
}
