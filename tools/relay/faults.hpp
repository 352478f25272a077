// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>

namespace clearway::relay {

/// What one direction does to its frames.
struct FaultSettings {
  double loss = 0.0;           ///< Probability that a frame is lost.
  double duplicate = 0.0;      ///< Probability that a frame that is not lost comes twice.
  std::int64_t delay_ns = 0;   ///< Each frame is held at least this long [ns].
  std::int64_t jitter_ns = 0;  ///< And up to this much longer, evenly distributed [ns].
};

/// Decides what becomes of the frames of one direction. The order of the frames stays, also while
/// delays change. The n-th frame draws the same random numbers whatever the settings are: with more
/// loss, the frames that were lost before are lost again.
class Faults {
 public:
  explicit Faults(std::uint64_t seed) : random_(seed) {}

  struct Verdict {
    int copies = 1;           ///< 0: lost, 2: duplicated.
    std::int64_t due_ns = 0;  ///< When to send them; never before an earlier frame's.
  };

  FaultSettings settings;

  /// @pre `now_ns` never decreases.
  [[nodiscard]] Verdict Decide(std::int64_t now_ns);

 private:
  double Draw();

  std::mt19937_64 random_;
  std::int64_t last_due_ns_ = 0;
};

}  // namespace clearway::relay
