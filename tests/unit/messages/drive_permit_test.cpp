// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/drive_permit.hpp"

#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace clearway::messages {
namespace {

using core::Direction;
using core::PermitReason;

// Every reason of core with the constant of the same meaning.
const std::vector<std::pair<PermitReason, std::int8_t>> kReasons = {
    {PermitReason::kFree, drive_permit_t::REASON_FREE},
    {PermitReason::kObstacle, drive_permit_t::REASON_OBSTACLE},
    {PermitReason::kUnseen, drive_permit_t::REASON_UNSEEN},
    {PermitReason::kNoDetections, drive_permit_t::REASON_NO_DETECTIONS},
    {PermitReason::kStarting, drive_permit_t::REASON_STARTING},
    {PermitReason::kSensorSilent, drive_permit_t::REASON_SENSOR_SILENT},
    {PermitReason::kSlicesLate, drive_permit_t::REASON_SLICES_LATE},
    {PermitReason::kTwoPublishers, drive_permit_t::REASON_TWO_PUBLISHERS},
    {PermitReason::kNoReturns, drive_permit_t::REASON_NO_RETURNS},
    {PermitReason::kNoOdometry, drive_permit_t::REASON_NO_ODOMETRY}};

core::DirectionPermit& At(core::Permit& permit, Direction direction) {
  return permit.directions[static_cast<std::size_t>(direction)];
}

TEST(DrivePermitTest, EveryReasonHasTheWiresConstantOfTheSameMeaning) {
  for (const auto& [reason, wire] : kReasons) {
    core::Permit permit;
    permit.reason = reason;

    EXPECT_EQ(ToLcm(permit).reason, wire) << ReasonText(reason);
  }
}

TEST(DrivePermitTest, EveryReasonHasATextOfItsOwn) {
  std::set<std::string> texts;
  for (const auto& [reason, wire] : kReasons) texts.insert(ReasonText(reason));

  EXPECT_EQ(texts.size(), kReasons.size());
  EXPECT_FALSE(texts.contains("unknown"));
  EXPECT_EQ(std::string(ReasonText(static_cast<PermitReason>(99))), "unknown");
}

TEST(DrivePermitTest, TheReasonsThatCloseTheGuardAreThoseFromTenOn) {
  for (const auto& [reason, wire] : kReasons) {
    core::Permit permit;
    permit.reason = reason;

    EXPECT_EQ(permit.is_closed(), wire >= 10) << ReasonText(reason);
  }
}

TEST(DrivePermitTest, EachLimitGoesToItsOwnField) {
  core::Permit permit;
  At(permit, Direction::kForward).limit = 1.0;
  At(permit, Direction::kBackward).limit = 2.0;
  At(permit, Direction::kTurnLeft).limit = 3.0;
  At(permit, Direction::kTurnRight).limit = 4.0;

  const drive_permit_t message = ToLcm(permit);

  EXPECT_EQ(message.forward_mps, 1.0);
  EXPECT_EQ(message.backward_mps, 2.0);
  EXPECT_EQ(message.turn_left_radps, 3.0);
  EXPECT_EQ(message.turn_right_radps, 4.0);
}

TEST(DrivePermitTest, SaysWhoDecided) {
  const std::vector<std::pair<PermitReason, std::int8_t>> paths = {
      {PermitReason::kFree, drive_permit_t::PATH_NONE},
      {PermitReason::kObstacle, drive_permit_t::PATH_POINTS},
      {PermitReason::kUnseen, drive_permit_t::PATH_NONE},
      {PermitReason::kNoDetections, drive_permit_t::PATH_WATCHDOG},
      {PermitReason::kStarting, drive_permit_t::PATH_WATCHDOG},
      {PermitReason::kNoOdometry, drive_permit_t::PATH_WATCHDOG}};

  for (const auto& [reason, path] : paths) {
    core::Permit permit;
    permit.reason = reason;
    EXPECT_EQ(ToLcm(permit).path, path) << ReasonText(reason);
  }
}

TEST(DrivePermitTest, TheCauseIsThatOfTheDirectionThatTheReasonIsAbout) {
  core::Permit permit;
  permit.cause_direction = Direction::kTurnLeft;
  At(permit, Direction::kForward).has_cause = true;
  At(permit, Direction::kForward).cause_vehicle = {9.0F, 9.0F, 9.0F};
  At(permit, Direction::kForward).free_way = 1.5;
  At(permit, Direction::kTurnLeft).has_cause = true;
  At(permit, Direction::kTurnLeft).cause_vehicle = {1.0F, 2.0F, 3.0F};

  const drive_permit_t message = ToLcm(permit);

  EXPECT_EQ(message.cause[0], 1.0);
  EXPECT_EQ(message.cause[1], 2.0);
  EXPECT_EQ(message.cause[2], 3.0);
  EXPECT_EQ(message.free_distance_m, 1.5);
}

TEST(DrivePermitTest, WithoutACauseItIsZeroAndTheWayIsMarkedFree) {
  core::Permit permit;
  At(permit, Direction::kForward).cause_vehicle = {9.0F, 9.0F, 9.0F};

  const drive_permit_t message = ToLcm(permit);

  for (const double coordinate : message.cause) EXPECT_EQ(coordinate, 0.0);
  EXPECT_EQ(message.free_distance_m, -1.0);
}

TEST(DrivePermitTest, ADefaultPermitForbidsAllMotion) {
  const drive_permit_t message = ToLcm(core::Permit{});

  EXPECT_EQ(message.forward_mps, 0.0);
  EXPECT_EQ(message.backward_mps, 0.0);
  EXPECT_EQ(message.turn_left_radps, 0.0);
  EXPECT_EQ(message.turn_right_radps, 0.0);
  EXPECT_EQ(message.reason, drive_permit_t::REASON_STARTING);
}

}  // namespace
}  // namespace clearway::messages
