// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace clearway::io {

/// One message of an LCM log.
struct LogEvent {
  std::int64_t utime = 0;  ///< When it was received [us since the epoch].
  std::string channel;
  std::vector<std::byte> bytes;
};

/// Reads an LCM log from front to end. Damage costs the events that it hits: the reader looks for
/// the next event's sync word and goes on (LCM's own library ends the log at the first damage that
/// follows an event, with that event). O(1) memory besides the event.
class LcmLogReader {
 public:
  /// Throws ReadError when the file cannot be opened.
  explicit LcmLogReader(const std::filesystem::path& path);
  ~LcmLogReader();
  LcmLogReader(const LcmLogReader&) = delete;
  LcmLogReader& operator=(const LcmLogReader&) = delete;

  /// The next whole event; nothing at the end of the file. What was cut short by a crash of the
  /// logger is left out. No content of the file is an error.
  [[nodiscard]] std::optional<LogEvent> Next();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes an LCM log that lcm-logplayer reads.
class LcmLogWriter {
 public:
  /// Replaces an existing file. Throws std::runtime_error when it cannot be written.
  explicit LcmLogWriter(const std::filesystem::path& path);
  ~LcmLogWriter();
  LcmLogWriter(const LcmLogWriter&) = delete;
  LcmLogWriter& operator=(const LcmLogWriter&) = delete;

  /// Throws std::runtime_error when the disk refuses it.
  void Write(std::int64_t utime, const std::string& channel, std::span<const std::byte> bytes);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace clearway::io
