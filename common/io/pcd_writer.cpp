// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/pcd_writer.hpp"

#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>

namespace clearway::io {

namespace {

constexpr std::size_t kPointBytes = 13;

std::string Header(std::size_t points) {
  const std::string count = std::to_string(points);
  return "# .PCD v0.7 - Point Cloud Data file format\n"
         "VERSION 0.7\n"
         "FIELDS x y z intensity\n"
         "SIZE 4 4 4 1\n"
         "TYPE F F F U\n"
         "COUNT 1 1 1 1\n"
         "WIDTH " +
         count +
         "\n"
         "HEIGHT 1\n"
         "VIEWPOINT 0 0 0 1 0 0 0\n"
         "POINTS " +
         count +
         "\n"
         "DATA binary\n";
}

}  // namespace

void WritePcdBinary(const std::filesystem::path& path, const core::PointCloud& cloud) {
  static_assert(std::endian::native == std::endian::little, "a big-endian host needs a swap here");
  std::string bytes = Header(cloud.size());
  std::size_t position = bytes.size();
  bytes.resize(position + cloud.size() * kPointBytes);
  for (std::size_t i = 0; i < cloud.size(); ++i, position += kPointBytes) {
    std::memcpy(&bytes[position], &cloud.x[i], 4);
    std::memcpy(&bytes[position + 4], &cloud.y[i], 4);
    std::memcpy(&bytes[position + 8], &cloud.z[i], 4);
    bytes[position + 12] = static_cast<char>(cloud.intensity[i]);
  }
  errno = 0;
  std::ofstream stream(path, std::ios::binary | std::ios::trunc);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) {
    throw std::runtime_error(path.string() +
                             ": cannot be written: " + std::generic_category().message(errno));
  }
}

}  // namespace clearway::io
