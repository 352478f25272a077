// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The base's part in being stopped, for any base driver: this file alone, C++17, standard library
// only, no clock, no thread, no allocation. Feed it with each DRIVE_PERMIT (and DRIVE_COMMAND) that
// arrives, and ask it in every control cycle what may be driven:
//
//   gate.OnPermit({p.session, p.sequence, p.utime, p.valid_us, p.forward_mps, p.backward_mps,
//                  p.turn_left_radps, p.turn_right_radps}, now_us);
//   const BaseMotion motion = gate.Clip(wish, now_us);        // or gate.Commanded(now_us)
//
// `now_us` is the base's own monotonic clock, read when the message arrives or the cycle runs.

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace clearway::core {

/// Tells how fresh a stream of stamped messages is without comparing two clocks: by the time since
/// the last arrival, and by (arrival - stamp) against its own least value so far. The second finds
/// a pipeline that is steadily late, and a process that was frozen and now drains its queue: its
/// messages arrive in quick order, but each is old.
///
/// The least value may creep up by kDrift of the time passed, since two clocks drift apart; a
/// lateness is therefore forgiven only at that rate (0.1 s takes 200 s), never because a window
/// slid past. A stamp that goes back by more than kStepBack_us cannot come out of a queue: it is a
/// stepped clock, another publisher or a log played again, and starts the comparison anew.
/// What was late from the very first message on cannot be told from what is not.
/// O(1) time and memory.
class FreshnessWatch {
 public:
  static constexpr double kDrift = 500e-6;
  static constexpr std::int64_t kStepBack_us = 100'000;

  struct State {
    bool has_arrived = false;      ///< False: nothing arrived since the start; the rest is 0.
    std::int64_t age_us = 0;       ///< Since the last arrival [us].
    std::int64_t lateness_us = 0;  ///< Of the last message, against the quickest so far [us].
  };

  /// `monotonic_us` is the receiver's clock, `stamp_us` the sender's (of the measurement).
  /// Stamps beyond +-2^61 are clamped to that: no value can overflow.
  void OnArrival(std::int64_t monotonic_us, std::int64_t stamp_us) {
    const std::int64_t stamp = std::clamp(stamp_us, -kLimit, kLimit);
    const std::int64_t delay = monotonic_us - stamp;
    if (!has_arrived_ || stamp < stamp_us_ - kStepBack_us) {
      least_delay_us_ = delay;
      creep_us_ = 0.0;
    } else {
      creep_us_ +=
          kDrift * static_cast<double>(std::max<std::int64_t>(0, monotonic_us - arrival_us_));
      const double whole = std::floor(creep_us_);
      creep_us_ -= whole;
      least_delay_us_ = std::min(delay, least_delay_us_ + static_cast<std::int64_t>(whole));
    }
    has_arrived_ = true;
    arrival_us_ = monotonic_us;
    stamp_us_ = stamp;
    lateness_us_ = delay - least_delay_us_;
  }

  [[nodiscard]] State Query(std::int64_t monotonic_us) const {
    if (!has_arrived_) return {};
    return {true, std::max<std::int64_t>(0, monotonic_us - arrival_us_), lateness_us_};
  }

  /// Forgets everything, as for a publisher that started anew.
  void Reset() { *this = FreshnessWatch(); }

 private:
  static constexpr std::int64_t kLimit = std::int64_t{1} << 61;  // Differences of two fit.

  bool has_arrived_ = false;
  std::int64_t arrival_us_ = 0;
  std::int64_t stamp_us_ = 0;
  std::int64_t lateness_us_ = 0;
  double creep_us_ = 0.0;            // Part of the drift that is not yet a whole microsecond.
  std::int64_t least_delay_us_ = 0;  // Running minimum of arrival - stamp.
};

/// Settings of BaseGate.
struct BaseGateConfig {
  std::int64_t validity_us = 100'000;
  std::int64_t command_validity_us = 200'000;
  std::int64_t max_lateness_us = 100'000;
  std::int64_t unlock_us = 1'000'000;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Milliseconds("validity_ms",
                         self.validity_us,
                         20.0,
                         1000.0,
                         "Without a new permit for longer than this the base stops, also where the "
                         "permit says that it holds for longer [ms].");
    visitor.Milliseconds("command_validity_ms",
                         self.command_validity_us,
                         20.0,
                         5000.0,
                         "Without a new command for longer than this the base stops [ms].");
    visitor.Milliseconds("max_lateness_ms",
                         self.max_lateness_us,
                         20.0,
                         1000.0,
                         "A message later than the quickest ones by more than this means stop: its "
                         "publisher was frozen [ms].");
    visitor.Milliseconds("unlock_ms",
                         self.unlock_us,
                         100.0,
                         60000.0,
                         "The publisher must be silent for this long before another is obeyed "
                         "[ms].");
  }
};

