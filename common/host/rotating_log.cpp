// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/rotating_log.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <ctime>
#include <fcntl.h>
#include <stdexcept>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "common/host/proc_file.hpp"

namespace clearway::host {
namespace {

constexpr std::string_view kNoteMark = "--- ";
constexpr std::int64_t kSecondUs = 1'000'000;

}  // namespace

RotatingLog::RotatingLog(std::filesystem::path path, std::int64_t max_bytes, int files)
    : path_(std::move(path)), max_bytes_(max_bytes), files_(files) {
  if (max_bytes < kMinBytes || files < 1) {
    throw std::invalid_argument("RotatingLog: expected at least one file of 256 bytes or more");
  }
  if (!Open()) throw std::runtime_error(problem_);
}

std::string RotatingLog::problem() const {
  if (problem_.empty()) return {};
  return problem_ + "; " + std::to_string(lost_bytes_) + " bytes lost so far";
}

void RotatingLog::Write(std::string_view text, std::int64_t utime) {
  SetStamp(utime);
  if (text.empty()) return;
  if (!Prepare() || !AppendLossNote()) return Lose(text.size());
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::size_t size = end == std::string_view::npos ? text.size() : end + 1;
    if (!AppendLine({}, text.substr(0, size))) return Lose(text.size());
    text.remove_prefix(size);
  }
  if (Flush() && lost_unnoted_bytes_ == 0) problem_.clear();
}

void RotatingLog::WriteNote(std::string_view text, std::int64_t utime) {
  SetStamp(utime);
  if (!Prepare() || !AppendLossNote()) return Lose(text.size());
  is_within_line_ = false;
  std::string line(text);
  std::replace(line.begin(), line.end(), '\n', ' ');
  if (!AppendLine(kNoteMark, line + '\n')) return Lose(text.size());
  if (Flush() && lost_unnoted_bytes_ == 0) problem_.clear();
}

// Whether there is a file to write to. Somebody may have removed or cut it, or the folder.
bool RotatingLog::Prepare() {
  struct stat status {};
  if (file_.is_open() && fstat(file_.get(), &status) == 0 && status.st_nlink > 0) {
    file_bytes_ = status.st_size;
    if (file_bytes_ == 0) file_ends_within_line_ = false;
    return true;
  }
  return Open();
}

bool RotatingLog::Open() {
  std::error_code ignored;  // open() tells the reason.
  std::filesystem::create_directories(path_.parent_path(), ignored);
  file_.Reset(open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOCTTY, 0644));
  struct stat status {};
  if (!file_.is_open() || fstat(file_.get(), &status) != 0) {
    problem_ = WithReason(path_.string() + ": cannot be written");
    return false;
  }
  file_bytes_ = status.st_size;
  char last = '\n';
  if (file_bytes_ > 0 && pread(file_.get(), &last, 1, file_bytes_ - 1) != 1) last = '\n';
  file_ends_within_line_ = last != '\n';
  is_within_line_ = false;
  return true;
}

std::int64_t RotatingLog::size() const {
  return file_bytes_ + static_cast<std::int64_t>(pending_.size());
}

bool RotatingLog::ends_within_line() const {
  return pending_.empty() ? file_ends_within_line_ : pending_.back() != '\n';
}

// A line, its end, or its next part, at most to its end.
bool RotatingLog::AppendLine(std::string_view mark, std::string_view text) {
  if (!is_within_line_) {
    if (ends_within_line() && !AppendBytes("\n")) return false;
    const auto bytes = static_cast<std::int64_t>(stamp_.size() + 1 + mark.size() + text.size());
    if (size() > 0 && size() + bytes > max_bytes_ && !Rotate()) return false;
    if (!AppendBytes(stamp_) || !AppendBytes(" ") || !AppendBytes(mark)) return false;
  }
  is_within_line_ = text.back() != '\n';
  return AppendBytes(text);
}

bool RotatingLog::AppendBytes(std::string_view bytes) {
  while (!bytes.empty()) {
    if (size() >= max_bytes_ && !Rotate()) return false;
    const auto room = static_cast<std::size_t>(max_bytes_ - size());
    pending_ += bytes.substr(0, room);
    bytes.remove_prefix(std::min(room, bytes.size()));
  }
  return true;
}

// To be called before any other line, so that it stands where something is missing.
bool RotatingLog::AppendLossNote() {
  if (lost_unnoted_bytes_ == 0) return true;
  const std::string note =
      std::to_string(lost_unnoted_bytes_) + " bytes are missing here: " + problem_ + '\n';
  is_within_line_ = false;
  const std::int64_t lost_bytes = lost_bytes_;
  const std::int64_t lost_unnoted_bytes = lost_unnoted_bytes_;
  if (AppendLine(kNoteMark, note) && Flush()) {
    lost_unnoted_bytes_ = 0;
    return true;
  }
  pending_.clear();  // The note itself is no loss.
  lost_bytes_ = lost_bytes;
  lost_unnoted_bytes_ = lost_unnoted_bytes;
  return false;
}

bool RotatingLog::Flush() {
  std::string_view rest = pending_;
  while (!rest.empty()) {
    const ssize_t written = write(file_.get(), rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) break;
    file_bytes_ += written;
    file_ends_within_line_ = rest[static_cast<std::size_t>(written) - 1] != '\n';
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
  if (!rest.empty()) problem_ = WithReason(path_.string() + ": cannot be written");
  const std::size_t lost = rest.size();
  pending_.clear();
  if (lost > 0) Lose(lost);
  return lost == 0;
}

bool RotatingLog::Rotate() {
  if (!Flush()) return false;
  if (files_ == 1) {
    if (ftruncate(file_.get(), 0) != 0) {
      problem_ = WithReason(path_.string() + ": cannot be emptied");
      return false;
    }
    file_bytes_ = 0;
    file_ends_within_line_ = false;
    return true;
  }
  for (int number = files_ - 1; number > 0; --number) {
    const std::string from = NumberedPath(number - 1);
    if (rename(from.c_str(), NumberedPath(number).c_str()) != 0 && errno != ENOENT) {
      problem_ = WithReason(from + ": cannot be renamed");
      return false;
    }
  }
  const bool was_within_line = is_within_line_;
  const bool is_open = Open();
  is_within_line_ = was_within_line && is_open;
  return is_open;
}

std::string RotatingLog::NumberedPath(int number) const {
  return number == 0 ? path_.string() : path_.string() + "." + std::to_string(number);
}

void RotatingLog::Lose(std::size_t bytes) {
  const std::size_t all = bytes + pending_.size();
  pending_.clear();
  lost_bytes_ += static_cast<std::int64_t>(all);
  lost_unnoted_bytes_ += static_cast<std::int64_t>(all);
  is_within_line_ = false;
}

void RotatingLog::SetStamp(std::int64_t utime) {
  std::int64_t second = utime / kSecondUs;
  std::int64_t rest_us = utime % kSecondUs;
  if (rest_us < 0) {
    --second;
    rest_us += kSecondUs;
  }
  if (second != stamp_second_) {
    stamp_second_ = second;
    const std::time_t time = second;
    std::tm local{};
    std::array<char, 64> text{};
    if (localtime_r(&time, &local) == nullptr) local = std::tm{};
    std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S.000%z", &local);
    stamp_ = text.data();
  }
  const std::size_t dot = stamp_.find('.');
  auto milliseconds = rest_us / 1000;
  for (std::size_t i = 3; i > 0; --i, milliseconds /= 10) {
    stamp_[dot + i] = static_cast<char>('0' + milliseconds % 10);
  }
}

}  // namespace clearway::host
