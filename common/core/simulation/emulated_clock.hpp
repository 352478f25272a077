// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/core/livox/data_packet.hpp"

namespace clearway::core {

/// What a sensor's stamps come from while it hears a source of time.
struct EmulatedTimeSync {
  livox::TimestampType source = livox::TimestampType::kNoSync;
  std::int64_t error_us = 0;  ///< Of the source: what it says minus the true time.
};

/// The clock in a sensor: an oscillator that starts with the power and is a little off, and what
/// the stamps add to it. Times called true are of the simulator's clock [us].
class EmulatedClock {
 public:
  /// `drift_ppm`: how much faster than true time it runs. `start_us`: how long it says to have
  /// been running when it starts (a sensor that was on for a while before the simulator).
  EmulatedClock(double drift_ppm, std::int64_t start_us);

  /// The oscillator starts anew at 0; steps are forgotten, and so is `start_us`.
  void Restart(std::int64_t true_us);

  /// All later stamps without a source of time are `step_us` later.
  void Step(std::int64_t step_us) { offset_ns_ += step_us * 1000; }

  /// Stamps without a source of time begin anew at 0; the shots go on.
  void ResetStamps(std::int64_t true_us) { offset_ns_ = -OscillatorNs(true_us); }

  /// Since the last start, as the oscillator counts.
  [[nodiscard]] std::int64_t OscillatorNs(std::int64_t true_us) const;

  /// When the oscillator has counted so far, to the microsecond below. Inverse of OscillatorNs().
  [[nodiscard]] std::int64_t TrueUs(std::int64_t oscillator_ns) const;

  /// The UTC time that a host tells with a command, kept for PPS; `true_us` is now.
  void SetUtc(std::int64_t utc_ns, std::int64_t true_us) {
    utc_minus_true_ns_ = utc_ns - true_us * 1000;
  }

  /// What a packet carries as its time.
  struct Stamp {
    livox::TimestampType type = livox::TimestampType::kNoSync;
    std::uint64_t timestamp = 0;
  };

  /// The stamp of the moment `oscillator_ns`. `utime_minus_true_us` makes the true time one since
  /// the epoch. PPS with a UTC time that was told gives GPS stamps, as on a real one. Never
  /// negative: a stamp before 0 is 0.
  [[nodiscard]] Stamp StampAt(std::int64_t oscillator_ns,
                              const EmulatedTimeSync& sync,
                              std::int64_t utime_minus_true_us) const;

 private:
  double rate_;
  std::int64_t started_us_ = 0;
  std::int64_t offset_ns_ = 0;
  std::optional<std::int64_t> utc_minus_true_ns_;
};

}  // namespace clearway::core
