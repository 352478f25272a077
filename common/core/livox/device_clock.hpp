// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/core/livox/data_packet.hpp"

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
  kStarted,  ///< The first packet.
  kReset,    ///< The clock went back: the sensor was switched off and on.
  kStepped,  ///< The clock jumped.
  kSourceChanged
};

/// Maps stamps of a sensor to the host's clock. A free-running clock is followed by the least delay
/// between stamp and arrival (network and scheduling only ever add to it) and its drift; PTP and
/// GPS stamps are taken as they are while they agree with the host's clock to max_error_us. O(1) a
/// packet. Thread safety: none.
class DeviceClock {
 public:
  explicit DeviceClock(const ClockConfig& config);

  struct Reading {
    std::int64_t utime_ns = 0;  ///< Of the first shot, since the epoch, on the host's clock.
    ClockEvent event = ClockEvent::kNone;
  };
  /// Takes the stamp of a packet's first shot. `duration_us`: from the first shot to the moment
  /// after the last, before which the packet cannot have left.
  Reading Observe(TimestampType type,
                  std::uint64_t timestamp,
                  std::int64_t duration_us,
                  std::int64_t arrival_utime);

  void Restart();

  [[nodiscard]] TimeSource source() const { return source_; }
  /// How much faster the sensor's clock runs than the host's [ppm]; nothing until it is known.
  [[nodiscard]] std::optional<double> drift_ppm() const;
  /// How far the newest packet came later than the quickest ones [us].
  [[nodiscard]] std::int64_t residual_us() const { return residual_us_; }
  [[nodiscard]] std::int64_t resets() const { return resets_; }
  [[nodiscard]] std::int64_t steps() const { return steps_; }
  /// PTP and GPS stamps that were not believed.
  [[nodiscard]] std::int64_t implausible() const { return implausible_; }

 private:
  ClockConfig config_;
  TimeSource source_ = TimeSource::kUnknown;
  std::int64_t residual_us_ = 0;
  std::int64_t resets_ = 0;
  std::int64_t steps_ = 0;
  std::int64_t implausible_ = 0;
};

}  // namespace clearway::core::livox
