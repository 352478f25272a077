// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <istream>
#include <memory>
#include <span>

namespace clearway::io::lvx {

/// A file for reading. Throws ReadError when it cannot be opened.
[[nodiscard]] std::unique_ptr<std::istream> OpenFile(const std::filesystem::path& path);

/// The bytes of an LVX file, and where in them frames begin. Thread safety: none.
class Source {
 public:
  /// @pre the stream can be read and sought.
  explicit Source(std::unique_ptr<std::istream> stream);

  [[nodiscard]] std::uint64_t size() const { return size_; }

  /// Fills `bytes` from the file; false when it does not hold or give them.
  [[nodiscard]] bool ReadAt(std::uint64_t offset, std::span<std::byte> bytes);

  /// Whether a frame begins there: it holds its own place, and where it ends there is the file's
  /// end or the next frame. `header_bytes`: of a frame's header.
  [[nodiscard]] bool IsFrame(std::uint64_t at, std::size_t header_bytes);

  /// The place of the first frame from `at` on, or the end of the file. O(bytes passed over).
  [[nodiscard]] std::uint64_t FindFrame(std::uint64_t at, std::size_t header_bytes);

 private:
  std::unique_ptr<std::istream> stream_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;  // Where the stream stands.
};

}  // namespace clearway::io::lvx
