// SPDX-License-Identifier: BSD-3-Clause
#include "tests/unit/io/pcd_maker.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iomanip>
#include <random>
#include <sstream>

namespace clearway::test {

namespace {

template <typename T>
std::string Bytes(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

struct Field {
  std::string name;
  char type;
  std::size_t size;
  std::size_t count;
};

std::vector<Field> RandomFields(std::mt19937& random) {
  const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  constexpr std::size_t kSizes[] = {1, 2, 4, 8};
  std::vector<Field> fields;
  for (const char* axis : {"x", "y", "z"}) {
    const bool is_float = pick(4) != 0;
    fields.push_back({axis, is_float ? 'F' : 'I', kSizes[is_float ? 2 + pick(2) : pick(4)], 1});
  }
  if (pick(3) != 0) fields.push_back({"intensity", "UIF"[pick(3)], 4, 1 + pick(2)});
  for (std::size_t extra = pick(4); extra > 0; --extra) {
    fields.push_back(
        {"extra" + std::to_string(extra), "UI"[pick(2)], kSizes[pick(4)], 1 + pick(3)});
  }
  for (std::size_t padding = pick(3); padding > 0; --padding) {
    fields.push_back({"_", 'U', 1, pick(5)});
  }
  std::shuffle(fields.begin(), fields.end(), random);
  return fields;
}

double RandomValue(const Field& field, std::mt19937& random) {
  if (field.type == 'F') {
    const double value = std::uniform_real_distribution<double>(-300.0, 300.0)(random);
    return field.size == 4 ? static_cast<double>(static_cast<float>(value)) : value;
  }
  const double value = static_cast<double>(random() % 128);
  return field.type == 'I' && random() % 2 == 0 ? -value : value;
}

std::string Line(const std::string& key, const std::vector<Field>& fields, int what) {
  std::ostringstream line;
  line << key;
  for (const Field& field : fields) {
    line << ' ';
    if (what == 0) line << field.name;
    if (what == 1) line << field.size;
    if (what == 2) line << field.type;
    if (what == 3) line << field.count;
  }
  return line.str();
}

}  // namespace

std::string Render(const PcdRecipe& recipe) {
  std::string text = "# .PCD v0.7 - Point Cloud Data file format" + recipe.line_end;
  for (const std::string& line : {recipe.version,
                                  recipe.fields,
                                  recipe.size,
                                  recipe.type,
                                  recipe.count,
                                  recipe.width,
                                  recipe.height,
                                  recipe.viewpoint,
                                  recipe.points,
                                  recipe.data}) {
    if (!line.empty()) text += line + recipe.line_end;
  }
  return text + recipe.body;
}

std::string Encode(double value, char type, std::size_t size) {
  if (type == 'F') return size == 4 ? Bytes(static_cast<float>(value)) : Bytes(value);
  // Two's complement: the low bytes of the 64-bit number are the number of fewer bytes.
  return Bytes(static_cast<std::int64_t>(value)).substr(0, size);
}

std::string StoreLzf(std::string_view bytes) {
  std::string packed;
  for (std::size_t i = 0; i < bytes.size(); i += 32) {
    const std::string_view run = bytes.substr(i, 32);
    packed += static_cast<char>(run.size() - 1);
    packed += run;
  }
  return packed;
}

std::string CompressLzf(std::string_view bytes) {
  constexpr std::size_t kReach = 8192;
  constexpr std::size_t kLongest = 264;
  std::string packed;
  std::size_t literals = 0;
  std::size_t i = 0;
  while (i < bytes.size()) {
    std::size_t length = 0;
    std::size_t distance = 0;
    for (std::size_t back = 1; back <= std::min(i, kReach) && length < kLongest; ++back) {
      std::size_t n = 0;
      while (n < kLongest && i + n < bytes.size() && bytes[i + n] == bytes[i + n - back]) ++n;
      if (n > length) {
        length = n;
        distance = back - 1;
      }
    }
    if (length < 3) {
      ++i;
      ++literals;
      continue;
    }
    packed += StoreLzf(bytes.substr(i - literals, literals));
    literals = 0;
    const std::size_t stated = length - 2;
    packed += static_cast<char>(std::min<std::size_t>(stated, 7) << 5U | distance >> 8U);
    if (stated >= 7) packed += static_cast<char>(stated - 7);
    packed += static_cast<char>(distance & 0xffU);
    i += length;
  }
  return packed + StoreLzf(bytes.substr(i - literals, literals));
}

std::string CompressedBody(std::string_view packed, std::size_t unpacked_size) {
  return Bytes(static_cast<std::uint32_t>(packed.size())) +
         Bytes(static_cast<std::uint32_t>(unpacked_size)) + std::string(packed);
}

PcdTriple MakeRandomPcd(unsigned seed) {
  std::mt19937 random(seed);
  const std::vector<Field> fields = RandomFields(random);
  PcdTriple triple;
  triple.num_points = random() % 40;
  std::ostringstream rows;
  rows << std::setprecision(17);
  std::string by_point;
  std::vector<std::string> by_field(fields.size());
  for (std::size_t i = 0; i < triple.num_points; ++i) {
    triple.intensity.push_back(0);
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const Field& field = fields[f];
      for (std::size_t c = 0; c < field.count; ++c) {
        const double value = RandomValue(field, random);
        if (field.name == "x") triple.x.push_back(static_cast<float>(value));
        if (field.name == "y") triple.y.push_back(static_cast<float>(value));
        if (field.name == "z") triple.z.push_back(static_cast<float>(value));
        if (field.name == "intensity" && c == 0) {
          const double rounded = std::round(std::min(255.0, std::max(0.0, value)));
          triple.intensity.back() = static_cast<unsigned char>(rounded);
        }
        by_point += Encode(value, field.type, field.size);
        by_field[f] += Encode(value, field.type, field.size);
        rows << value << ' ';
      }
    }
    rows << '\n';
  }

  const std::string count = std::to_string(triple.num_points);
  PcdRecipe recipe{.fields = Line("FIELDS", fields, 0),
                   .size = Line("SIZE", fields, 1),
                   .type = Line("TYPE", fields, 2),
                   .count = Line("COUNT", fields, 3),
                   .width = "WIDTH " + count,
                   .points = "POINTS " + count,
                   .body = rows.str()};
  triple.ascii = Render(recipe);
  recipe.data = "DATA binary";
  recipe.body = by_point;
  triple.binary = Render(recipe);
  recipe.data = "DATA binary_compressed";
  std::string all_fields;
  for (const std::string& part : by_field) all_fields += part;
  recipe.body = CompressedBody(CompressLzf(all_fields), all_fields.size());
  triple.compressed = Render(recipe);
  return triple;
}

}  // namespace clearway::test
