// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/screen_terminal.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <clocale>
#include <cstdlib>
#include <cwchar>
#include <fcntl.h>
#include <poll.h>
#include <stdexcept>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <termios.h>

// Its macros are named like half of the standard library.
#define NCURSES_NOMACROS
#include <ncurses.h>

#include "processes/procman_sheriff/text_cells.hpp"

namespace clearway::screen {
namespace {

constexpr int kEscapeDelayMs = 25;
// What the terminal gets at the end to take in the last of what was drawn.
constexpr int kLastWaitMs = 200;
// The terminal said so often that there is something to read, and there was nothing.
constexpr int kMaxIdleReads = 20;

enum Pair : short { kTroublePair = 1, kBusyPair = 2 };

attr_t AttributesOf(Style style) {
  switch (style) {
    case Style::kTitle:
      return A_REVERSE;
    case Style::kBanner:
      return A_REVERSE | A_BOLD;
    case Style::kHeader:
      return A_UNDERLINE;
    case Style::kStrong:
    case Style::kTrouble:
    case Style::kBusy:
      return A_BOLD;
    case Style::kDim:
      return A_DIM;
    case Style::kPlain:
      break;
  }
  return A_NORMAL;
}

short PairOf(Style style) {
  if (style == Style::kTrouble || style == Style::kBanner) return kTroublePair;
  return style == Style::kBusy ? kBusyPair : 0;
}

// What ncurses would give another width, or the locale cannot show, becomes '?': columns stay
// where they are.
std::wstring WideTextOf(const std::string& text) {
  std::wstring wide;
  std::string_view rest = text;
  while (!rest.empty()) {
    const Utf8Step step = FirstCharacter(rest);
    rest.remove_prefix(step.bytes);
    const int cells = CellsOf(step.code);
    const auto character = static_cast<wchar_t>(step.code);
    if (wcwidth(character) == cells) {
      wide += character;
    } else {
      wide.append(static_cast<std::size_t>(cells), L'?');
    }
  }
  return wide;
}

KeyPress::Kind KindOf(wint_t key) {
  switch (key) {
    case KEY_UP:
      return KeyPress::Kind::kUp;
    case KEY_DOWN:
      return KeyPress::Kind::kDown;
    case KEY_LEFT:
      return KeyPress::Kind::kLeft;
    case KEY_RIGHT:
      return KeyPress::Kind::kRight;
    case KEY_PPAGE:
      return KeyPress::Kind::kPageUp;
    case KEY_NPAGE:
      return KeyPress::Kind::kPageDown;
    case KEY_HOME:
      return KeyPress::Kind::kHome;
    case KEY_END:
      return KeyPress::Kind::kEnd;
    case KEY_ENTER:
      return KeyPress::Kind::kEnter;
    case KEY_BACKSPACE:
    case KEY_DC:
      return KeyPress::Kind::kBackspace;
    default:
      return KeyPress::Kind::kOther;
  }
}

KeyPress KeyOf(wint_t character) {
  switch (character) {
    case '\r':
    case '\n':
      return {.kind = KeyPress::Kind::kEnter};
    case 0x1B:
      return {.kind = KeyPress::Kind::kEscape};
    case 0x7F:
    case '\b':
      return {.kind = KeyPress::Kind::kBackspace};
    case 0x03:
      return {.kind = KeyPress::Kind::kInterrupt};
    case 0x0C:
      return {.kind = KeyPress::Kind::kRedraw};
    default:
      return {.kind = KeyPress::Kind::kCharacter, .character = static_cast<char32_t>(character)};
  }
}

// The terminal of stdout, with an open file description of its own: whether it is waited for is a
// matter of that, and the one of stdout belongs to the shell too.
int OpenOutput() {
  std::array<char, 256> name{};
  int fd = -1;
  if (ttyname_r(STDOUT_FILENO, name.data(), name.size()) == 0) {
    fd = open(name.data(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  }
  if (fd < 0) fd = open("/dev/tty", O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (fd < 0) throw std::runtime_error("cannot open the terminal for the full-screen view");
  return fd;
}

void AddCursesColours() {
  const char* no_color = std::getenv("NO_COLOR");
  if ((no_color != nullptr && *no_color != '\0') || !has_colors()) return;
  start_color();
  // The terminal's own background, dark or light.
  if (use_default_colors() != OK) return;
  init_pair(kTroublePair, COLOR_RED, -1);
  init_pair(kBusyPair, COLOR_MAGENTA, -1);
}

}  // namespace

// How the terminal hands on what is typed: at once, unchanged and unseen.
struct Terminal::Modes {
  Modes() {
    if (tcgetattr(STDIN_FILENO, &before) != 0) {
      throw std::runtime_error("the full-screen view needs a terminal on stdin");
    }
    termios raw = before;
    cfmakeraw(&raw);
    tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  }
  Modes(const Modes&) = delete;
  Modes& operator=(const Modes&) = delete;
  ~Modes() { tcsetattr(STDIN_FILENO, TCSANOW, &before); }

  termios before{};
};

// ncurses, which writes to a file in memory: it knows only writing that waits.
struct Terminal::Curses {
  Curses() {
    const int memory = memfd_create("screen", MFD_CLOEXEC);
    file = memory < 0 ? nullptr : fdopen(memory, "w+");
    if (file == nullptr) throw std::runtime_error("cannot make a buffer for the screen");
    screen = newterm(nullptr, file, stdin);
    if (screen == nullptr) {
      std::fclose(file);
      const char* term = std::getenv("TERM");
      throw std::runtime_error("the terminal \"" + std::string(term == nullptr ? "" : term) +
                               "\" (TERM) is not known; a verb such as status needs none");
    }
  }
  Curses(const Curses&) = delete;
  Curses& operator=(const Curses&) = delete;
  ~Curses() {
    delscreen(screen);
    std::fclose(file);
  }

  // What was written since the last call.
  [[nodiscard]] std::string TakeBytes() const {
    std::fflush(file);
    const int fd = fileno(file);
    const off_t size = lseek(fd, 0, SEEK_END);
    std::string bytes(static_cast<std::size_t>(std::max<off_t>(size, 0)), '\0');
    const ssize_t got = pread(fd, bytes.data(), bytes.size(), 0);
    bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (ftruncate(fd, 0) != 0) return bytes;
    lseek(fd, 0, SEEK_SET);
    return bytes;
  }

  std::FILE* file = nullptr;
  SCREEN* screen = nullptr;
};

Terminal::Terminal() {
  if (isatty(STDIN_FILENO) == 0 || isatty(STDOUT_FILENO) == 0) {
    throw std::runtime_error("the full-screen view needs a terminal on stdin and stdout");
  }
  // For the characters' width; numbers stay as they are.
  std::setlocale(LC_CTYPE, "");
  curses_ = std::make_unique<Curses>();
  output_ = OpenOutput();
  modes_ = std::make_unique<Modes>();
  set_escdelay(kEscapeDelayMs);
  raw();
  noecho();
  nonl();
  curs_set(0);
  typeahead(-1);
  keypad(stdscr, TRUE);
  nodelay(stdscr, TRUE);
  AddCursesColours();
  TakeSize();
}

Terminal::~Terminal() {
  endwin();
  Collect();
  for (int waited = 0; waited < kLastWaitMs && !IsReady(); waited += 20) {
    pollfd event{output_, POLLOUT, 0};
    poll(&event, 1, 20);
  }
  close(output_);
}

void Terminal::TakeSize() {
  winsize window{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_row > 0 && window.ws_col > 0) {
    size_ = {window.ws_col, window.ws_row};
  }
  // A terminal of any size may be claimed; no screen has more.
  size_ = {std::clamp(size_.columns, 1, 1000), std::clamp(size_.rows, 1, 500)};
  resizeterm(size_.rows, size_.columns);
  Redraw();
}

std::vector<KeyPress> Terminal::ReadKeys() {
  std::vector<KeyPress> keys;
  wint_t key = 0;
  for (int status = get_wch(&key); status != ERR; status = get_wch(&key)) {
    keys.push_back(status == KEY_CODE_YES ? KeyPress{.kind = KindOf(key)} : KeyOf(key));
  }
  Collect();  // get_wch() refreshes.
  pollfd event{STDIN_FILENO, POLLIN, 0};
  const bool is_readable = poll(&event, 1, 0) > 0;
  idle_reads_ = is_readable && keys.empty() ? idle_reads_ + 1 : 0;
  is_gone_ = (event.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0 || idle_reads_ > kMaxIdleReads;
  return keys;
}

void Terminal::Draw(const std::vector<Line>& lines) {
  werase(stdscr);
  for (std::size_t row = 0; row < lines.size(); ++row) {
    wmove(stdscr, static_cast<int>(row), 0);
    const attr_t selected = lines[row].is_selected ? A_REVERSE : A_NORMAL;
    int column = 0;
    for (const Span& span : lines[row].spans) {
      wattr_set(stdscr, AttributesOf(span.style) | selected, PairOf(span.style), nullptr);
      const std::wstring text = WideTextOf(span.text);
      waddnwstr(stdscr, text.data(), static_cast<int>(text.size()));
      column += CellsOf(std::string_view(span.text));
    }
    wattr_set(stdscr, selected, 0, nullptr);
    if (lines[row].is_selected) whline(stdscr, ' ' | selected, size_.columns - column);
  }
  wattr_set(stdscr, A_NORMAL, 0, nullptr);
  wnoutrefresh(stdscr);
  doupdate();
  Collect();
}

void Terminal::Redraw() {
  clearok(curscr, TRUE);
}

void Terminal::Collect() {
  pending_ += curses_->TakeBytes();
}

bool Terminal::IsReady() {
  while (!pending_.empty()) {
    const ssize_t written = write(output_, pending_.data(), pending_.size());
    if (written < 0 && errno == EINTR) continue;
    // A terminal that is gone takes nothing any more: is_gone() tells.
    if (written < 0 && errno != EAGAIN) pending_.clear();
    if (written <= 0) break;
    pending_.erase(0, static_cast<std::size_t>(written));
  }
  return pending_.empty();
}

}  // namespace clearway::screen
