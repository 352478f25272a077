// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace clearway::io {

/// The most that one byte of LZF data can unpack to: 3 bytes give at most 264.
inline constexpr std::size_t kLzfMaxExpansion = 88;

struct LzfResult {
  std::string bytes;       ///< The unpacked data; meaningless when there is a problem.
  std::string problem;     ///< What is wrong with the packed data; empty when nothing is.
  std::size_t offset = 0;  ///< Where in the packed data [bytes].
};

/// Unpacks LZF data that must fill exactly `unpacked_size` bytes and be used up by that. Reads and
/// writes nothing outside of both, whatever the data are. O(unpacked_size).
/// The format: a control byte c < 32 is followed by c + 1 literal bytes; else its upper three bits
/// are a length (7: the next byte is added to it), its lower five bits and one further byte a
/// distance, and length + 2 bytes are repeated from distance + 1 bytes before the end of the
/// output; the two ranges may overlap.
/// Source: M. Lehmann, LibLZF's format, as described in the PCD file format of PCL.
/// @pre unpacked_size <= packed.size() * kLzfMaxExpansion, so that memory is bounded by the input.
[[nodiscard]] LzfResult DecompressLzf(std::string_view packed, std::size_t unpacked_size);

}  // namespace clearway::io
