// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/livox/data_packet.hpp"
#include "common/io/lvx/lvx_reader.hpp"

namespace clearway::test {

/// A package as it is in a file: device index, then a full data packet of this type, whose points
/// all say `seed`. Types of other sensors are filled with bytes.
inline std::string MakePackage(std::uint8_t device, std::uint8_t type, std::uint64_t seed) {
  constexpr std::size_t kBytes[] = {1300, 900, 1344, 960, 1344, 768, 24, 1260, 660};
  std::string package{static_cast<char>(device), 5, 1, 1, 0, 0, 0, 0, 0, 0};
  package += static_cast<char>(type);
  for (unsigned i = 0; i < 8; ++i) package += static_cast<char>((seed >> (8 * i)) & 0xFFU);
  for (std::size_t i = 0; i < kBytes[type]; ++i) {
    package += static_cast<char>((seed + 31 * i) & 0xFFU);
  }
  return package;
}

inline void AppendNumber(std::string& bytes, std::uint64_t number, unsigned count) {
  for (unsigned i = 0; i < count; ++i) bytes += static_cast<char>((number >> (8 * i)) & 0xFFU);
}

inline std::string Padded(std::string text, std::size_t size) {
  text.resize(size);
  return text;
}

/// An LVX file, built from the description of the format by itself.
struct LvxMaker {
  bool is_1_0 = false;
  std::vector<std::uint8_t> devices{0};  ///< Their indices, in the order of the list.
  std::vector<std::vector<std::string>> frames = {};

  [[nodiscard]] std::string Header() const {
    std::string file = Padded("livox_tech", 16);
    file += {1, static_cast<char>(is_1_0 ? 0 : 1), 0, 0, 0x67};
    file += "\xA7\x0E\xAC";
    if (!is_1_0) AppendNumber(file, 50, 4);
    file += static_cast<char>(devices.size());
    for (const std::uint8_t index : devices) {
      file += Padded("3GGDJ6K0010" + std::to_string(index) + "01", 32);
      file += {static_cast<char>(index), 6};
      file += std::string(is_1_0 ? 24 : 25, '\0');
    }
    return file;
  }

  [[nodiscard]] std::string File() const {
    std::string file = Header();
    const std::size_t header_bytes = is_1_0 ? 32 : 24;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      std::string body;
      for (const std::string& package : frames[k]) body += package;
      const std::size_t next = file.size() + header_bytes + body.size();
      AppendNumber(file, file.size(), 8);
      AppendNumber(file, next, 8);
      AppendNumber(file, k, 8);
      if (is_1_0) AppendNumber(file, frames[k].size(), 8);
      file += body;
    }
    return file;
  }
};

/// What a package held.
struct ReadPackage {
  std::uint8_t device_index = 0;
  std::int64_t frame = 0;
  std::uint64_t byte = 0;
  std::string bytes;  ///< Device index and packet, as MakePackage() makes them.
};

inline std::vector<ReadPackage> ReadAll(io::LvxReader& reader) {
  std::vector<ReadPackage> all;
  while (const auto package = reader.Next()) {
    ReadPackage read{package->device_index, package->frame, package->byte, {}};
    read.bytes += static_cast<char>(package->device_index);
    for (const std::byte byte : package->packet) read.bytes += static_cast<char>(byte);
    all.push_back(read);
  }
  return all;
}

inline std::vector<std::string> BytesOf(const std::vector<ReadPackage>& packages) {
  std::vector<std::string> bytes;
  for (const ReadPackage& package : packages) bytes.push_back(package.bytes);
  return bytes;
}

}  // namespace clearway::test
