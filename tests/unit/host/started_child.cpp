// SPDX-License-Identifier: BSD-3-Clause
#include "tests/unit/host/started_child.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <poll.h>
#include <stdexcept>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace clearway::test {

host::ChildSettings TestChild(const std::vector<std::string>& arguments) {
  host::ChildSettings settings;
  settings.program = TEST_CHILD;
  settings.arguments = {"child"};
  settings.arguments.insert(settings.arguments.end(), arguments.begin(), arguments.end());
  settings.environment = {"PATH=/usr/bin:/bin"};
  return settings;
}

bool HasEnded(pid_t pid, int timeout_ms) {
  const host::Descriptor process(static_cast<int>(syscall(SYS_pidfd_open, pid, 0)));
  if (!process.is_open()) return errno == ESRCH;
  pollfd ended{process.get(), POLLIN, 0};
  return poll(&ended, 1, timeout_ms) == 1;
}

StartedChild::StartedChild(const host::ChildSettings& settings)
    : child_(host::StartOnTerminal(settings)), output_(child_.output_fd) {}

StartedChild::~StartedChild() {
  if (is_reaped_) return;
  kill(child_.pid, SIGKILL);
  waitpid(child_.pid, nullptr, 0);
}

bool StartedChild::ReadPart() {
  pollfd output{output_.get(), POLLIN, 0};
  if (poll(&output, 1, kTimeoutMs) != 1) throw std::runtime_error("nothing came: " + text_);
  std::array<char, 65536> buffer;
  const host::OutputPart part = host::ReadOutput(output_.get(), buffer);
  text_.append(buffer.data(), part.size);
  return !part.is_over;
}

std::string StartedChild::ReadLine() {
  while (text_.find('\n') == std::string::npos) {
    if (!ReadPart()) throw std::runtime_error("no line: " + text_);
  }
  const std::size_t end = text_.find('\n');
  std::string line = text_.substr(0, end);
  text_.erase(0, end + 1);
  return line;
}

pid_t StartedChild::ReadPid(const std::string& word) {
  const std::string line = ReadLine();
  if (!line.starts_with(word)) throw std::runtime_error("expected " + word + ": " + line);
  return std::stoi(line.substr(word.size()));
}

std::string StartedChild::ReadToEnd() {
  while (ReadPart()) {
  }
  return std::exchange(text_, {});
}

int StartedChild::Reap() {
  int status = -1;
  if (!HasEnded(child_.pid)) throw std::runtime_error("the child does not end");
  if (waitpid(child_.pid, &status, 0) == child_.pid) is_reaped_ = true;
  return status;
}

}  // namespace clearway::test
