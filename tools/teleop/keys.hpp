// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace clearway::teleop {

/// What a key asks for.
enum class Key : std::int8_t { kForward, kBackward, kLeft, kRight, kStop, kQuit, kOther };

/// Takes apart what a terminal sends: w a s d or the arrows, space, q; capitals are the same. An
/// arrow comes as ESC [ A or ESC O A, and may come in pieces. Any other sequence is one kOther.
/// Nothing but these seven keys ever moves anything. Thread safety: none.
class KeyDecoder {
 public:
  /// The keys that are whole with these bytes. O(bytes).
  [[nodiscard]] std::vector<Key> Decode(std::string_view bytes);

 private:
  enum class Stage : std::int8_t { kPlain, kEscape, kSequence };
  Stage stage_ = Stage::kPlain;
  std::string parameters_;  // Of the sequence under way.
};

}  // namespace clearway::teleop
