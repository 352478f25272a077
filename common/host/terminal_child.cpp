// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/terminal_child.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <stdexcept>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <termios.h>

#include "common/host/descriptor.hpp"
#include "common/host/proc_file.hpp"
#include "common/host/process_table.hpp"

namespace clearway::host {
namespace {

constexpr int kCannotRun = 255;  // As the reference procman's deputy.

struct Terminal {
  Descriptor master;
  Descriptor slave;
};

// All that the child needs, made before the fork: it must not allocate.
struct Plan {
  const char* program = nullptr;
  const char* folder = nullptr;  // nullptr: stay.
  std::vector<char*> arguments;
  std::vector<char*> environment;
  int terminal_fd = -1;
  pid_t parent = -1;
  int parent_death_signal = 0;
};

[[noreturn]] void Fail(const std::string& what) {
  throw std::runtime_error(WithReason(what));
}

// Above the three standard descriptors, which the child overwrites.
Descriptor Raised(Descriptor descriptor) {
  if (!descriptor.is_open() || descriptor.get() > STDERR_FILENO) return descriptor;
  return Descriptor(fcntl(descriptor.get(), F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
}

Terminal OpenTerminal() {
  Terminal terminal;
  terminal.master = Descriptor(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK));
  const int master = terminal.master.get();
  std::array<char, 128> name{};
  if (!terminal.master.is_open() || grantpt(master) != 0 || unlockpt(master) != 0) {
    Fail("cannot open a pseudo terminal");
  }
  if (const int error = ptsname_r(master, name.data(), name.size()); error != 0) {
    errno = error;
    Fail("cannot name a pseudo terminal");
  }
  terminal.slave = Raised(Descriptor(open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC)));
  if (!terminal.slave.is_open()) Fail(std::string("cannot open the terminal ") + name.data());

  termios modes{};
  if (tcgetattr(terminal.slave.get(), &modes) != 0) Fail("cannot read a terminal's modes");
  modes.c_oflag &= ~tcflag_t{OPOST};
  modes.c_lflag &= ~tcflag_t{ECHO | ECHOE | ECHOK | ECHONL | ECHOCTL | ECHOKE};
  if (tcsetattr(terminal.slave.get(), TCSANOW, &modes) != 0) Fail("cannot set a terminal's modes");
  // Programs that fill the width divide by it.
  const winsize size{.ws_row = 24, .ws_col = 80, .ws_xpixel = 0, .ws_ypixel = 0};
  if (ioctl(terminal.slave.get(), TIOCSWINSZ, &size) != 0) Fail("cannot set a terminal's size");
  return terminal;
}

void RefuseNul(const std::string& text) {
  if (text.find('\0') == std::string::npos) return;
  throw std::invalid_argument("a NUL in what a child is to be started with: " + text);
}

std::vector<char*> PointersTo(const std::vector<std::string>& words) {
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (const std::string& word : words) {
    RefuseNul(word);
    pointers.push_back(const_cast<char*>(word.c_str()));
  }
  pointers.push_back(nullptr);
  return pointers;
}

// From here to RunPlan(): in the child, where another thread may have held any lock at the fork.
// Only calls that are safe in a signal handler.

void Say(const char* text) {
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text, std::strlen(text));
}

// `problem` and `object` may be empty: then the reason tells all.
[[noreturn]] void GiveUp(const Plan& plan, const char* problem = "", const char* object = "") {
  const char* const reason = strerrordesc_np(errno);
  Say("cannot run ");
  Say(plan.program);
  Say(": ");
  Say(problem);
  Say(object);
  if (*problem != '\0') Say(": ");
  Say(reason == nullptr ? "unknown reason" : reason);
  Say("\n");
  _exit(kCannotRun);
}

void ResetSignals() {
  struct sigaction by_default {};
  by_default.sa_handler = SIG_DFL;
  for (int signal = 1; signal < NSIG; ++signal) sigaction(signal, &by_default, nullptr);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

[[noreturn]] void RunPlan(const Plan& plan) {
  const bool dies_with_parent = plan.parent_death_signal != 0;
  if (dies_with_parent) prctl(PR_SET_PDEATHSIG, plan.parent_death_signal);
  // Too late for the signal: the parent was gone before it was asked for.
  if (dies_with_parent && getppid() != plan.parent) _exit(kCannotRun);
  const bool has_session = setsid() >= 0;
  const bool has_terminal = ioctl(plan.terminal_fd, TIOCSCTTY, 0) == 0;
  const int error = errno;
  for (int fd = 0; fd <= STDERR_FILENO; ++fd) {
    if (dup2(plan.terminal_fd, fd) < 0) _exit(kCannotRun);
  }
  errno = error;
  if (!has_session || !has_terminal) GiveUp(plan, "no session on a terminal");
  if (close_range(STDERR_FILENO + 1, ~0U, 0) != 0) GiveUp(plan, "cannot close descriptors");
  ResetSignals();
  if (plan.folder != nullptr && chdir(plan.folder) != 0) {
    GiveUp(plan, "cannot enter ", plan.folder);
  }
  execve(plan.program, plan.arguments.data(), plan.environment.data());
  GiveUp(plan);
}

// No handler of the parent's may run in the child.
pid_t ForkWithSignalsBlocked(const Plan& plan) {
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t pid = fork();
  if (pid == 0) RunPlan(plan);
  const int error = errno;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = error;
  return pid;
}

}  // namespace

TerminalChild StartOnTerminal(const ChildSettings& settings) {
  if (settings.arguments.empty()) throw std::invalid_argument("a child needs its program's name");
  const bool moves = !settings.working_folder.empty();
  const std::string program =
      moves ? std::filesystem::absolute(settings.program).string() : settings.program.string();
  RefuseNul(program);
  RefuseNul(settings.working_folder.string());
  Plan plan;
  plan.program = program.c_str();
  plan.folder = moves ? settings.working_folder.c_str() : nullptr;
  plan.arguments = PointersTo(settings.arguments);
  plan.environment = PointersTo(settings.environment);
  Terminal terminal = OpenTerminal();
  plan.terminal_fd = terminal.slave.get();
  plan.parent = getpid();
  plan.parent_death_signal = settings.parent_death_signal;
  const pid_t pid = ForkWithSignalsBlocked(plan);
  if (pid < 0) Fail("cannot start " + program);
  terminal.slave.Reset();
  // It is there, if only as a zombie: nobody but this process can reap it.
  const auto entry = ReadProcess(pid);
  if (!entry) {  // Without its start time nobody could ever stop it.
    const int error = errno;
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
    errno = error;
    Fail("cannot read /proc/" + std::to_string(pid) + "/stat");
  }
  return {.pid = pid, .output_fd = terminal.master.Release(), .start_ticks = entry->start_ticks};
}

OutputPart ReadOutput(int output_fd, std::span<char> buffer) {
  ssize_t size = 0;
  do {
    size = read(output_fd, buffer.data(), buffer.size());
  } while (size < 0 && errno == EINTR);
  if (size > 0) return {.size = static_cast<std::size_t>(size)};
  // A terminal that nobody holds any more reads as EIO.
  return {.is_over = size == 0 || errno != EAGAIN};
}

}  // namespace clearway::host
