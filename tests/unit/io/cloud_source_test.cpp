// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/cloud_source.hpp"

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/pcd_writer.hpp"
#include "tests/unit/io/temporary_folder.hpp"

namespace clearway::io {
namespace {

using test::TemporaryFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// n points with x = first, first + 1, ... as x y z floats.
std::string Points(int n, float first = 0.0F) {
  std::string bytes(static_cast<std::size_t>(n) * 12, '\0');
  for (int i = 0; i < n; ++i) {
    const float x = first + static_cast<float>(i);
    std::memcpy(&bytes[static_cast<std::size_t>(i) * 12], &x, 4);
  }
  return bytes;
}

TEST(CloudSource, PlaysAFolderAtARate) {
  const TemporaryFolder folder;
  folder.Write("v/2.bin", Points(1, 2.0F));
  folder.Write("v/10.bin", Points(1, 10.0F));
  folder.Write("v/3.bin", Points(2, 3.0F));

  CloudSource source(folder.path(), {.floats_per_point = 3, .rate_hz = 7.0});

  ASSERT_EQ(source.size(), 3U);
  EXPECT_EQ(source.period_us(), 142857);
  const ScanFile first = source.Read(0);
  const ScanFile last = source.Read(2);
  EXPECT_EQ(first.name, "v/2.bin");
  EXPECT_EQ(first.utime, kFirstScanUtime);
  EXPECT_THAT(first.cloud.x, ElementsAre(2.0F));
  EXPECT_THAT(source.Read(1).cloud.x, ElementsAre(3.0F, 4.0F));
  EXPECT_EQ(last.name, "v/10.bin");
  EXPECT_EQ(last.utime, kFirstScanUtime + 285714);  // Two periods, rounded once.
  EXPECT_THAT(last.cloud.x, ElementsAre(10.0F));
}

TEST(CloudSource, TakesStampsFromNames) {
  const TemporaryFolder folder;
  folder.Write("1744500470.786466599.bin", Points(1));
  folder.Write("1744500470.8.bin", Points(1));
  folder.Write("1744500471.01.bin", Points(1));

  const CloudSource source(folder.path(), {.floats_per_point = 3, .stamp = StampSource::kName});

  ASSERT_EQ(source.size(), 3U);
  EXPECT_EQ(source.utime(0), 1744500470786466);
  EXPECT_EQ(source.utime(1), 1744500470800000);
  EXPECT_EQ(source.utime(2), 1744500471010000);
}

TEST(CloudSource, RefusesNamesThatAreNoStamps) {
  const TemporaryFolder folder;
  folder.Write("000007.bin", Points(1));

  EXPECT_THAT([&] { CloudSource(folder.path(), {.stamp = StampSource::kName}); },
              ThrowsMessage<ReadError>(
                  AllOf(HasSubstr("000007.bin: the name is no stamp; expected seconds"),
                        HasSubstr("stamp=\"rate\""))));
}

TEST(CloudSource, RefusesStampsThatDoNotGrowAndNamesBothFiles) {
  const TemporaryFolder folder;
  folder.Write("a/1744500471.5.bin", Points(1));
  folder.Write("b/1744500470.5.bin", Points(1));
  const auto equal = folder.Write("list.txt", "a/1744500471.5.bin\na/1744500471.5.bin\n");

  EXPECT_THAT([&] { CloudSource(folder.path(), {.stamp = StampSource::kName}); },
              ThrowsMessage<ReadError>(
                  AllOf(HasSubstr("b/1744500470.5.bin: its stamp does not come after that of "
                                  "a/1744500471.5.bin"),
                        HasSubstr("stamp=\"rate\""))));
  EXPECT_THROW(CloudSource(equal, {.stamp = StampSource::kName}), ReadError);
  EXPECT_EQ(CloudSource(equal, {}).size(), 2U);
}

TEST(CloudSource, CutsALongCloudIntoScans) {
  const TemporaryFolder folder;
  const auto file = folder.Write("long.bin", Points(25));

  CloudSource source(file, {.floats_per_point = 3, .points_per_scan = 10, .rate_hz = 10.0});

  ASSERT_EQ(source.size(), 3U);
  std::vector<float> all;
  for (const std::size_t i : {0U, 1U, 2U}) {
    const ScanFile scan = source.Read(i);
    EXPECT_EQ(scan.name, "long.bin#" + std::to_string(i));
    EXPECT_EQ(scan.utime, kFirstScanUtime + static_cast<std::int64_t>(i) * 100'000);
    all.insert(all.end(), scan.cloud.x.begin(), scan.cloud.x.end());
  }
  EXPECT_EQ(source.Read(2).cloud.size(), 5U);
  ASSERT_EQ(all.size(), 25U);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i], static_cast<float>(i));
}

TEST(CloudSource, CutsEachOfSeveralCloudsByItself) {
  const TemporaryFolder folder;
  folder.Write("10.0.bin", Points(3, 0.0F));
  folder.Write("20.0.bin", Points(4, 100.0F));

  CloudSource source(
      folder.path(),
      {.floats_per_point = 3, .points_per_scan = 2, .stamp = StampSource::kName, .rate_hz = 4.0});

  ASSERT_EQ(source.size(), 4U);
  EXPECT_EQ(source.utime(1), 10'250'000);
  EXPECT_EQ(source.utime(2), 20'000'000);
  EXPECT_THAT(source.Read(3).cloud.x, ElementsAre(102.0F, 103.0F));
  EXPECT_THAT(source.Read(1).cloud.x, ElementsAre(2.0F));
  EXPECT_THAT(source.Read(0).cloud.x, ElementsAre(0.0F, 1.0F));
}

TEST(CloudSource, RefusesScansOfACutFileThatOverlapTheNextFile) {
  const TemporaryFolder folder;
  folder.Write("10.0.bin", Points(30));
  folder.Write("10.5.bin", Points(30));

  EXPECT_THAT(
      [&] {
        CloudSource(folder.path(),
                    {.floats_per_point = 3,
                     .points_per_scan = 5,
                     .stamp = StampSource::kName,
                     .rate_hz = 10.0});
      },
      ThrowsMessage<ReadError>(AllOf(HasSubstr("10.5.bin: its stamp"), HasSubstr("10.0.bin#5"))));
}

TEST(CloudSource, GoesOnAfterAFileThatCannotBeRead) {
  const TemporaryFolder folder;
  folder.Write("1.bin", Points(1, 1.0F));
  folder.Write("2.bin", "broken");
  folder.Write("3.pcd", "");
  core::PointCloud cloud;
  cloud.Add({4.0F, 0.0F, 0.0F}, 200);
  WritePcdBinary(folder.path() / "4.pcd", cloud);

  CloudSource source(folder.path(), {.floats_per_point = 3, .intensity_scale = 0.5});

  ASSERT_EQ(source.size(), 4U);
  EXPECT_THROW((void)source.Read(1), ReadError);
  EXPECT_THROW((void)source.Read(2), ReadError);
  EXPECT_THAT(source.Read(3).cloud.x, ElementsAre(4.0F));
  EXPECT_THAT(source.Read(3).cloud.intensity, ElementsAre(100));
  EXPECT_THAT(source.Read(0).cloud.x, ElementsAre(1.0F));
}

TEST(CloudSource, SaysSoWhenNothingIsThere) {
  const TemporaryFolder folder;

  EXPECT_THROW(CloudSource(folder.path(), {}), ReadError);
}

/// Takes down what a configuration offers.
struct FieldNames {
  std::vector<std::string> names;
  void Integer(const char* name, const int& value, int low, int high, const char* help) {
    Note(name, value >= low && value <= high, help);
  }
  void Number(const char* name, const double& value, double low, double high, const char* help) {
    Note(name, value >= low && value <= high, help);
  }
  template <typename Enum, typename Names>
  void Choice(const char* name, const Enum& value, const Names& choices, const char* help) {
    bool is_known = false;
    for (const auto& choice : choices) is_known = is_known || choice.second == value;
    Note(name, is_known, help);
  }
  void Note(const char* name, bool is_allowed, const std::string& help) {
    EXPECT_TRUE(is_allowed) << name;
    EXPECT_FALSE(help.empty()) << name;
    names.emplace_back(name);
  }
};

TEST(RecordingConfig, OffersItsFieldsWithDefaultsInBounds) {
  FieldNames visitor;
  const RecordingConfig config;

  RecordingConfig::Visit(config, visitor);

  EXPECT_THAT(
      visitor.names,
      ElementsAre("floats_per_point", "intensity_scale", "points_per_scan", "stamp", "rate_hz"));
}

}  // namespace
}  // namespace clearway::io
