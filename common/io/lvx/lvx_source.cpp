// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/lvx/lvx_source.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>
#include <vector>

#include "common/core/livox/little_endian.hpp"
#include "common/io/read_error.hpp"

namespace clearway::io::lvx {
namespace {

using core::livox::Load;

constexpr std::size_t kWindowBytes = 65536;

}  // namespace

std::unique_ptr<std::istream> OpenFile(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw ErrorInFile(path.string(), "no such file");
  if (!std::filesystem::is_regular_file(status)) throw ErrorInFile(path.string(), "is not a file");
  errno = 0;
  auto stream = std::make_unique<std::ifstream>(path, std::ios::binary);
  if (!*stream) {
    throw ErrorInFile(path.string(), "cannot be read: " + std::generic_category().message(errno));
  }
  return stream;
}

Source::Source(std::unique_ptr<std::istream> stream) : stream_(std::move(stream)) {
  stream_->seekg(0, std::ios::end);
  size_ = static_cast<std::uint64_t>(stream_->tellg());
  position_ = size_;
}

bool Source::ReadAt(std::uint64_t offset, std::span<std::byte> bytes) {
  stream_->clear();
  if (position_ != offset) stream_->seekg(static_cast<std::streamoff>(offset));
  const auto wanted = static_cast<std::streamsize>(bytes.size());
  stream_->read(reinterpret_cast<char*>(bytes.data()), wanted);
  position_ = offset + static_cast<std::uint64_t>(stream_->gcount());
  return stream_->gcount() == wanted;
}

bool Source::IsFrame(std::uint64_t at, std::size_t header_bytes) {
  std::array<std::byte, 16> start{};
  if (at + header_bytes > size_ || !ReadAt(at, start)) return false;
  if (Load<std::uint64_t>(start, 0) != at) return false;
  const auto next = Load<std::uint64_t>(start, 8);
  if (next == 0 || next >= size_) return true;
  if (next < at + header_bytes) return false;
  std::array<std::byte, 8> place{};
  return next + place.size() > size_ ||
         (ReadAt(next, place) && Load<std::uint64_t>(place, 0) == next);
}

std::uint64_t Source::FindFrame(std::uint64_t at, std::size_t header_bytes) {
  std::vector<std::byte> window;
  while (at + header_bytes <= size_) {
    window.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kWindowBytes, size_ - at)));
    if (!ReadAt(at, window)) return size_;
    const std::size_t last = window.size() - sizeof(std::uint64_t);
    for (std::size_t i = 0; i <= last; ++i) {
      if (Load<std::uint64_t>(window, i) == at + i && IsFrame(at + i, header_bytes)) return at + i;
    }
    at += last + 1;
  }
  return size_;
}

}  // namespace clearway::io::lvx
