// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/lvx/lvx_writer.hpp"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <set>
#include <stdexcept>
#include <system_error>

namespace clearway::io {
namespace {

using core::livox::ByteView;
using core::livox::Store;

constexpr std::size_t kFrameHeaderBytes = 24;

void Validate(const LvxHeader& header) {
  constexpr std::size_t kMaxCode = 16;
  if (header.devices.empty() || header.devices.size() > 255) {
    throw std::invalid_argument("an LVX file has 1 to 255 devices, not " +
                                std::to_string(header.devices.size()));
  }
  if (header.frame_duration_ms == 0) throw std::invalid_argument("LVX frames last at least 1 ms");
  std::set<std::uint8_t> indices;
  for (const LvxDevice& device : header.devices) {
    if (device.lidar_code.size() > kMaxCode || device.hub_code.size() > kMaxCode) {
      throw std::invalid_argument("a code of an LVX device has more than 16 characters");
    }
    if (!indices.insert(device.index).second) {
      throw std::invalid_argument("two LVX devices have index " + std::to_string(device.index));
    }
  }
}

}  // namespace

LvxWriter::LvxWriter(const std::filesystem::path& path, const LvxHeader& header)
    : path_(path), header_(header), frame_(kFrameHeaderBytes) {
  Validate(header);
  errno = 0;
  stream_.open(path, std::ios::binary | std::ios::trunc);
  Write(lvx::PackHeader(header));
}

LvxWriter::~LvxWriter() {
  try {
    Close();
  } catch (const std::runtime_error&) {
    // As documented; who wants to know calls Close().
  }
}

bool LvxWriter::Add(std::uint8_t device_index, ByteView packet) {
  assert(stream_.is_open());
  const auto parsed = core::livox::ParsePacket(packet).packet;
  if (!parsed || parsed->shots != parsed->layout.shots_in_packet || !IsListed(device_index)) {
    ++refused_;
    return false;
  }
  frame_.push_back(static_cast<std::byte>(device_index));
  frame_.insert(frame_.end(), packet.begin(), packet.end());
  ++packages_;
  return true;
}

bool LvxWriter::Add(std::uint8_t device_index, ByteView packet, std::int64_t utime) {
  if (!grid_start_utime_) grid_start_utime_ = utime;
  const std::int64_t duration_us = std::int64_t{1000} * header_.frame_duration_ms;
  const std::int64_t cell_start = *grid_start_utime_ + grid_cell_ * duration_us;
  if (utime < cell_start || utime >= cell_start + duration_us) {
    if (frame_.size() > kFrameHeaderBytes) EndFrame();
    if (utime < cell_start) grid_start_utime_ = utime;
    grid_cell_ = (utime - *grid_start_utime_) / duration_us;
  }
  return Add(device_index, packet);
}

void LvxWriter::EndFrame() {
  Store(std::span(frame_), 0, offset_);
  Store(std::span(frame_), 8, offset_ + frame_.size());
  Store(std::span(frame_), 16, static_cast<std::uint64_t>(frames_));
  Write(frame_);
  frame_.resize(kFrameHeaderBytes);
  ++frames_;
}

void LvxWriter::Close() {
  if (!stream_.is_open()) return;
  if (frame_.size() > kFrameHeaderBytes) EndFrame();
  errno = 0;
  stream_.close();
  if (stream_.fail()) {
    throw std::runtime_error(path_.string() +
                             ": cannot be written: " + std::generic_category().message(errno));
  }
}

void LvxWriter::Write(ByteView bytes) {
  errno = 0;
  // Flushed, so that a full disk shows with the frame that it refuses and a crash loses none.
  stream_.write(reinterpret_cast<const char*>(bytes.data()),
                static_cast<std::streamsize>(bytes.size()));
  stream_.flush();
  if (!stream_) {
    throw std::runtime_error(path_.string() +
                             ": cannot be written: " + std::generic_category().message(errno));
  }
  offset_ += bytes.size();
}

bool LvxWriter::IsListed(std::uint8_t device_index) const {
  return std::any_of(header_.devices.begin(), header_.devices.end(), [&](const LvxDevice& device) {
    return device.index == device_index;
  });
}

}  // namespace clearway::io
