// SPDX-License-Identifier: BSD-3-Clause
#include "tools/teleop/operator_wish.hpp"

#include <algorithm>
#include <cstdint>

#include <gtest/gtest.h>

namespace clearway::teleop {
namespace {

constexpr OperatorLimits kLimits{1.0, 0.5, 1.5};
constexpr std::int64_t kTap_us = 200'000;
constexpr core::BaseMotion kStand{};

TEST(OperatorWish, IsStandstillBeforeAnyKey) {
  EXPECT_EQ(OperatorWish(kLimits).At(0), kStand);
}

TEST(OperatorWish, GrowsByAStepWithEachPressUpToTheLimit) {
  OperatorWish wish(kLimits);
  std::int64_t now = 0;
  for (int press = 1; press <= 8; ++press) {
    now += kTap_us;
    wish.OnKey(Key::kForward, now);
    EXPECT_NEAR(wish.At(now).v_mps, std::min(1.0, 0.2 * press), 1e-12);
  }
}

TEST(OperatorWish, GoesThroughStandstillToBackwardWithItsOwnLimit) {
  OperatorWish wish(kLimits);
  wish.OnKey(Key::kForward, kTap_us);

  wish.OnKey(Key::kBackward, 2 * kTap_us);
  EXPECT_EQ(wish.At(2 * kTap_us), kStand);
  wish.OnKey(Key::kBackward, 3 * kTap_us);

  EXPECT_NEAR(wish.At(3 * kTap_us).v_mps, -0.1, 1e-12);
}

TEST(OperatorWish, TurnsLeftAndRight) {
  OperatorWish wish(kLimits);

  wish.OnKey(Key::kLeft, kTap_us);
  EXPECT_NEAR(wish.At(kTap_us).w_radps, 0.3, 1e-12);
  wish.OnKey(Key::kRight, 2 * kTap_us);
  wish.OnKey(Key::kRight, 3 * kTap_us);

  EXPECT_NEAR(wish.At(3 * kTap_us).w_radps, -0.3, 1e-12);
}

TEST(OperatorWish, KeepsItsSpeedWhileAKeyIsHeld) {
  OperatorWish wish(kLimits);
  // A terminal repeats after half a second, then 25 times a second.
  std::int64_t now = kTap_us;
  wish.OnKey(Key::kForward, now);
  now += 500'000;
  wish.OnKey(Key::kForward, now);
  const double v_mps = wish.At(now).v_mps;
  for (int i = 0; i < 100; ++i) {
    now += 40'000;
    wish.OnKey(Key::kForward, now);
  }

  EXPECT_EQ(wish.At(now).v_mps, v_mps);
  EXPECT_NEAR(v_mps, 0.4, 1e-12) << "the first repeat cannot be told from a press";
}

TEST(OperatorWish, IsStandstillWithoutAKeyForTheDeadMansTime) {
  OperatorWish wish(kLimits);
  wish.OnKey(Key::kForward, kTap_us);

  EXPECT_NE(wish.At(kTap_us + 600'000), kStand);
  EXPECT_EQ(wish.At(kTap_us + 600'001), kStand);
  wish.OnKey(Key::kOther, kTap_us + 700'000);
  EXPECT_EQ(wish.At(kTap_us + 700'000), kStand) << "any other key drives nothing";
  wish.OnKey(Key::kForward, kTap_us + 800'000);
  EXPECT_NEAR(wish.At(kTap_us + 800'000).v_mps, 0.2, 1e-12) << "from standstill again";
}

TEST(OperatorWish, StopsAtOnce) {
  for (const Key key : {Key::kStop, Key::kQuit}) {
    OperatorWish wish(kLimits);
    wish.OnKey(Key::kForward, kTap_us);
    wish.OnKey(Key::kLeft, kTap_us + 1);

    wish.OnKey(key, kTap_us + 2);

    EXPECT_EQ(wish.At(kTap_us + 2), kStand);
  }
}

TEST(OperatorWish, IsNotKeptAliveByOtherKeys) {
  OperatorWish wish(kLimits);
  wish.OnKey(Key::kForward, kTap_us);

  wish.OnKey(Key::kOther, kTap_us + 500'000);

  EXPECT_EQ(wish.At(kTap_us + 600'001), kStand);
}

}  // namespace
}  // namespace clearway::teleop
