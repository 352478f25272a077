// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "common/core/livox/data_packet.hpp"
#include "common/io/lvx/lvx_format.hpp"
#include "common/io/read_error.hpp"

namespace clearway::io {

/// One data packet of a recording. The views are valid until the reader's next Next().
struct LvxPackage {
  std::uint8_t device_index = 0;  ///< LvxDevice::index of one of the header's devices.
  std::int64_t number = 0;        ///< Of this package, in order of the file: that of its arrival.
  std::int64_t frame = 0;         ///< The frame that it is in, counted from 0.
  std::uint64_t byte = 0;         ///< Where it begins in the file.
  /// A data packet that core::livox::ParsePacket() takes. Version 1.1: the bytes of the wire.
  /// Version 1.0: what it holds, as a packet of type 0, rounded to the wire's millimetres.
  core::livox::ByteView packet;
  /// Version 1.0: its 100 points as the file has them; empty for 1.1.
  std::span<const core::livox::Point> float_points;
};

/// What a file held beside the packages that were given.
struct LvxReport {
  std::int64_t frames = 0;
  std::int64_t packages = 0;         ///< Given.
  std::int64_t foreign_types = 0;    ///< Packages of a type that no MID-70 sends, passed over.
  std::int64_t unknown_devices = 0;  ///< Packages of a device that the header does not list.
  std::int64_t damages = 0;          ///< Places where the file is no LVX file; reading went on at
                                     ///< the next frame.
  std::uint64_t lost_bytes = 0;      ///< Passed over there.
  std::string first_problem;         ///< The first of all these: file, byte, what is there.
  std::optional<std::uint64_t> cut_at;  ///< The file ends inside a frame; what follows this byte
                                        ///< is no whole package.
  std::string cut;                      ///< The same in words; empty where it is whole.
};

/// Reads an LVX file of version 1.0 or 1.1 from front to end, package by package: O(1) memory,
/// whatever its size. A file that was cut short is read as far as it is whole. Damage inside costs
/// what lies between it and the next frame: a frame's header holds its own place, which makes it
/// easy to find. Nothing is taken for points that does not look like a data packet in all its
/// fixed fields. Thread safety: none.
class LvxReader {
 public:
  /// Throws ReadError with the byte when the file cannot be opened or its header is none.
  explicit LvxReader(const std::filesystem::path& path);
  /// The same from memory; `file` is the name for messages.
  LvxReader(std::string bytes, const std::string& file);
  ~LvxReader();
  LvxReader(const LvxReader&) = delete;
  LvxReader& operator=(const LvxReader&) = delete;

  [[nodiscard]] const LvxHeader& header() const;
  /// The device with an index; null when the header lists none.
  [[nodiscard]] const LvxDevice* DeviceWithIndex(std::uint8_t index) const;

  /// The next package; nothing at the end. After the header no content is an error: see report().
  [[nodiscard]] std::optional<LvxPackage> Next();

  [[nodiscard]] const LvxReport& report() const;
  /// How far it has read, for a progress line.
  [[nodiscard]] std::uint64_t position() const;
  [[nodiscard]] std::uint64_t size() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace clearway::io
