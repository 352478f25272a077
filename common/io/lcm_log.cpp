// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/lcm_log.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <lcm/eventlog.h>

#include "common/io/read_error.hpp"

namespace clearway::io {
namespace {

// An event in a file: this word, then the rest of its head, its channel, its data; all numbers
// big-endian. The head: number of the event (8), time (8), lengths of channel (4) and data (4).
constexpr std::uint32_t kSyncWord = 0xEDA1DA01;
constexpr std::size_t kHeadBytes = 24;
// LCM's own limit for what it reads.
constexpr std::int32_t kMaxChannelLength = 1000;

struct Head {
  std::int64_t utime = 0;
  std::int32_t channel_length = 0;
  std::int32_t data_length = 0;
};

std::uint64_t BigEndian(const char* bytes, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i)
    value = value << 8U | static_cast<unsigned char>(bytes[i]);
  return value;
}

struct CloseLog {
  void operator()(lcm_eventlog_t* log) const { lcm_eventlog_destroy(log); }
};
using LogHandle = std::unique_ptr<lcm_eventlog_t, CloseLog>;

}  // namespace

struct LcmLogReader::Impl {
  std::ifstream stream;
  std::uint64_t size = 0;
  std::uint64_t offset = 0;

  // Moves to the byte after the next sync word.
  bool FindSyncWord() {
    std::uint32_t window = 0;
    while (window != kSyncWord) {
      const int byte = stream.rdbuf()->sbumpc();
      if (byte == std::ifstream::traits_type::eof()) return false;
      ++offset;
      window = window << 8U | static_cast<std::uint32_t>(byte);
    }
    return true;
  }

  bool Read(char* bytes, std::size_t count) {
    const auto wanted = static_cast<std::streamsize>(count);
    offset += count;
    return stream.rdbuf()->sgetn(bytes, wanted) == wanted;
  }

  std::optional<Head> ReadHead() {
    std::array<char, kHeadBytes> bytes{};
    if (!Read(bytes.data(), bytes.size())) return std::nullopt;
    return Head{static_cast<std::int64_t>(BigEndian(&bytes[8], 8)),
                static_cast<std::int32_t>(BigEndian(&bytes[16], 4)),
                static_cast<std::int32_t>(BigEndian(&bytes[20], 4))};
  }

  // Whether what the head tells of can follow it in this file.
  [[nodiscard]] bool Fits(const Head& head) const {
    return head.channel_length > 0 && head.channel_length <= kMaxChannelLength &&
           head.data_length >= 0 &&
           static_cast<std::uint64_t>(head.channel_length) +
                   static_cast<std::uint64_t>(head.data_length) <=
               size - offset;
  }

  void MoveTo(std::uint64_t to) {
    stream.rdbuf()->pubseekpos(static_cast<std::streamoff>(to), std::ios::in);
    offset = to;
  }
};

struct LcmLogWriter::Impl {
  std::filesystem::path path;
  LogHandle log;
};

LcmLogReader::LcmLogReader(const std::filesystem::path& path) : impl_(std::make_unique<Impl>()) {
  std::error_code error;
  impl_->size = std::filesystem::file_size(path, error);
  if (error) throw ErrorInFile(path.string(), "cannot open: " + error.message());
  impl_->stream.open(path, std::ios::binary);
  if (!impl_->stream) {
    throw ErrorInFile(path.string(), std::string("cannot open: ") + std::strerror(errno));
  }
}

LcmLogReader::~LcmLogReader() = default;

std::optional<LogEvent> LcmLogReader::Next() {
  while (impl_->FindSyncWord()) {
    const std::uint64_t after_sync_word = impl_->offset;
    const std::optional<Head> head = impl_->ReadHead();
    if (!head) return std::nullopt;
    if (!impl_->Fits(*head)) {
      impl_->MoveTo(after_sync_word);
      continue;
    }
    LogEvent event;
    event.utime = head->utime;
    event.channel.resize(static_cast<std::size_t>(head->channel_length));
    event.bytes.resize(static_cast<std::size_t>(head->data_length));
    if (!impl_->Read(event.channel.data(), event.channel.size()) ||
        !impl_->Read(reinterpret_cast<char*>(event.bytes.data()), event.bytes.size())) {
      return std::nullopt;
    }
    return event;
  }
  return std::nullopt;
}

LcmLogWriter::LcmLogWriter(const std::filesystem::path& path)
    : impl_(std::make_unique<Impl>(Impl{path, LogHandle(lcm_eventlog_create(path.c_str(), "w"))})) {
  if (!impl_->log) {
    throw std::runtime_error(path.string() + ": cannot write: " + std::strerror(errno));
  }
}

LcmLogWriter::~LcmLogWriter() = default;

void LcmLogWriter::Write(std::int64_t utime,
                         const std::string& channel,
                         std::span<const std::byte> bytes) {
  lcm_eventlog_event_t event{};
  event.timestamp = utime;
  event.channellen = static_cast<std::int32_t>(channel.size());
  event.datalen = static_cast<std::int32_t>(bytes.size());
  // LCM's interface is not const-correct; it only reads.
  event.channel = const_cast<char*>(channel.c_str());
  event.data = const_cast<std::byte*>(bytes.data());
  // Flushed, so that a full disk shows with the event that it refuses and a crash loses none.
  if (lcm_eventlog_write_event(impl_->log.get(), &event) != 0 || std::fflush(impl_->log->f) != 0) {
    throw std::runtime_error(impl_->path.string() + ": cannot write: " + std::strerror(errno));
  }
}

}  // namespace clearway::io
