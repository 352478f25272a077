// SPDX-License-Identifier: BSD-3-Clause
#include "tools/teleop/terminal_mode.hpp"

#include <cerrno>
#include <stdexcept>
#include <string>
#include <sys/ioctl.h>
#include <system_error>
#include <unistd.h>

namespace clearway::teleop {

TerminalMode::TerminalMode(int fd) : fd_(fd) {
  if (tcgetattr(fd_, &before_) != 0) {
    throw std::runtime_error(
        "standard input is no terminal: keys can only be read from one (over ssh, use ssh -t)");
  }
  termios mode = before_;
  mode.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO | IEXTEN);
  mode.c_cc[VMIN] = 1;
  mode.c_cc[VTIME] = 0;
  mode.c_cc[VSUSP] = _POSIX_VDISABLE;
  if (tcsetattr(fd_, TCSANOW, &mode) != 0) {
    throw std::runtime_error("the terminal cannot be set up: " +
                             std::system_category().message(errno));
  }
}

TerminalMode::~TerminalMode() {
  tcsetattr(fd_, TCSANOW, &before_);
}

int TerminalWidth(int fd) {
  winsize size{};
  if (ioctl(fd, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
}

}  // namespace clearway::teleop
