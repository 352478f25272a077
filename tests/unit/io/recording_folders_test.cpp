// SPDX-License-Identifier: BSD-3-Clause
// Real recordings as sequences of scans.
#include <cstddef>
#include <ostream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/cloud_source.hpp"
#include "tests/support/test_data.hpp"

namespace clearway::io {
namespace {

TEST(Recordings, OfALongLivoxCloudAreCutIntoScans) {
  const char* file = "livox/mid100_street.pcd";
  const auto path = test::TestData(file);
  if (!path) GTEST_SKIP() << test::MissingData(file);

  CloudSource source(*path, {.points_per_scan = 10000});

  ASSERT_EQ(source.size(), 25U);
  EXPECT_EQ(source.Read(0).cloud.size(), 10000U);
  EXPECT_EQ(source.Read(24).cloud.size(), 887U);
}

TEST(Recordings, OfAWalkingPersonHaveStampsInTheirNames) {
  const char* folder = "indoor_people/consecutive";
  const auto path = test::TestData(folder);
  if (!path) GTEST_SKIP() << test::MissingData(folder);

  CloudSource source(*path, {.floats_per_point = 3, .stamp = StampSource::kName});

  ASSERT_EQ(source.size(), 30U);
  EXPECT_EQ(source.utime(0), 1744500470786466);
  EXPECT_EQ(source.utime(29), 1744500473711379);
  EXPECT_EQ(source.Read(0).name, "velodyne/1744500470.786466599.bin");
  EXPECT_EQ(source.Read(0).cloud.size(), 28543U);
}

struct BinFolder {
  const char* folder;
  int floats;
  std::size_t scans;
  double far_m;  ///< No coordinate is beyond this: a wrong layout would give nonsense.
};

void PrintTo(const BinFolder& folder, std::ostream* out) {
  *out << folder.folder;
}

class BinFolderTest : public testing::TestWithParam<BinFolder> {};

TEST_P(BinFolderTest, IsReadWithPlausibleCoordinates) {
  const auto path = test::TestData(GetParam().folder);
  if (!path) GTEST_SKIP() << test::MissingData(GetParam().folder);

  CloudSource source(*path, {.floats_per_point = GetParam().floats, .intensity_scale = 255.0});

  ASSERT_EQ(source.size(), GetParam().scans);
  for (std::size_t i = 0; i < source.size(); ++i) {
    const core::PointCloud cloud = source.Read(i).cloud;
    EXPECT_GT(cloud.size(), 1000U);
    for (std::size_t p = 0; p < cloud.size(); ++p) {
      ASSERT_TRUE(core::IsFinite(cloud, p));
      ASSERT_LT(cloud.Point(p).cast<double>().cwiseAbs().maxCoeff(), GetParam().far_m);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All,
                         BinFolderTest,
                         testing::Values(BinFolder{"indoor_people/sparse", 3, 8, 60.0},
                                         BinFolder{"kitti_object", 4, 6, 130.0},
                                         BinFolder{"kitti_full", 4, 2, 130.0},
                                         BinFolder{"kitti_tracking", 4, 8, 130.0},
                                         BinFolder{"argoverse2", 4, 1, 400.0},
                                         BinFolder{"livox/livox_horizon.bin", 4, 1, 400.0}));

}  // namespace
}  // namespace clearway::io
