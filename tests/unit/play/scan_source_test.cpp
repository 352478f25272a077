// SPDX-License-Identifier: BSD-3-Clause
#include "tools/play/scan_source.hpp"

#include <gtest/gtest.h>

#include "common/io/cloud_source.hpp"
#include "common/io/read_error.hpp"
#include "tests/support/test_data.hpp"

namespace clearway::play {
namespace {

graph::GraphConfig LabConfig() {
  return config::Load<graph::GraphConfig>(test::SourceFolder() / "config" / "lab_standing.xml")
      .root;
}

TEST(SceneSourceTest, HasAScanForEachPeriodOfTheTimeAsked) {
  const auto source =
      OpenSource(test::SourceFolder() / "config" / "lab_scene.xml", LabConfig(), 0.55);

  EXPECT_EQ(source->period_us(), 100'000);
  EXPECT_EQ(source->size(), 5U);
  EXPECT_EQ(source->utime(0), io::kFirstScanUtime);
  EXPECT_EQ(source->utime(4), io::kFirstScanUtime + 400'000);
}

TEST(SceneSourceTest, AScanIsTheSameEachTimeItIsReadAndUnlikeTheNext) {
  const auto source =
      OpenSource(test::SourceFolder() / "config" / "lab_scene.xml", LabConfig(), 0.3);

  const core::PointCloud first = source->Read(1).cloud_sensor;

  EXPECT_GT(first.size(), 1000U);
  EXPECT_EQ(source->Read(1).cloud_sensor.x, first.x);
  EXPECT_NE(source->Read(2).cloud_sensor.x, first.x);
  EXPECT_EQ(source->Read(1).utime, source->utime(1));
}

TEST(ScanSourceTest, WhatIsNotThereIsAReadError) {
  EXPECT_THROW((void)OpenSource("/no/such/folder", LabConfig(), 1.0), io::ReadError);
}

TEST(ScanSourceTest, ASceneThatIsNotThereIsAConfigError) {
  EXPECT_THROW((void)OpenSource("/no/such/scene.xml", LabConfig(), 1.0), config::ConfigError);
}

}  // namespace
}  // namespace clearway::play
