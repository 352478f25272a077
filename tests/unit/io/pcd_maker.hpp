// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace clearway::test {

/// The lines of a PCD header as they shall stand in the file; an empty one is left out.
struct PcdRecipe {
  std::string version = "VERSION 0.7";
  std::string fields = "FIELDS x y z";
  std::string size = "SIZE 4 4 4";
  std::string type = "TYPE F F F";
  std::string count = "COUNT 1 1 1";
  std::string width = "WIDTH 2";
  std::string height = "HEIGHT 1";
  std::string viewpoint = "VIEWPOINT 0 0 0 1 0 0 0";
  std::string points = "POINTS 2";
  std::string data = "DATA ascii";
  std::string line_end = "\n";
  std::string body = "1 2 3\n4 5 6\n";  ///< What follows the line end after DATA.
};

[[nodiscard]] std::string Render(const PcdRecipe& recipe);

/// The little-endian bytes of a value as a PCD field of that type (I, U, F) and size.
[[nodiscard]] std::string Encode(double value, char type, std::size_t size);

/// A simple LZF compressor: the longest earlier match within reach, short and long references.
[[nodiscard]] std::string CompressLzf(std::string_view bytes);

/// An LZF stream of literal runs only.
[[nodiscard]] std::string StoreLzf(std::string_view bytes);

/// The body of a binary_compressed file: both sizes and the packed data.
[[nodiscard]] std::string CompressedBody(std::string_view packed, std::size_t unpacked_size);

/// A generated cloud with extra fields, in all three encodings.
struct PcdTriple {
  std::string ascii;
  std::string binary;
  std::string compressed;
  std::size_t num_points = 0;
  std::vector<float> x, y, z;            ///< What a reader must give.
  std::vector<unsigned char> intensity;  ///< Likewise, with a scale of 1.
};

/// Random points below random fields (types, sizes, counts, padding, order); the seed decides.
[[nodiscard]] PcdTriple MakeRandomPcd(unsigned seed);

}  // namespace clearway::test
