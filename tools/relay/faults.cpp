// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/faults.hpp"

#include <algorithm>

namespace clearway::relay {

// In [0, 1). By hand: the distributions of the standard library differ from one to another.
double Faults::Draw() {
  return static_cast<double>(random_() >> 11U) * 0x1p-53;
}

Faults::Verdict Faults::Decide(std::int64_t now_ns) {
  const bool is_lost = Draw() < settings.loss;
  const bool is_duplicated = Draw() < settings.duplicate;
  const auto jitter_ns =
      static_cast<std::int64_t>(Draw() * static_cast<double>(settings.jitter_ns));
  if (is_lost) return {.copies = 0, .due_ns = now_ns};
  last_due_ns_ = std::max(last_due_ns_, now_ns + settings.delay_ns + jitter_ns);
  return {.copies = is_duplicated ? 2 : 1, .due_ns = last_due_ns_};
}

}  // namespace clearway::relay
