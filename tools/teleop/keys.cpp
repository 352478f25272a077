// SPDX-License-Identifier: BSD-3-Clause
#include "tools/teleop/keys.hpp"

namespace clearway::teleop {
namespace {

constexpr char kEscape = '\x1b';

Key PlainKey(char c) {
  switch (c) {
    case 'w':
    case 'W':
      return Key::kForward;
    case 's':
    case 'S':
      return Key::kBackward;
    case 'a':
    case 'A':
      return Key::kLeft;
    case 'd':
    case 'D':
      return Key::kRight;
    case ' ':
      return Key::kStop;
    case 'q':
    case 'Q':
      return Key::kQuit;
    default:
      return Key::kOther;
  }
}

Key ArrowKey(char last) {
  switch (last) {
    case 'A':
      return Key::kForward;
    case 'B':
      return Key::kBackward;
    case 'C':
      return Key::kRight;
    case 'D':
      return Key::kLeft;
    default:
      return Key::kOther;
  }
}

}  // namespace

std::vector<Key> KeyDecoder::Decode(std::string_view bytes) {
  std::vector<Key> keys;
  for (const char c : bytes) {
    if (c == kEscape) {
      // An escape within a sequence ends that and begins another one.
      stage_ = Stage::kEscape;
    } else if (stage_ == Stage::kEscape && (c == '[' || c == 'O')) {
      stage_ = Stage::kSequence;
      parameters_.clear();
    } else if (stage_ == Stage::kEscape) {
      // The escape key alone, or a key with Alt.
      stage_ = Stage::kPlain;
      keys.push_back(c == ' ' || c == 'q' ? PlainKey(c) : Key::kOther);
    } else if (stage_ == Stage::kSequence && (c >= '@' && c <= '~')) {
      stage_ = Stage::kPlain;
      keys.push_back(parameters_.empty() ? ArrowKey(c) : Key::kOther);
    } else if (stage_ == Stage::kSequence && c >= ' ' && c <= '?') {
      if (parameters_.size() < 16) parameters_ += c;
    } else {
      stage_ = Stage::kPlain;
      keys.push_back(PlainKey(c));
    }
  }
  return keys;
}

}  // namespace clearway::teleop
