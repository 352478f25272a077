// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/guard/base_gate.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/scan/visit_check.hpp"

namespace clearway::core {
namespace {

constexpr std::int64_t kPeriod_us = 20'000;
constexpr std::int64_t kEpoch_us = 1'600'000'000'000'000;
constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr BaseMotion kStand{};

BasePermit PermitOf(std::int64_t session, std::int64_t sequence, std::int64_t utime) {
  return {session, sequence, utime, 100'000, 0.6, 0.3, 1.0, 0.5};
}

bool Permit(BaseGate& gate,
            std::int64_t session,
            std::int64_t sequence,
            std::int64_t utime,
            std::int64_t now_us) {
  return gate.OnPermit(PermitOf(session, sequence, utime), now_us);
}

// Publishes permits first..last at 50 Hz; the time of the last one.
std::int64_t Publish(BaseGate& gate, std::int64_t first, std::int64_t last) {
  for (std::int64_t i = first; i <= last; ++i) {
    EXPECT_TRUE(Permit(gate, 1, i, kEpoch_us + i * kPeriod_us, i * kPeriod_us));
  }
  return last * kPeriod_us;
}

bool IsValid(const BaseGate& gate, std::int64_t now_us) {
  return gate.PermitState(now_us) == GateState::kValid;
}

TEST(BaseGate, HasDefaultsWithinItsBounds) {
  EXPECT_THAT(test::FaultsOfDefaults<BaseGateConfig>(), testing::IsEmpty());
}

TEST(BaseGate, MeansStopBeforeTheFirstPermit) {
  const BaseGate gate;

  EXPECT_EQ(gate.PermitState(0), GateState::kNone);
  EXPECT_EQ(gate.Clip({0.5, 0.5}, 0), kStand);
}

TEST(BaseGate, LetsAPermitCountForItsValidityAndNoLonger) {
  BaseGate gate;
  const std::int64_t now = Publish(gate, 0, 10);

  EXPECT_TRUE(IsValid(gate, now + 100'000));
  EXPECT_EQ(gate.PermitState(now + 100'001), GateState::kStale);
  EXPECT_EQ(gate.Clip({0.5, 0.5}, now + 100'001), kStand);
}

TEST(BaseGate, TakesTheShorterOfItsOwnValidityAndThePermits) {
  BaseGate gate;
  BasePermit permit = PermitOf(1, 0, kEpoch_us);

  permit.valid_us = 30'000;
  gate.OnPermit(permit, 0);

  EXPECT_TRUE(IsValid(gate, 30'000));
  EXPECT_EQ(gate.PermitState(30'001), GateState::kStale);

  permit.sequence = 1;
  permit.valid_us = kMax;
  gate.OnPermit(permit, 0);

  EXPECT_TRUE(IsValid(gate, 100'000));
  EXPECT_EQ(gate.PermitState(100'001), GateState::kStale);
}

TEST(BaseGate, TakesAPermitWithoutValidityAsNone) {
  for (const std::int64_t valid_us : {std::int64_t{0}, std::int64_t{-1}, kMin}) {
    BaseGate gate;
    BasePermit permit = PermitOf(1, 0, kEpoch_us);
    permit.valid_us = valid_us;

    gate.OnPermit(permit, 0);

    EXPECT_EQ(gate.PermitState(0), GateState::kStale) << valid_us;
    EXPECT_EQ(gate.Clip({0.5, 0.5}, 0), kStand);
  }
}

TEST(BaseGate, MeansStopOnARepeatedSequenceUntilTheNextGoodOne) {
  BaseGate gate;
  const std::int64_t now = Publish(gate, 0, 10);

  EXPECT_FALSE(Permit(gate, 1, 10, kEpoch_us + now, now + 1));
  EXPECT_EQ(gate.PermitState(now + 1), GateState::kRepeated);
  EXPECT_FALSE(Permit(gate, 1, 3, kEpoch_us + now, now + 2));
  EXPECT_EQ(gate.PermitState(now + 2), GateState::kRepeated);
  EXPECT_EQ(gate.Clip({0.5, 0.5}, now + 2), kStand);
  Publish(gate, 11, 11);

  EXPECT_TRUE(IsValid(gate, now + kPeriod_us));
  EXPECT_EQ(gate.num_repeated_permits(), 2);
}

TEST(BaseGate, IsNotKeptAliveByAFrozenPermitThatIsRepeated) {
  BaseGate gate;
  std::int64_t now = Publish(gate, 0, 10);

  for (int i = 0; i < 100; ++i) {
    now += kPeriod_us;
    Permit(gate, 1, 10, kEpoch_us + 10 * kPeriod_us, now);
    EXPECT_FALSE(IsValid(gate, now));
  }
}

TEST(BaseGate, MeansStopWhileAFrozenGuardDrainsItsQueue) {
  BaseGate gate;
  const std::int64_t now = Publish(gate, 0, 10) + 1'000'000;

  for (std::int64_t i = 11; i < 50; ++i) {
    Permit(gate, 1, i, kEpoch_us + i * kPeriod_us, now + i);
    EXPECT_EQ(gate.PermitState(now + i), GateState::kLate);
    EXPECT_EQ(gate.Clip({0.5, 0.5}, now + i), kStand);
  }
}

TEST(BaseGate, ObeysOnePublisherAndIgnoresTheOther) {
  BaseGate gate;
  const std::int64_t now = Publish(gate, 0, 10);

  EXPECT_FALSE(Permit(gate, 2, 1000, kEpoch_us, now + 50'000));
  EXPECT_EQ(gate.PermitState(now + 110'000), GateState::kStale)
      << "the other one's permit keeps nothing alive";
  EXPECT_FALSE(Permit(gate, 2, 1001, kEpoch_us, now + 1'000'000));
  EXPECT_EQ(gate.num_foreign_permits(), 2);
}

TEST(BaseGate, UnlocksOnceItsPublisherHasBeenSilent) {
  BaseGate gate;
  const std::int64_t now = Publish(gate, 100, 110);

  EXPECT_TRUE(Permit(gate, 2, 0, kEpoch_us, now + 1'000'001));
  EXPECT_TRUE(IsValid(gate, now + 1'000'001));
  EXPECT_FALSE(Permit(gate, 1, 111, kEpoch_us, now + 1'000'002)) << "locked to the new one";
}

TEST(BaseGate, AcceptsAnyNumbers) {
  BaseGate gate;

  EXPECT_TRUE(Permit(gate, -7, kMin, -5, 0));
  EXPECT_TRUE(Permit(gate, -7, kMax, -4, 1));
  EXPECT_FALSE(Permit(gate, -7, kMax, kMin, 2));
  EXPECT_TRUE(Permit(gate, kMin, kMin, kMax, 2'000'000));
}

struct Case {
  BaseMotion wish;
  BaseMotion permitted;
};

TEST(BaseGate, CutsEachDirectionByItsOwnLimit) {
  BaseGate gate;
  const std::int64_t now = Publish(gate, 0, 0);
  const std::vector<Case> cases{{{0.5, 0.4}, {0.5, 0.4}},
                                {{0.6, 1.0}, {0.6, 1.0}},
                                {{0.7, 1.1}, {0.6, 1.0}},
                                {{-0.7, -1.1}, {-0.3, -0.5}},
                                {{50.0, 0.0}, {0.6, 0.0}},
                                {{0.0, 0.0}, {0.0, 0.0}}};

  for (const Case& c : cases) {
    EXPECT_EQ(gate.Clip(c.wish, now), c.permitted) << c.wish.v_mps << ' ' << c.wish.w_radps;
  }
}

TEST(BaseGate, LetsTheVehicleTurnAwayFromWhatIsAhead) {
  BaseGate gate;
  BasePermit permit = PermitOf(1, 0, kEpoch_us);
  permit.forward_mps = 0.0;

  gate.OnPermit(permit, 0);

  EXPECT_EQ(gate.Clip({0.5, 0.4}, 0), (BaseMotion{0.0, 0.4}));
}

TEST(BaseGate, StandsForAWishThatMakesNoSense) {
  BaseGate gate;
  const std::int64_t now = Publish(gate, 0, 0);

  for (const double bad : {kNan, kInfinity, -kInfinity, 100.001, -1e300}) {
    EXPECT_EQ(gate.Clip({bad, 0.1}, now), kStand) << bad;
    EXPECT_EQ(gate.Clip({0.1, bad}, now), kStand) << bad;
  }
  EXPECT_EQ(gate.Clip({0.1, 0.1}, now), (BaseMotion{0.1, 0.1})) << "the wish, not the gate, is bad";
}

TEST(BaseGate, StandsForAPermitThatMakesNoSenseUntilTheNextGoodOne) {
  for (const double bad : {kNan, -0.001, -kInfinity}) {
    for (int field = 0; field < 4; ++field) {
      BaseGate gate;
      Publish(gate, 0, 0);
      BasePermit permit = PermitOf(1, 1, kEpoch_us + kPeriod_us);
      double* const limits[] = {&permit.forward_mps,
                                &permit.backward_mps,
                                &permit.turn_left_radps,
                                &permit.turn_right_radps};
      *limits[field] = bad;

      EXPECT_TRUE(gate.OnPermit(permit, kPeriod_us));

      EXPECT_EQ(gate.PermitState(kPeriod_us), GateState::kAbsurd);
      EXPECT_EQ(gate.Clip({0.1, 0.1}, kPeriod_us), kStand);
      EXPECT_EQ(gate.num_absurd(), 1);
      const std::int64_t now = Publish(gate, 2, 2);
      EXPECT_EQ(gate.Clip({0.1, 0.1}, now), (BaseMotion{0.1, 0.1}));
    }
  }
}

BaseCommand CommandOf(std::int64_t sequence, BaseMotion motion) {
  return {9, sequence, kEpoch_us + sequence * kPeriod_us, motion};
}

TEST(BaseGate, DrivesTheStricterOfCommandAndPermit) {
  BaseGate gate;
  Publish(gate, 0, 0);

  EXPECT_EQ(gate.Commanded(0), kStand) << "no command yet";
  gate.OnCommand(CommandOf(0, {0.2, 0.1}), 0);
  EXPECT_EQ(gate.Commanded(0), (BaseMotion{0.2, 0.1})) << "the command is stricter";
  gate.OnCommand(CommandOf(1, {2.0, -2.0}), kPeriod_us);
  EXPECT_EQ(gate.Commanded(kPeriod_us), (BaseMotion{0.6, -0.5})) << "the permit is stricter";
  EXPECT_EQ(gate.Commanded(100'001), kStand) << "the permit is gone";
}

TEST(BaseGate, StandsWhenCommandsStop) {
  BaseGate gate;
  gate.OnCommand(CommandOf(0, {0.2, 0.1}), 0);
  Publish(gate, 0, 11);

  EXPECT_EQ(gate.Commanded(200'000), (BaseMotion{0.2, 0.1}));
  EXPECT_EQ(gate.Commanded(200'001), kStand);
  EXPECT_EQ(gate.CommandState(200'001), GateState::kStale);
}

TEST(BaseGate, StandsForCommandsThatAreRepeatedLateOrMakeNoSense) {
  BaseGate gate;
  Publish(gate, 0, 0);
  gate.OnCommand(CommandOf(0, {0.2, 0.1}), 0);

  gate.OnCommand(CommandOf(0, {0.2, 0.1}), 1);
  EXPECT_EQ(gate.CommandState(1), GateState::kRepeated);
  EXPECT_EQ(gate.Commanded(1), kStand);
  gate.OnCommand(CommandOf(1, {kNan, 0.1}), kPeriod_us);
  EXPECT_EQ(gate.CommandState(kPeriod_us), GateState::kAbsurd);
  EXPECT_EQ(gate.Commanded(kPeriod_us), kStand);
  gate.OnCommand(CommandOf(2, {0.2, 0.1}), 2 * kPeriod_us + 110'000);
  EXPECT_EQ(gate.CommandState(2 * kPeriod_us + 110'000), GateState::kLate);
}

TEST(BaseGate, KeepsCommandAndPermitPublishersApart) {
  BaseGate gate;
  Publish(gate, 0, 0);

  EXPECT_TRUE(gate.OnCommand(CommandOf(0, {0.2, 0.1}), 0)) << "another session than the permit's";
  BaseCommand other = CommandOf(1, {0.5, 0.0});
  other.session = 10;
  EXPECT_FALSE(gate.OnCommand(other, 1));

  EXPECT_EQ(gate.Commanded(1), (BaseMotion{0.2, 0.1}));
  EXPECT_EQ(gate.num_foreign_commands(), 1);
  EXPECT_EQ(gate.num_foreign_permits(), 0);
}

// Whatever arrives in whatever order, nothing faster than the last limits ever leaves the gate, and
// nothing at all 0.1 s after the last accepted permit.
TEST(BaseGate, NeverExceedsThePermitForRandomStreams) {
  std::uint64_t state = 12345;
  const auto random = [&state](std::int64_t n) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<std::int64_t>((state >> 33U) % static_cast<std::uint64_t>(n));
  };
  BaseGate gate;
  BasePermit last;
  std::int64_t accepted_us = -1'000'000;
  for (std::int64_t now = 0; now < 200'000'000; now += random(60'000)) {
    BasePermit permit = PermitOf(1 + random(100) / 98, random(5) + now / 20'000, kEpoch_us + now);
    permit.forward_mps = 0.01 * static_cast<double>(random(100));
    if (gate.OnPermit(permit, now)) {
      last = permit;
      accepted_us = now;
    }

    const std::int64_t asked_us = now + random(150'000);
    const BaseMotion motion = gate.Clip({0.9, 0.9}, asked_us);

    EXPECT_LE(motion.v_mps, last.forward_mps);
    EXPECT_TRUE(asked_us - accepted_us <= 100'000 || motion == kStand) << asked_us;
  }
  EXPECT_GT(gate.num_repeated_permits(), 0);
  EXPECT_GT(gate.num_foreign_permits(), 0);
}

}  // namespace
}  // namespace clearway::core
