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

/// Reads an LCM log from front to end.
class LcmLogReader {
 public:
  /// Throws ReadError when the file cannot be opened.
  explicit LcmLogReader(const std::filesystem::path& path);
  ~LcmLogReader();
  LcmLogReader(const LcmLogReader&) = delete;
  LcmLogReader& operator=(const LcmLogReader&) = delete;

  /// The next event; nothing at the end of the file. An event that was cut short by a crash of the
  /// logger ends the log, as LCM's own tools have it.
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
