// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/bin_reader.hpp"

#include <stdexcept>

#include "common/io/file_bytes.hpp"
#include "common/io/pcd_fields.hpp"

namespace clearway::io {

core::PointCloud ReadBin(const std::filesystem::path& path, const BinLayout& layout) {
  return ParseBin(ReadFileBytes(path), path.string(), layout);
}

core::PointCloud ParseBin(std::string_view bytes,
                          const std::string& file,
                          const BinLayout& layout) {
  if (layout.floats_per_point != 3 && layout.floats_per_point != 4) {
    throw std::invalid_argument("floats_per_point must be 3 or 4");
  }
  if (bytes.empty()) throw ErrorInFile(file, "is empty (0 bytes)");
  const auto floats = static_cast<std::size_t>(layout.floats_per_point);
  const std::size_t point_bytes = floats * sizeof(float);
  if (bytes.size() % point_bytes != 0) {
    throw ErrorInFile(file,
                      "has " + std::to_string(bytes.size()) + " bytes, which is no multiple of " +
                          std::to_string(point_bytes) + " (" + std::to_string(floats) +
                          " floats a point): it is cut short, or floats_per_point is wrong");
  }
  core::PointCloud cloud;
  cloud.Reserve(bytes.size() / point_bytes);
  for (const char* p = bytes.data(); p != bytes.data() + bytes.size(); p += point_bytes) {
    const Eigen::Vector3f point(
        LoadLittleEndian<float>(p), LoadLittleEndian<float>(p + 4), LoadLittleEndian<float>(p + 8));
    const double intensity = floats == 4 ? LoadLittleEndian<float>(p + 12) : 0.0;
    cloud.Add(point, ToIntensity(intensity, layout.intensity_scale));
  }
  return cloud;
}

}  // namespace clearway::io
