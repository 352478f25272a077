// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/lcm_log.hpp"

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <lcm/eventlog.h>

#include "common/io/read_error.hpp"

namespace clearway::io {
namespace {

struct CloseLog {
  void operator()(lcm_eventlog_t* log) const { lcm_eventlog_destroy(log); }
};
using LogHandle = std::unique_ptr<lcm_eventlog_t, CloseLog>;

struct FreeEvent {
  void operator()(lcm_eventlog_event_t* event) const { lcm_eventlog_free_event(event); }
};

}  // namespace

struct LcmLogReader::Impl {
  LogHandle log;
};

struct LcmLogWriter::Impl {
  std::filesystem::path path;
  LogHandle log;
};

LcmLogReader::LcmLogReader(const std::filesystem::path& path)
    : impl_(std::make_unique<Impl>(Impl{LogHandle(lcm_eventlog_create(path.c_str(), "r"))})) {
  if (!impl_->log) throw ReadError(path.string() + ": cannot open: " + std::strerror(errno));
}

LcmLogReader::~LcmLogReader() = default;

std::optional<LogEvent> LcmLogReader::Next() {
  const std::unique_ptr<lcm_eventlog_event_t, FreeEvent> event(
      lcm_eventlog_read_next_event(impl_->log.get()));
  if (!event) return std::nullopt;
  const auto* const data = static_cast<const std::byte*>(event->data);
  return LogEvent{event->timestamp,
                  std::string(event->channel, static_cast<std::size_t>(event->channellen)),
                  {data, data + event->datalen}};
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
  if (lcm_eventlog_write_event(impl_->log.get(), &event) != 0) {
    throw std::runtime_error(impl_->path.string() + ": cannot write: " + std::strerror(errno));
  }
}

}  // namespace clearway::io
