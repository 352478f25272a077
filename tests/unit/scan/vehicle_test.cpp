// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/vehicle.hpp"

#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/geometry/pose_buffer.hpp"
#include "common/core/scan/scan_assembler.hpp"
#include "tests/unit/scan/visit_check.hpp"

namespace clearway::core {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(VehicleConfig, HasDefaultsThatKeepItsOwnRules) {
  EXPECT_THAT(test::FaultsOfDefaults<VehicleConfig>(), IsEmpty());
  EXPECT_THAT(VehicleConfig{}.Validate(), IsEmpty());
  EXPECT_THAT(SensorConfig{}.Validate(), IsEmpty());
  EXPECT_THAT(test::FaultsOfDefaults<PoseBufferConfig>(), IsEmpty());
  EXPECT_THAT(test::FaultsOfDefaults<ScanAssemblerConfig>(), IsEmpty());
}

struct BadFootprint {
  const char* what;
  std::vector<VertexConfig> footprint;
};

class VehicleFootprintTest : public testing::TestWithParam<BadFootprint> {};

TEST_P(VehicleFootprintTest, IsRefused) {
  VehicleConfig vehicle;
  vehicle.footprint = GetParam().footprint;

  EXPECT_THAT(vehicle.Validate(), SizeIs(1)) << GetParam().what;
}

INSTANTIATE_TEST_SUITE_P(
    Bad,
    VehicleFootprintTest,
    testing::Values(BadFootprint{"two corners", {{0, 0}, {1, 0}}},
                    BadFootprint{"no corner", {}},
                    BadFootprint{"clockwise", {{0, 0}, {0, 1}, {1, 1}, {1, 0}}},
                    BadFootprint{"dented", {{0, 0}, {2, 0}, {0.5, 0.5}, {0, 2}}},
                    BadFootprint{"a corner twice", {{0, 0}, {0, 0}, {1, 0}, {0, 1}}},
                    BadFootprint{"on one line", {{0, 0}, {1, 0}, {2, 0}}},
                    BadFootprint{
                        "a star that goes round twice",
                        {{1, 0}, {-0.81, 0.59}, {0.31, -0.95}, {0.31, 0.95}, {-0.81, -0.59}}}));

TEST(VehicleConfig, RefusesABodyBoxThatWouldHideObstacles) {
  VehicleConfig vehicle;
  vehicle.body = {{-0.2, 0.3, -0.2, 0.2, 0.0, 0.5}};
  EXPECT_THAT(vehicle.Validate(), IsEmpty());

  vehicle.body[0].x_max_m = 0.31;

  EXPECT_THAT(vehicle.Validate(), testing::ElementsAre(HasSubstr("body box")));
}

TEST(VehicleConfig, RefusesTwoSensorsOfOneNameAndNone) {
  VehicleConfig vehicle;
  vehicle.sensors = {SensorConfig{}, SensorConfig{}};
  EXPECT_THAT(vehicle.Validate(), testing::ElementsAre(HasSubstr("'front'")));

  vehicle.sensors.clear();

  EXPECT_THAT(vehicle.Validate(), SizeIs(1));
}

TEST(SensorConfig, LooksWhereItsAnglesPoint) {
  SensorConfig sensor;
  sensor.x_m = 0.1;
  sensor.y_m = 0.2;
  sensor.z_m = 0.3;
  sensor.yaw_rad = std::numbers::pi / 2.0;
  sensor.pitch_rad = std::numbers::pi / 6.0;

  const Eigen::Vector3d seen_vehicle = sensor.T_vehicle_sensor() * Eigen::Vector3d(2.0, 0.0, 0.0);

  EXPECT_TRUE(seen_vehicle.isApprox(
      Eigen::Vector3d(0.1, 0.2 + 2.0 * std::numbers::sqrt3 / 2.0, 0.3 - 1.0), 1e-9));
}

TEST(VehicleConfig, FindsItsSensorsByName) {
  VehicleConfig vehicle;
  vehicle.sensors.push_back(SensorConfig{.name = "rear"});

  EXPECT_EQ(vehicle.FindSensor("rear"), 1);
  EXPECT_EQ(vehicle.FindSensor("roof"), std::nullopt);
}

}  // namespace
}  // namespace clearway::core