/// Whether the base may move by what it holds.
enum class GateState : std::int8_t {
  kValid,     ///< Obey the last accepted message.
  kNone,      ///< None has come: stop.
  kStale,     ///< The last one is too old: stop.
  kLate,      ///< They come late: stop.
  kRepeated,  ///< The last sequence was repeated or went back: stop until the next good one.
  kAbsurd,    ///< The last one holds numbers that mean nothing: stop until the next good one.
};

/// The state in words, as they stand behind "the permit" or "the command".
[[nodiscard]] constexpr const char* GateText(GateState state) {
  switch (state) {
    case GateState::kValid:
      return "is valid";
    case GateState::kNone:
      return "has not come yet";
    case GateState::kStale:
      return "has stopped coming";
    case GateState::kLate:
      return "comes late";
    case GateState::kRepeated:
      return "repeats its sequence";
    case GateState::kAbsurd:
      return "holds numbers that mean nothing";
  }
  return "is unknown";
}

/// A motion of the vehicle frame. Positive: forward, to the left.
struct BaseMotion {
  double v_mps = 0.0;
  double w_radps = 0.0;
  friend bool operator==(const BaseMotion& a, const BaseMotion& b) {
    return a.v_mps == b.v_mps && a.w_radps == b.w_radps;
  }
};

/// What of DRIVE_PERMIT concerns the base.
struct BasePermit {
  std::int64_t session = 0;
  std::int64_t sequence = 0;
  std::int64_t utime = 0;     ///< Its stamp; never compared with the base's clock itself [us].
  std::int64_t valid_us = 0;  ///< After its arrival; not positive: no motion.
  double forward_mps = 0.0;
  double backward_mps = 0.0;
  double turn_left_radps = 0.0;
  double turn_right_radps = 0.0;
};

/// What of DRIVE_COMMAND concerns the base.
struct BaseCommand {
  std::int64_t session = 0;
  std::int64_t sequence = 0;
  std::int64_t utime = 0;
  BaseMotion motion;
};

/// The rule for one stream of messages, whatever became of its publisher: a message counts only
/// while it is young by the receiver's own clock, its sequence ascends, it does not come late, and
/// it comes from the one publisher that the base has locked to. Messages of others are ignored and
/// counted, until that one has been silent for unlock_us. O(1). Thread safety: none.
class StreamGate {
 public:
  explicit StreamGate(const BaseGateConfig& config) : config_(config) {}

  /// A message arrived. True when its content is to replace what is held.
  bool OnMessage(std::int64_t session,
                 std::int64_t sequence,
                 std::int64_t utime,
                 std::int64_t now_us) {
    if (is_locked_ && session != session_) {
      if (now_us - heard_us_ <= config_.unlock_us) {
        ++num_foreign_;
        return false;
      }
      is_locked_ = false;
    }
    heard_us_ = now_us;
    if (!is_locked_) {
      is_locked_ = true;
      session_ = session;
      freshness_.Reset();
    } else if (sequence <= sequence_) {
      ++num_repeated_;
      is_repeated_ = true;
      return false;
    }
    sequence_ = sequence;
    is_repeated_ = false;
    freshness_.OnArrival(now_us, utime);
    return true;
  }

  [[nodiscard]] GateState State(std::int64_t now_us, std::int64_t validity_us) const {
    const FreshnessWatch::State freshness = freshness_.Query(now_us);
    if (!freshness.has_arrived) return GateState::kNone;
    if (is_repeated_) return GateState::kRepeated;
    if (freshness.age_us > validity_us) return GateState::kStale;
    if (freshness.lateness_us > config_.max_lateness_us) return GateState::kLate;
    return GateState::kValid;
  }

  [[nodiscard]] std::int64_t num_foreign() const { return num_foreign_; }
  [[nodiscard]] std::int64_t num_repeated() const { return num_repeated_; }

 private:
  BaseGateConfig config_;
  bool is_locked_ = false;
  std::int64_t session_ = 0;
  std::int64_t sequence_ = 0;  // Highest of the session.
  std::int64_t heard_us_ = 0;  // Last message of the session, good or not.
  bool is_repeated_ = false;
  FreshnessWatch freshness_;
  std::int64_t num_foreign_ = 0;
  std::int64_t num_repeated_ = 0;
};

