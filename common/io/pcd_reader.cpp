// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/pcd_reader.hpp"

#include "common/io/file_bytes.hpp"
#include "common/io/pcd_ascii.hpp"
#include "common/io/pcd_binary.hpp"
#include "common/io/pcd_fields.hpp"

namespace clearway::io {

namespace {

core::PointCloud ReadBody(const PcdBody& body) {
  switch (body.header.encoding) {
    case PcdEncoding::kAscii:
      return ReadPcdAscii(body);
    case PcdEncoding::kBinary:
      return ReadPcdBinary(body);
    case PcdEncoding::kBinaryCompressed:
      return ReadPcdCompressed(body);
  }
  return {};
}

}  // namespace

PcdFile ReadPcd(const std::filesystem::path& path, double intensity_scale) {
  return ParsePcd(ReadFileBytes(path), path.string(), intensity_scale);
}

PcdFile ParsePcd(std::string_view bytes, const std::string& file, double intensity_scale) {
  const PcdHeader header = ParsePcdHeader(bytes, file);
  const PcdSelection selection = SelectPcdFields(header, file);
  PcdFile result;
  result.cloud = ReadBody({.bytes = bytes,
                           .file = file,
                           .header = header,
                           .selection = selection,
                           .intensity_scale = intensity_scale});
  result.viewpoint = header.viewpoint;
  const bool is_consistent = header.width * header.height == header.points;
  result.width = is_consistent ? header.width : header.points;
  result.height = is_consistent ? header.height : 1;
  return result;
}

}  // namespace clearway::io
