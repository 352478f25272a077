// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/pcd_fields.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/io/file_bytes.hpp"
#include "common/io/read_error.hpp"

namespace clearway::io {

namespace {

std::string FieldNames(const PcdHeader& header) {
  constexpr std::size_t kMaxNamed = 20;
  std::string names;
  for (const PcdField& field : header.fields) {
    if (&field - header.fields.data() == kMaxNamed) return names + " ...";
    const std::string quoted = Quoted(field.name);
    names += (names.empty() ? "" : " ") + quoted.substr(1, quoted.size() - 2);
  }
  return names;
}

std::optional<std::size_t> FindField(const PcdHeader& header,
                                     const std::string& name,
                                     const std::string& file) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < header.fields.size(); ++i) {
    const PcdField& field = header.fields[i];
    if (field.name != name) continue;
    if (found) {
      throw ErrorInFile(file,
                        "field \"" + name + "\" is there twice; FIELDS are: " + FieldNames(header));
    }
    if (field.type == 'F' && field.size < 4) {
      throw ErrorInFile(file,
                        "field \"" + name + "\" is a float of SIZE " + std::to_string(field.size) +
                            "; expected 4 or 8");
    }
    found = i;
  }
  return found;
}

}  // namespace

PcdSelection SelectPcdFields(const PcdHeader& header, const std::string& file) {
  PcdSelection selection;
  constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < kNames.size(); ++axis) {
    const auto found = FindField(header, kNames[axis], file);
    if (!found) {
      throw ErrorInFile(file,
                        "has no field \"" + std::string(kNames[axis]) +
                            "\"; expected x y z, FIELDS are: " + FieldNames(header));
    }
    if (header.fields[*found].count != 1) {
      throw ErrorInFile(file,
                        "field \"" + std::string(kNames[axis]) + "\" has COUNT " +
                            std::to_string(header.fields[*found].count) + "; expected 1");
    }
    selection.xyz[axis] = *found;
  }
  selection.intensity = FindField(header, "intensity", file);
  if (!selection.intensity) selection.intensity = FindField(header, "reflectivity", file);
  return selection;
}

double LoadPcdValue(const PcdField& field, const char* bytes) {
  if (field.type == 'F') {
    return field.size == 4 ? static_cast<double>(LoadLittleEndian<float>(bytes))
                           : LoadLittleEndian<double>(bytes);
  }
  const bool is_signed = field.type == 'I';
  switch (field.size) {
    case 1:
      return is_signed ? LoadLittleEndian<std::int8_t>(bytes)
                       : LoadLittleEndian<std::uint8_t>(bytes);
    case 2:
      return is_signed ? LoadLittleEndian<std::int16_t>(bytes)
                       : LoadLittleEndian<std::uint16_t>(bytes);
    case 4:
      return is_signed ? static_cast<double>(LoadLittleEndian<std::int32_t>(bytes))
                       : static_cast<double>(LoadLittleEndian<std::uint32_t>(bytes));
    default:
      return is_signed ? static_cast<double>(LoadLittleEndian<std::int64_t>(bytes))
                       : static_cast<double>(LoadLittleEndian<std::uint64_t>(bytes));
  }
}

float ToCoordinate(double value) {
  constexpr double kMax = std::numeric_limits<float>::max();
  if (std::abs(value) > kMax) {
    return std::copysign(std::numeric_limits<float>::infinity(), value > 0.0 ? 1.0F : -1.0F);
  }
  return static_cast<float>(value);
}

std::uint8_t ToIntensity(double value, double scale) {
  const double scaled = value * scale;
  if (std::isnan(scaled)) return 0;
  return static_cast<std::uint8_t>(std::lround(std::clamp(scaled, 0.0, 255.0)));
}

}  // namespace clearway::io
