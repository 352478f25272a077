// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/pcd_binary.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/io/file_bytes.hpp"
#include "common/io/lzf.hpp"
#include "common/io/read_error.hpp"

namespace clearway::io {

namespace {

/// Where the values of the fields lie: value i of a field at base + i * stride.
class Layout {
 public:
  /// @param by_point true: point after point; false: field after field.
  Layout(const PcdBody& body, std::string_view values, bool by_point)
      : body_(body), values_(values), by_point_(by_point) {}

  [[nodiscard]] core::PointCloud Read() const {
    const auto points = static_cast<std::size_t>(body_.header.points);
    core::PointCloud cloud;
    cloud.x = Coordinates(body_.selection.xyz[0]);
    cloud.y = Coordinates(body_.selection.xyz[1]);
    cloud.z = Coordinates(body_.selection.xyz[2]);
    cloud.intensity.resize(points);
    cloud.tag.resize(points);
    cloud.time_offset_us.resize(points);
    for (std::size_t i = 0; body_.selection.intensity && i < points; ++i) {
      cloud.intensity[i] = ToIntensity(Value(*body_.selection.intensity, i), body_.intensity_scale);
    }
    return cloud;
  }

 private:
  [[nodiscard]] std::vector<float> Coordinates(std::size_t field) const {
    std::vector<float> values(static_cast<std::size_t>(body_.header.points));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = ToCoordinate(Value(field, i));
    return values;
  }

  [[nodiscard]] double Value(std::size_t index, std::size_t point) const {
    const PcdField& field = body_.header.fields[index];
    const auto points = static_cast<std::size_t>(body_.header.points);
    const std::size_t offset = by_point_ ? field.offset + point * body_.header.point_bytes
                                         : field.offset * points + point * field.size * field.count;
    return LoadPcdValue(field, values_.data() + offset);
  }

  const PcdBody& body_;
  std::string_view values_;
  bool by_point_;
};

/// True when `need` = POINTS * point_bytes is at most `available`; no overflow.
bool HoldsPoints(const PcdHeader& header, std::uint64_t points, std::size_t available) {
  return points <= available / header.point_bytes;
}

std::string NeededBytes(const PcdHeader& header) {
  return std::to_string(header.points) + " points of " + std::to_string(header.point_bytes) +
         " bytes";
}

void CheckPadding(const PcdBody& body, std::size_t end_of_data) {
  std::string_view tail = body.bytes.substr(end_of_data);
  if (tail.ends_with('\n')) tail.remove_suffix(1);
  if (tail.ends_with('\r')) tail.remove_suffix(1);
  const std::size_t first = tail.find_first_not_of('\0');
  if (first == tail.npos) return;
  throw ErrorAtByte(body.file,
                    end_of_data + first,
                    "data go on after the " + NeededBytes(body.header) +
                        " that the header announces; expected the end of the file, or zero bytes");
}

void CheckLayout(const PcdBody& body, std::size_t available) {
  const PcdHeader& header = body.header;
  const std::uint64_t grid = header.width * header.height;
  if (grid <= header.points || !HoldsPoints(header, grid, available)) return;
  throw ErrorAtByte(body.file,
                    header.body_offset,
                    "WIDTH * HEIGHT is " + std::to_string(grid) + ", POINTS " +
                        std::to_string(header.points) +
                        ", and there are data for either: which is meant cannot be told");
}

struct PackedSizes {
  std::size_t packed;
  std::size_t unpacked;
};

constexpr std::size_t kSizesBytes = 8;

PackedSizes ReadSizes(const PcdBody& body) {
  const std::size_t start = body.header.body_offset;
  const std::size_t available = body.bytes.size() - start;
  if (available < kSizesBytes) {
    throw ErrorAtByte(body.file,
                      start,
                      "the file ends " + std::to_string(available) +
                          " bytes after its header; expected the two 4-byte sizes of the "
                          "compressed data: it is cut short");
  }
  const char* bytes = body.bytes.data() + start;
  const PackedSizes sizes = {.packed = LoadLittleEndian<std::uint32_t>(bytes),
                             .unpacked = LoadLittleEndian<std::uint32_t>(bytes + 4)};
  if (sizes.packed > available - kSizesBytes) {
    throw ErrorAtByte(body.file,
                      start,
                      "compressed size is " + std::to_string(sizes.packed) + " bytes, but only " +
                          std::to_string(available - kSizesBytes) + " follow: it is cut short");
  }
  if (!HoldsPoints(body.header, body.header.points, sizes.unpacked) ||
      body.header.points * body.header.point_bytes != sizes.unpacked) {
    throw ErrorAtByte(body.file,
                      start + 4,
                      "uncompressed size is " + std::to_string(sizes.unpacked) +
                          " bytes; expected that of " + NeededBytes(body.header));
  }
  if (sizes.unpacked / kLzfMaxExpansion > sizes.packed) {
    throw ErrorAtByte(body.file,
                      start,
                      "compressed size is " + std::to_string(sizes.packed) +
                          " bytes; they cannot unpack to " + std::to_string(sizes.unpacked));
  }
  return sizes;
}

}  // namespace

core::PointCloud ReadPcdBinary(const PcdBody& body) {
  const PcdHeader& header = body.header;
  const std::size_t available = body.bytes.size() - header.body_offset;
  if (!HoldsPoints(header, header.points, available)) {
    throw ErrorAtByte(body.file,
                      header.body_offset,
                      std::to_string(available) + " bytes of data follow; expected " +
                          NeededBytes(header) + ": the file is cut short");
  }
  CheckLayout(body, available);
  const auto size = static_cast<std::size_t>(header.points) * header.point_bytes;
  CheckPadding(body, header.body_offset + size);
  return Layout(body, body.bytes.substr(header.body_offset, size), true).Read();
}

core::PointCloud ReadPcdCompressed(const PcdBody& body) {
  const std::size_t start = body.header.body_offset;
  if (body.header.points == 0) {
    CheckPadding(body, start);  // The two sizes are 0 then, or not there.
    return {};
  }
  const PackedSizes sizes = ReadSizes(body);
  CheckPadding(body, start + kSizesBytes + sizes.packed);
  const std::string_view packed = body.bytes.substr(start + kSizesBytes, sizes.packed);
  const LzfResult result = DecompressLzf(packed, sizes.unpacked);
  if (result.problem.empty()) return Layout(body, result.bytes, false).Read();
  if (sizes.packed == sizes.unpacked) return Layout(body, packed, false).Read();
  throw ErrorAtByte(body.file, start + kSizesBytes + result.offset, result.problem);
}

}  // namespace clearway::io
