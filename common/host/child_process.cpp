// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/child_process.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <deque>
#include <fcntl.h>
#include <fstream>
#include <poll.h>
#include <sstream>
#include <stdexcept>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <linux/close_range.h>

#include "common/host/proc_file.hpp"
#include "common/host/process_table.hpp"

namespace clearway::host {
namespace {

constexpr std::size_t kLastLines = 12;

struct Parent {
  pid_t pid;
  int death_signal;
};

// In the child, between fork and exec: only calls that are safe there.
[[noreturn]] void Exec(char* const* arguments, int stderr_fd, int error_fd, const Parent& parent) {
  prctl(PR_SET_PDEATHSIG, parent.death_signal);
  if (getppid() != parent.pid) _exit(127);
  setpgid(0, 0);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  dup2(stderr_fd, STDERR_FILENO);
  close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
  execvp(arguments[0], arguments);
  const int error = errno;
  [[maybe_unused]] const ssize_t written = write(error_fd, &error, sizeof(error));
  _exit(127);
}

int Decode(int status) {
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

std::optional<ResourceUse> UseOf(pid_t pid) {
  constexpr std::size_t kMaxBytes = 65536;
  const auto entry = ReadProcess(pid);
  if (!entry) return std::nullopt;
  ResourceUse use;
  use.cpu_s = SecondsOf(entry->cpu_ticks);
  const std::string file = "/proc/" + std::to_string(pid) + "/smaps_rollup";
  std::istringstream memory(ReadProcFile(file, kMaxBytes).value_or(std::string()));
  for (std::string line; std::getline(memory, line);) {
    if (line.starts_with("Pss:")) use.pss_mb = std::stod(line.substr(4)) * 1024.0 / 1e6;
  }
  return use;
}

std::string LastLinesOf(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::deque<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
    if (lines.size() > kLastLines) lines.pop_front();
  }
  std::string text;
  for (const std::string& line : lines) text += "  " + line + '\n';
  return text;
}

ChildProcess::ChildProcess(std::string name,
                           const std::vector<std::string>& command,
                           const std::filesystem::path& stderr_file,
                           int parent_death_signal)
    : name_(std::move(name)), stderr_file_(stderr_file) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const int stderr_fd = open(stderr_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (stderr_fd < 0) {
    throw std::runtime_error(stderr_file.string() + ": cannot write: " + std::strerror(errno));
  }
  int error_pipe[2];
  if (pipe2(error_pipe, O_CLOEXEC) != 0) {
    close(stderr_fd);
    throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
  }
  const Parent parent{getpid(), parent_death_signal};
  pid_ = fork();
  if (pid_ == 0) Exec(arguments.data(), stderr_fd, error_pipe[1], parent);
  close(stderr_fd);
  close(error_pipe[1]);
  int error = pid_ < 0 ? errno : 0;
  if (pid_ > 0 && read(error_pipe[0], &error, sizeof(error)) == sizeof(error)) {
    waitpid(pid_, nullptr, 0);
  }
  close(error_pipe[0]);
  if (error != 0) {
    throw std::runtime_error("cannot start " + command.front() + ": " + std::strerror(error));
  }
}

ChildProcess::~ChildProcess() {
  if (!ExitStatus()) WaitOrKill(0);
}

std::optional<int> ChildProcess::ExitStatus() {
  int status = 0;
  if (!exit_status_ && waitpid(pid_, &status, WNOHANG) == pid_) exit_status_ = Decode(status);
  return exit_status_;
}

void ChildProcess::Signal(int signal) const {
  if (!exit_status_) kill(pid_, signal);
}

int ChildProcess::WaitOrKill(int timeout_ms) {
  if (ExitStatus()) return *exit_status_;
  const int fd = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  pollfd ended{fd, POLLIN, 0};
  if (fd < 0 || poll(&ended, 1, timeout_ms) != 1) kill(pid_, SIGKILL);
  if (fd >= 0) close(fd);
  int status = 0;
  waitpid(pid_, &status, 0);
  exit_status_ = Decode(status);
  return *exit_status_;
}

std::optional<ResourceUse> ChildProcess::Use() const {
  return exit_status_ ? std::nullopt : UseOf(pid_);
}

}  // namespace clearway::host
