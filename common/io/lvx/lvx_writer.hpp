// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>

#include "common/core/livox/little_endian.hpp"
#include "common/io/lvx/lvx_format.hpp"

namespace clearway::io {

/// Writes an LVX file of version 1.1 that the vendor's tools read. A frame is written as a whole
/// when it ends, with the place of the next one, so that a recording that is not closed, or whose
/// program is killed, is a good file up to its last whole frame. Thread safety: none.
class LvxWriter {
 public:
  /// Replaces an existing file. Throws std::runtime_error when it cannot be written, and
  /// std::invalid_argument for a header without devices, with more than 255, with an index twice,
  /// or with a code of more than 16 characters.
  LvxWriter(const std::filesystem::path& path, const LvxHeader& header);
  /// Closes; what goes wrong then is not told.
  ~LvxWriter();
  LvxWriter(const LvxWriter&) = delete;
  LvxWriter& operator=(const LvxWriter&) = delete;

  /// Puts a packet, as it was on the wire, into the frame that is open. False, and counted as
  /// refused, for what the format cannot hold: packets that are no data packets or not full (no
  /// length is stored), and devices that the header does not list.
  bool Add(std::uint8_t device_index, core::livox::ByteView packet);

  /// The same for a packet that arrived at `utime` [us since the epoch]: frames are cut on the grid
  /// of the header's frame duration that begins with the first packet. A grid cell without a
  /// packet leaves no frame; a clock that goes back begins a new grid.
  bool Add(std::uint8_t device_index, core::livox::ByteView packet, std::int64_t utime);

  /// Writes the frame that is open, also an empty one. Throws std::runtime_error with the file and
  /// the system's reason.
  void EndFrame();

  /// Ends the frame that is open if it holds something, and the file. Nothing may be added after.
  /// Throws as EndFrame().
  void Close();

  [[nodiscard]] std::int64_t frames() const { return frames_; }
  [[nodiscard]] std::int64_t packages() const { return packages_; }
  [[nodiscard]] std::int64_t refused() const { return refused_; }

 private:
  void Write(core::livox::ByteView bytes);
  [[nodiscard]] bool IsListed(std::uint8_t device_index) const;

  std::filesystem::path path_;
  LvxHeader header_;
  std::ofstream stream_;
  std::uint64_t offset_ = 0;  // Bytes of the file so far.
  core::livox::Bytes frame_;  // The frame that is open, its header's room included.
  std::optional<std::int64_t> grid_start_utime_;
  std::int64_t grid_cell_ = 0;
  std::int64_t frames_ = 0;
  std::int64_t packages_ = 0;
  std::int64_t refused_ = 0;
};

}  // namespace clearway::io