/// What a base may drive: what is wished or commanded, cut to the permit, and nothing at all unless
/// the permit is valid. Each of the four limits is applied by itself, so that a permit that forbids
/// to go ahead still lets the vehicle turn away. O(1). Thread safety: none.
class BaseGate {
 public:
  /// Faster than this is no wish of a vehicle but a broken number.
  static constexpr double kAbsurdSpeed = 100.0;  // [m/s] and [rad/s]

  explicit BaseGate(const BaseGateConfig& config = {})
      : config_(config), permits_(config), commands_(config) {}

  /// A permit arrived. True when its limits replace those held.
  bool OnPermit(const BasePermit& permit, std::int64_t now_us) {
    if (!permits_.OnMessage(permit.session, permit.sequence, permit.utime, now_us)) return false;
    is_permit_absurd_ = !(IsLimit(permit.forward_mps) && IsLimit(permit.backward_mps) &&
                          IsLimit(permit.turn_left_radps) && IsLimit(permit.turn_right_radps));
    if (is_permit_absurd_) ++num_absurd_;
    permit_ = permit;
    return true;
  }

  /// A command arrived. True when it replaces the one held.
  bool OnCommand(const BaseCommand& command, std::int64_t now_us) {
    if (!commands_.OnMessage(command.session, command.sequence, command.utime, now_us)) {
      return false;
    }
    is_command_absurd_ = !IsMotion(command.motion);
    if (is_command_absurd_) ++num_absurd_;
    command_ = command.motion;
    return true;
  }

  [[nodiscard]] GateState PermitState(std::int64_t now_us) const {
    const std::int64_t validity_us =
        std::clamp<std::int64_t>(permit_.valid_us, -1, config_.validity_us);
    const GateState state = permits_.State(now_us, validity_us);
    if (state != GateState::kValid) return state;
    if (permit_.valid_us <= 0) return GateState::kStale;
    return is_permit_absurd_ ? GateState::kAbsurd : state;
  }

  [[nodiscard]] GateState CommandState(std::int64_t now_us) const {
    const GateState state = commands_.State(now_us, config_.command_validity_us);
    return state == GateState::kValid && is_command_absurd_ ? GateState::kAbsurd : state;
  }

  /// The part of a wish that is permitted now; standstill unless the permit is valid and the wish
  /// makes sense.
  [[nodiscard]] BaseMotion Clip(const BaseMotion& wish, std::int64_t now_us) const {
    if (PermitState(now_us) != GateState::kValid || !IsMotion(wish)) return {};
    return {std::clamp(wish.v_mps, -permit_.backward_mps, permit_.forward_mps),
            std::clamp(wish.w_radps, -permit_.turn_right_radps, permit_.turn_left_radps)};
  }

  /// The command; standstill unless it is valid. Not cut to the permit.
  [[nodiscard]] BaseMotion Command(std::int64_t now_us) const {
    return CommandState(now_us) == GateState::kValid ? command_ : BaseMotion{};
  }

  /// The stricter of DRIVE_COMMAND and DRIVE_PERMIT: what a base that is commanded drives.
  [[nodiscard]] BaseMotion Commanded(std::int64_t now_us) const {
    return Clip(Command(now_us), now_us);
  }

  /// Finite and no faster than anything that drives.
  [[nodiscard]] static bool IsMotion(const BaseMotion& motion) {
    return std::abs(motion.v_mps) <= kAbsurdSpeed && std::abs(motion.w_radps) <= kAbsurdSpeed;
  }

  [[nodiscard]] std::int64_t num_foreign_permits() const { return permits_.num_foreign(); }
  [[nodiscard]] std::int64_t num_repeated_permits() const { return permits_.num_repeated(); }
  [[nodiscard]] std::int64_t num_foreign_commands() const { return commands_.num_foreign(); }
  [[nodiscard]] std::int64_t num_repeated_commands() const { return commands_.num_repeated(); }
  /// Permits and commands whose numbers meant nothing.
  [[nodiscard]] std::int64_t num_absurd() const { return num_absurd_; }

 private:
  // A limit may be large: clipping to it is then no clipping. NaN fails every comparison.
  static bool IsLimit(double limit) { return limit >= 0.0; }

  BaseGateConfig config_;
  StreamGate permits_;
  StreamGate commands_;
  BasePermit permit_;
  BaseMotion command_;
  bool is_permit_absurd_ = false;
  bool is_command_absurd_ = false;
  std::int64_t num_absurd_ = 0;
};

}  // namespace clearway::core
