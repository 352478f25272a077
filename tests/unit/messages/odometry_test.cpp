// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/odometry.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "common/core/geometry/pose_buffer.hpp"

namespace clearway::messages {
namespace {

constexpr double kRounding = 1e-12;

odometry_t Odometry(const std::array<double, 4>& orientation_wxyz) {
  odometry_t message{};
  message.pos[0] = 1.0;
  message.pos[1] = 2.0;
  message.pos[2] = 3.0;
  for (std::size_t i = 0; i < 4; ++i) message.orientation[i] = orientation_wxyz[i];
  return message;
}

TEST(OdometryTest, TurnsAndMovesPointsOfTheVehicle) {
  const double half_right_angle = std::acos(0.0) / 2.0;
  const odometry_t message =
      Odometry({std::cos(half_right_angle), 0.0, 0.0, std::sin(half_right_angle)});

  const Eigen::Vector3d point_odom = T_odom_vehicle(message) * Eigen::Vector3d(1.0, 0.0, 0.0);

  EXPECT_TRUE(point_odom.isApprox(Eigen::Vector3d(1.0, 3.0, 3.0), kRounding)) << point_odom;
}

TEST(OdometryTest, AQuaternionThatIsNotOfUnitLengthIsNormalised) {
  const Eigen::Isometry3d unit = T_odom_vehicle(Odometry({0.5, 0.5, 0.5, 0.5}));

  for (const double scale : {1e-3, 0.99, 1.01, 1e3}) {
    const Eigen::Isometry3d scaled =
        T_odom_vehicle(Odometry({0.5 * scale, 0.5 * scale, 0.5 * scale, 0.5 * scale}));

    EXPECT_TRUE(scaled.isApprox(unit, kRounding)) << scale;
    EXPECT_NEAR(scaled.linear().determinant(), 1.0, kRounding);
  }
}

TEST(OdometryTest, AQuaternionThatIsNoneIsRefusedByThePoseBuffer) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const std::array<double, 4>& bad : {std::array{0.0, 0.0, 0.0, 0.0},
                                           std::array{nan, 0.0, 0.0, 1.0},
                                           std::array{1.0, infinity, 0.0, 0.0}}) {
    core::PoseBuffer buffer;

    EXPECT_EQ(buffer.Add(1000, T_odom_vehicle(Odometry(bad))), core::PoseBuffer::Outcome::kInvalid);
    EXPECT_EQ(buffer.size(), 0U);
  }
}

TEST(OdometryTest, APositionThatIsNoneIsRefusedByThePoseBuffer) {
  odometry_t message = Odometry({1.0, 0.0, 0.0, 0.0});
  message.pos[1] = std::numeric_limits<double>::quiet_NaN();
  core::PoseBuffer buffer;

  EXPECT_EQ(buffer.Add(1000, T_odom_vehicle(message)), core::PoseBuffer::Outcome::kInvalid);
}

}  // namespace
}  // namespace clearway::messages
