// SPDX-License-Identifier: BSD-3-Clause
#include "tools/teleop/status_line.hpp"

#include <gtest/gtest.h>

namespace clearway::teleop {
namespace {

using core::GateState;

drive_permit_t Blocked() {
  drive_permit_t permit{};
  permit.backward_mps = 0.5;
  permit.turn_left_radps = 1.5;
  permit.turn_right_radps = 0.7;
  permit.text = "obstacle";
  permit.free_distance_m = 0.62;
  permit.cause[0] = 0.92;
  permit.cause[1] = -0.11;
  permit.cause_utime = 1;
  return permit;
}

TEST(StatusLine, TellsWishPermitReasonAndCause) {
  EXPECT_EQ(
      StatusLine({0.4, -0.3}, GateState::kValid, Blocked(), 200),
      "wish 0.40 m/s -0.30 rad/s | permit 0.00 m/s, back 0.50, turn 1.50/0.70: obstacle, 0.62 "
      "m ahead, cause at (0.92, -0.11)");
}

TEST(StatusLine, LeavesOutWhatIsNotThere) {
  drive_permit_t permit{};
  permit.forward_mps = 1.0;
  permit.text = "free";
  permit.free_distance_m = -1.0;

  EXPECT_EQ(StatusLine({}, GateState::kValid, permit, 200),
            "wish 0.00 m/s 0.00 rad/s | permit 1.00 m/s: free");
}

TEST(StatusLine, SaysThatAPermitIsMissing) {
  EXPECT_EQ(StatusLine({}, GateState::kNone, {}, 200),
            "wish 0.00 m/s 0.00 rad/s | STOP: the permit has not come yet");
  EXPECT_EQ(StatusLine({}, GateState::kStale, Blocked(), 200),
            "wish 0.00 m/s 0.00 rad/s | STOP: the permit has stopped coming");
}

TEST(StatusLine, FitsItsWidth) {
  EXPECT_EQ(StatusLine({}, GateState::kValid, Blocked(), 12), "wish 0.00 m/");
  EXPECT_EQ(StatusLine({}, GateState::kValid, Blocked(), 0), "");
}

TEST(StatusLine, LetsNoTextOfOthersCommandTheTerminal) {
  drive_permit_t permit = Blocked();
  permit.text = "a\x1b[2Jb\n\x7f";

  const std::string line = StatusLine({}, GateState::kValid, permit, 200);

  EXPECT_NE(line.find("a?[2Jb??"), std::string::npos) << line;
}

}  // namespace
}  // namespace clearway::teleop
