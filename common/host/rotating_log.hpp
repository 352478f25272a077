// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/host/descriptor.hpp"

namespace clearway::host {

/// The output of a command on disk, each line with the time at which it began:
/// "2026-11-25T08:36:12.345+0000 text". Bytes stay as they are. A full file NAME becomes NAME.1,
/// NAME.1 becomes NAME.2, and so on; between two lines where a line fits into a file. A line that
/// goes over the end of a file goes on in the next one, so that the files, oldest first, are the
/// log.
///
/// What has been written is with the kernel at return, also a line without its end; a crash of the
/// host may lose it. Nothing but the constructor throws: what the disk does not take is counted
/// and lost, each call tries anew, and a note in the log says how much is missing there. A limit of
/// the file size (RLIMIT_FSIZE) sends SIGXFSZ, which the program must ignore.
/// Thread safety: none. Not two of one path.
class RotatingLog {
 public:
  static constexpr std::int64_t kMinBytes = 256;

  /// Appends to what is there. `files` counts NAME itself. Makes the folder. Throws
  /// std::runtime_error when the file cannot be opened, std::invalid_argument for max_bytes below
  /// kMinBytes or no file.
  RotatingLog(std::filesystem::path path, std::int64_t max_bytes, int files);

  /// Appends a part of the command's output that came at `utime` [us since the epoch]. One
  /// system call where no file is full and none was taken away.
  void Write(std::string_view text, std::int64_t utime);

  /// Appends a line of one's own about the command, told apart by dashes:
  /// "2026-11-25T08:36:12.345+0000 --- text". An open line of the output ends before it.
  void WriteNote(std::string_view text, std::int64_t utime);

  /// What is wrong with the log in words; empty: nothing is.
  [[nodiscard]] std::string problem() const;

  /// Bytes that did not reach the disk since the start, about: of a line in part its stamp counts.
  [[nodiscard]] std::int64_t lost_bytes() const { return lost_bytes_; }

 private:
  [[nodiscard]] bool Prepare();
  [[nodiscard]] bool AppendLine(std::string_view mark, std::string_view text);
  [[nodiscard]] bool AppendBytes(std::string_view bytes);
  [[nodiscard]] bool AppendLossNote();
  [[nodiscard]] bool Open();
  [[nodiscard]] bool Rotate();
  [[nodiscard]] bool Flush();
  void Lose(std::size_t bytes);
  void SetStamp(std::int64_t utime);
  [[nodiscard]] std::int64_t size() const;
  [[nodiscard]] bool ends_within_line() const;
  [[nodiscard]] std::string NumberedPath(int number) const;

  std::filesystem::path path_;
  std::int64_t max_bytes_;
  int files_;
  Descriptor file_;
  std::int64_t file_bytes_ = 0;         // On disk.
  bool file_ends_within_line_ = false;  // On disk.
  bool is_within_line_ = false;         // The next byte of the output goes on with a line.
  std::string pending_;                 // Not yet on disk; empty between two calls.
  std::string stamp_;
  std::int64_t stamp_second_ = INT64_MIN;
  std::string problem_;
  std::int64_t lost_bytes_ = 0;
  std::int64_t lost_unnoted_bytes_ = 0;  // Those that no note in the log tells of yet.
};

}  // namespace clearway::host
