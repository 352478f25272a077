// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/screen_log.hpp"

#include <array>
#include <cstdio>
#include <fcntl.h>
#include <unistd.h>
#include <utility>

namespace clearway::screen {

ScreenLog::ScreenLog(process::LiveRuntime& runtime,
                     std::function<void(const std::string& line)> handler)
    : runtime_(runtime), handler_(std::move(handler)) {
  std::array<int, 2> ends{};
  // A full pipe must not stop what writes to it.
  if (isatty(STDERR_FILENO) == 0 || pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0) return;
  stderr_ = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
  dup2(ends[1], STDERR_FILENO);
  close(ends[1]);
  pipe_ = ends[0];
  runtime_.WatchDescriptor(pipe_, [this] { Read(); });
}

ScreenLog::~ScreenLog() {
  if (pipe_ < 0) return;
  runtime_.UnwatchDescriptor(pipe_);
  std::fflush(stderr);
  dup2(stderr_, STDERR_FILENO);
  handler_ = [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); };
  Read();
  if (!partial_.empty()) handler_(partial_);
  close(stderr_);
  close(pipe_);
}

void ScreenLog::Read() {
  std::array<char, 4096> bytes{};
  for (ssize_t got = 0; (got = read(pipe_, bytes.data(), bytes.size())) > 0;) {
    partial_.append(bytes.data(), static_cast<std::size_t>(got));
  }
  std::size_t end = 0;
  while ((end = partial_.find('\n')) != std::string::npos) {
    handler_(partial_.substr(0, end));
    partial_.erase(0, end + 1);
  }
}

}  // namespace clearway::screen
