// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/pose.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "common/core/geometry/pose_buffer.hpp"

namespace clearway::messages {
namespace {

TEST(PoseMessageTest, GivesBackThePoseThatItWasMadeFrom) {
  for (const double yaw_rad : {-3.1, -1.0, 0.0, 0.5, 3.1}) {
    const Eigen::Isometry3d pose = core::FromRpy({1.5, -2.0, 0.3}, {0.1, -0.2, yaw_rad});

    const Eigen::Isometry3d again = T_map_vehicle(ToPose(17, pose));

    EXPECT_TRUE(again.isApprox(pose, 1e-12)) << yaw_rad;
  }
}

TEST(PoseMessageTest, NormalisesAQuaternionOfAnotherLength) {
  pose_t message = ToPose(17, core::FromRpy({0, 0, 0}, {0, 0, 0.7}));
  for (double& component : message.orientation) component *= 3.0;

  EXPECT_TRUE(T_map_vehicle(message).isApprox(core::FromRpy({0, 0, 0}, {0, 0, 0.7}), 1e-12));
}

TEST(PoseMessageTest, AQuaternionOfLengthZeroOrNanIsRefusedByTheBuffer) {
  core::PoseBuffer buffer;
  pose_t zero{};
  pose_t nan = ToPose(17, Eigen::Isometry3d::Identity());
  nan.pos[1] = std::numeric_limits<double>::quiet_NaN();

  EXPECT_EQ(buffer.Add(1, T_map_vehicle(zero)), core::PoseBuffer::Outcome::kInvalid);
  EXPECT_EQ(buffer.Add(1, T_map_vehicle(nan)), core::PoseBuffer::Outcome::kInvalid);
}

TEST(PoseMessageTest, TheStatusHoldsVariancesOnItsDiagonal) {
  const pose_status_t status = ToPoseStatus(17, {.position_sigma_m = 0.1, .yaw_sigma_rad = 0.02});

  EXPECT_EQ(status.utime, 17);
  EXPECT_EQ(status.state, pose_status_t::STATE_GOOD);
  EXPECT_DOUBLE_EQ(status.covariance[0], 0.01);
  EXPECT_DOUBLE_EQ(status.covariance[7], 0.01);
  EXPECT_DOUBLE_EQ(status.covariance[35], 0.0004);
}

}  // namespace
}  // namespace clearway::messages
