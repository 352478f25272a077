// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/core/livox/data_packet.hpp"
#include "common/core/livox/delay_envelope.hpp"

namespace clearway::core::livox {

/// What the time of a measurement was derived from. The values are those of the wire.
enum class TimeSource : std::int8_t {
  kUnknown = 0,
  kHost = 1,    ///< Arrival alone.
  kDevice = 2,  ///< The sensor's own clock, mapped to the host's.
  kPtp = 3,
  kGps = 4,
};

struct ClockConfig {
  std::int64_t max_error_us = 50'000;  ///< PTP and GPS stamps further off are not believed.
};

/// What happened to the sensor's clock with a packet.
enum class ClockEvent : std::int8_t {
  kNone,
  kStarted,       ///< The first packet.
  kReset,         ///< The sensor's own clock went back: it was switched off and on.
  kStepped,       ///< The sensor's or the host's clock jumped.
  kSourceChanged  ///< Stamps of another type, or they are believed now, or no longer.
};

/// Maps stamps of a sensor to the host's clock.
///
/// A free-running clock is followed by DelayEnvelope: the least delay between stamp and arrival
/// (network and scheduling only ever add to it) and its drift. PTP and GPS stamps are taken as they
/// are while that line says that they agree with the host's clock to max_error_us; when they do
/// not, they are mapped like a free-running clock until they agree to half of it. PPS stamps wrap
/// each second and are counted on; a GPS stamp that states no moment leaves arrival alone.
///
/// The first packets come with a delay that nobody knows yet: a clock settles on its first
/// kSettlePackets (about 0.1 s; kMaxSettle_us at most), before which no time should be used.
/// Afterwards it slews, by 1 % at most, and mapped time never goes back. What is off by more than
/// kStep_us is a jump: the clock settles anew, and Reading::event says why. A jump is believed when
/// kConfirmPackets packets in turn agree on it; single wild stamps are left out.
///
/// When the host's clock is set, a step beyond 0.2 s, or back by more than kStep_us, is found
/// within kConfirmPackets; a step forward of less than 0.2 s looks like a slower network and is
/// followed within 2.5 s. O(1) a packet, allocates nothing. Thread safety: none.
class DeviceClock {
 public:
  static constexpr int kSettlePackets = 96;
  static constexpr std::int64_t kMinSettle_us = 40'000;
  static constexpr std::int64_t kMaxSettle_us = 250'000;
  static constexpr int kConfirmPackets = 8;
  static constexpr std::int64_t kStep_us = 20'000;

  explicit DeviceClock(const ClockConfig& config);

  struct Reading {
    std::int64_t utime_ns = 0;     ///< Of the first shot, since the epoch, on the host's clock; 0
                                   ///< when it is not usable.
    std::uint64_t device_ns = 0;   ///< The stamp as nanoseconds that do not wrap.
    bool is_usable = false;        ///< False: the stamp fits nothing that was seen before.
    bool is_device_stamp = false;  ///< False: taken from arrival; says nothing about gaps.
    ClockEvent event = ClockEvent::kNone;
  };
  /// Takes the stamp of a packet's first shot. `duration_us`: from the first shot to the moment
  /// after the last, before which the packet cannot have left.
  Reading Observe(TimestampType type,
                  std::uint64_t timestamp,
                  std::int64_t duration_us,
                  std::int64_t arrival_utime);

  /// False for the first moments after start, reset and step. source() and ToHost() are only
  /// good when it is true.
  [[nodiscard]] bool is_settled() const { return is_settled_; }
  /// Makes do with what has come. @pre Observe() was called since Restart().
  void Settle();

  /// Reading::device_ns on the host's clock [ns since the epoch].
  [[nodiscard]] std::int64_t ToHost(std::uint64_t device_ns) const;
  /// The inverse, to the nanosecond or two.
  [[nodiscard]] std::uint64_t ToDevice(std::int64_t utime_ns) const;

  void Restart();

  [[nodiscard]] TimeSource source() const { return source_; }
  /// How much faster the sensor's clock runs than the host's [ppm]; nothing until it is known.
  [[nodiscard]] std::optional<double> drift_ppm() const;
  /// How far the newest packet came later than the quickest ones [us].
  [[nodiscard]] std::int64_t residual_us() const { return residual_us_; }
  /// How far even the quickest of the last packets came late [us]; 0 while that is below 2 ms.
  [[nodiscard]] std::int64_t lag_us() const;
  [[nodiscard]] std::int64_t resets() const { return resets_; }
  [[nodiscard]] std::int64_t steps() const { return steps_; }
  /// PTP and GPS stamps that were not believed.
  [[nodiscard]] std::int64_t implausible() const { return implausible_; }

 private:
  // A packet's stamp and arrival; what kind of clock the stamp comes from.
  struct Observation {
    TimestampType type = TimestampType::kNoSync;
    bool is_device_stamp = true;
    std::uint64_t device_ns = 0;
    std::int64_t sent_ns = 0;  // Host time at which the first shot was made, if nothing delayed.
    std::int64_t arrival_ns = 0;
  };
  // Packets that do not fit, but one another.
  struct Candidate {
    int count = 0;
    Observation first;
    Observation newest;
  };

  [[nodiscard]] Observation Interpret(TimestampType type,
                                      std::uint64_t timestamp,
                                      std::int64_t duration_us,
                                      std::int64_t arrival_utime) const;
  [[nodiscard]] std::uint64_t CountOnPulses(std::uint64_t timestamp, std::int64_t arrival_ns) const;
  [[nodiscard]] DelayEnvelope::Sample ToSample(const Observation& seen) const;
  [[nodiscard]] bool IsOtherClock(const Observation& seen) const;
  [[nodiscard]] bool Surprises(const Observation& seen) const;
  [[nodiscard]] bool IsUsable(const Observation& seen) const;
  [[nodiscard]] bool ConfirmsJump(const Observation& seen);
  [[nodiscard]] ClockEvent NameJump(const Observation& seen) const;
  void Count(ClockEvent event);
  void Begin(const Observation& seen);
  ClockEvent Track(const Observation& seen);
  void JudgeAbsoluteTime();
  [[nodiscard]] double AbsoluteOffset_ns() const;
  void Slew(std::int64_t stamp_ns);
  void NoteResidual(const Observation& seen);
  [[nodiscard]] double TargetAt(std::int64_t stamp_ns) const;
  [[nodiscard]] double OffsetAt(std::int64_t stamp_ns) const;

  ClockConfig config_;
  TimeSource source_ = TimeSource::kUnknown;
  std::int64_t residual_us_ = 0;
  std::int64_t resets_ = 0;
  std::int64_t steps_ = 0;
  std::int64_t implausible_ = 0;

  // All that follows counts from the first packet since the clock began: its stamp, and the host's
  // time at its first shot. Differences of stamps wrap as unsigned numbers do.
  std::optional<Observation> anchor_;
  DelayEnvelope envelope_;
  Observation newest_;  // By stamp.
  bool is_settled_ = false;
  int num_packets_ = 0;
  bool believes_ = false;  // PTP and GPS stamps are taken as they are.
  bool doubts_ = false;    // They were off: they must agree better to be believed again.
  Candidate candidate_;

  // Offset in use: a line through (knot_ns_, offset_ns_) that leads to the target.
  std::int64_t knot_ns_ = 0;
  double offset_ns_ = 0.0;
  double slew_ = 0.0;

  // Least residual of this and the last lot of packets.
  std::array<double, 2> least_ns_{};
  int num_in_lot_ = 0;
};

}  // namespace clearway::core::livox
