// SPDX-License-Identifier: BSD-3-Clause
// Whatever the way through the formats: the same points, to the millimetre, in the same scans.
#include "tools/convert/convert.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <random>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/cloud_source.hpp"
#include "common/io/file_bytes.hpp"
#include "common/io/lvx/lvx_reader.hpp"
#include "common/io/lvx/lvx_writer.hpp"
#include "common/io/pcd_reader.hpp"
#include "common/io/pcd_writer.hpp"
#include "tests/support/test_data.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::convert {
namespace {

using core::livox::DataType;
using core::livox::TimestampType;
using core::livox::WirePoint;
using test::TestFolder;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

using Path = std::filesystem::path;
// x, y, z [mm], intensity.
using Millimetres = std::array<std::int64_t, 4>;
// By the start of the scan [us]; sorted.
using Scans = std::map<std::int64_t, std::vector<Millimetres>>;

Report ConvertFile(const Path& input, const Path& output, SourceSettings source = {}) {
  source.input = input;
  return Convert({.source = source, .output = output}, [](double) {});
}

Scans ScansOf(const Path& folder) {
  io::RecordingConfig config;
  config.stamp = io::StampSource::kName;
  io::CloudSource source(folder, config);
  Scans scans;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const core::PointCloud cloud = source.Read(i).cloud;
    std::vector<Millimetres>& points = scans[source.utime(i)];
    for (std::size_t k = 0; k < cloud.size(); ++k) {
      points.push_back({std::lround(1000.0 * cloud.x[k]),
                        std::lround(1000.0 * cloud.y[k]),
                        std::lround(1000.0 * cloud.z[k]),
                        cloud.intensity[k]});
    }
    std::sort(points.begin(), points.end());
  }
  return scans;
}

std::size_t PointsIn(const Scans& scans) {
  std::size_t points = 0;
  for (const auto& [utime, scan] : scans) points += scan.size();
  return points;
}

struct Recording {
  DataType type = DataType::kExtendedCartesian;
  TimestampType timestamp_type = TimestampType::kNoSync;
  std::uint64_t first_ns = 5'000'000'000;
  int packets = 500;
  int lost_from = 0;  // Packets lost_from .. lost_to - 1 are not in the file.
  int lost_to = 0;
  unsigned zeros_in_100 = 20;
  std::vector<std::uint8_t> devices = {0};
};

// An LVX file with random points; the points that return, each with its time since the first shot.
Path Write(const TestFolder& folder, const Recording& recording) {
  const Path path = folder.path() / "in.lvx";
  io::LvxHeader header;
  for (const std::uint8_t index : recording.devices) {
    header.devices.push_back(
        {.lidar_code = "3GGDJ6K0010" + std::to_string(index) + "01", .index = index});
  }
  io::LvxWriter writer(path, header);
  std::mt19937 random(1);
  const core::livox::DataLayout layout = core::livox::LayoutOf(recording.type);
  const auto interval_ns = static_cast<std::int64_t>(layout.shots_in_packet) * 10'000;
  for (int k = 0; k < recording.packets; ++k) {
    const std::int64_t ns = k * interval_ns;
    for (const std::uint8_t device : recording.devices) {
      std::vector<WirePoint> points(layout.shots_in_packet * layout.echoes);
      for (WirePoint& point : points) {
        if (random() % 100 < recording.zeros_in_100) continue;
        const auto mm = [&random] {
          return static_cast<std::int32_t>(random() % 200'000) - 100'000;
        };
        point = {.x_mm = mm(),
                 .y_mm = mm(),
                 .z_mm = mm(),
                 .reflectivity = static_cast<std::uint8_t>(random() % 256),
                 .tag = static_cast<std::uint8_t>(random() % 256)};
      }
      if (k >= recording.lost_from && k < recording.lost_to) continue;
      std::uint64_t stamp = recording.first_ns + static_cast<std::uint64_t>(ns);
      if (recording.timestamp_type == TimestampType::kPps) stamp %= 1'000'000'000;
      if (recording.timestamp_type == TimestampType::kGps) {
        stamp = core::livox::ToGpsTimestamp(static_cast<std::int64_t>(stamp));
      }
      EXPECT_TRUE(writer.Add(device,
                             core::livox::PackPacket({.timestamp_type = recording.timestamp_type,
                                                      .data_type = recording.type,
                                                      .timestamp = stamp},
                                                     points),
                             ns / 1000));
    }
  }
  writer.Close();
  return path;
}

class RoundTripTest : public testing::TestWithParam<DataType> {};

TEST_P(RoundTripTest, AllWaysFromAnLvxFileGiveTheSameScans) {
  const TestFolder folder;
  const Path& at = folder.path();
  const Path lvx = Write(folder, {.type = GetParam()});

  const Report direct = ConvertFile(lvx, at / "direct");
  const Report to_log = ConvertFile(lvx, at / "a.lcm");
  ConvertFile(at / "a.lcm", at / "from_log");
  const Report to_lvx = ConvertFile(at / "a.lcm", at / "again.lvx");
  const Report back = ConvertFile(at / "again.lvx", at / "from_lvx");

  const Scans scans = ScansOf(at / "direct");
  EXPECT_GT(scans.size(), 2U);
  EXPECT_EQ(static_cast<std::int64_t>(PointsIn(scans)), direct.written.points);
  EXPECT_EQ(direct.read.packets, 500);
  EXPECT_EQ(direct.read.lost_packets, 0);
  EXPECT_GT(direct.read.zero_returns, 0);
  EXPECT_EQ(to_log.written.points, direct.written.points);
  EXPECT_EQ(to_lvx.written.points, direct.written.points);
  EXPECT_EQ(back.read.lost_packets, 0);
  EXPECT_TRUE(ScansOf(at / "from_log") == scans);
  EXPECT_TRUE(ScansOf(at / "from_lvx") == scans);
  EXPECT_THAT(back.read.problems, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(SingleAndDual,
                         RoundTripTest,
                         testing::Values(DataType::kExtendedCartesian, DataType::kDualCartesian));

TEST(Convert, AllWaysFromAFolderGiveTheSameScans) {
  const TestFolder folder;
  const Path& at = folder.path();
  std::filesystem::create_directories(at / "in");
  std::mt19937 random(2);
  for (int scan = 0; scan < 5; ++scan) {
    core::PointCloud cloud;
    for (int i = 0; i < 9000 + scan; ++i) {
      const auto metres = [&random] {
        return static_cast<float>(random() % 200'000) / 1000.0F - 99.9F;
      };
      cloud.Add({metres(), metres(), metres()}, static_cast<std::uint8_t>(random() % 256));
    }
    io::WritePcdBinary(at / "in" / ("1744500470." + std::to_string(3 + scan) + "00000.pcd"), cloud);
  }
  const Scans scans = ScansOf(at / "in");

  ConvertFile(at / "in", at / "a.lcm");
  ConvertFile(at / "a.lcm", at / "from_log");
  const Report to_lvx = ConvertFile(at / "in", at / "a.lvx");
  ConvertFile(at / "a.lvx", at / "from_lvx");

  EXPECT_EQ(scans.size(), 5U);
  EXPECT_TRUE(ScansOf(at / "from_log") == scans);
  EXPECT_EQ(to_lvx.written.points, static_cast<std::int64_t>(PointsIn(scans)));
  Scans from_lvx = ScansOf(at / "from_lvx");
  // The last packet may reach into a scan of its own, without points.
  if (from_lvx.rbegin()->second.empty()) from_lvx.erase(std::prev(from_lvx.end()));
  EXPECT_TRUE(from_lvx == scans);
}

// More points than a MID-70 has shots in 100 ms.
TEST(Convert, ADenseScanKeepsItsPointsInLvx) {
  const TestFolder folder;
  const Path& at = folder.path();
  std::filesystem::create_directories(at / "in");
  for (int scan = 0; scan < 3; ++scan) {
    core::PointCloud cloud;
    for (int i = 0; i < 19'500; ++i) cloud.Add({0.001F * static_cast<float>(i + 1), 1.0F, 2.0F});
    io::WritePcdBinary(at / "in" / ("100." + std::to_string(scan) + ".pcd"), cloud);
  }

  ConvertFile(at / "in", at / "a.lvx");
  const Report back = ConvertFile(at / "a.lvx", at / "back");

  EXPECT_EQ(back.read.lost_packets, 0);
  EXPECT_EQ(back.read.left_out, 0);
  EXPECT_THAT(back.read.problems, IsEmpty());
  EXPECT_EQ(back.written.points, 3 * 19'500);
  EXPECT_TRUE(ScansOf(at / "back") == ScansOf(at / "in"));
}

TEST(Convert, AScanThatNoMid70CouldSendIsRefusedForLvx) {
  const TestFolder folder;
  core::PointCloud cloud;
  for (int i = 0; i < 28'500; ++i) cloud.Add({1.0F, 1.0F, 2.0F});
  std::filesystem::create_directories(folder.path() / "in");
  io::WritePcdBinary(folder.path() / "in" / "1.pcd", cloud);

  EXPECT_THAT([&] { ConvertFile(folder.path() / "in", folder.path() / "a.lvx"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("has 28500 points")));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.lvx"));
}

TEST(Convert, PtpAndGpsStampsAreMomentsAndStay) {
  for (const TimestampType type : {TimestampType::kPtp, TimestampType::kGps}) {
    const TestFolder folder;
    constexpr std::uint64_t kFirst_ns = 1'744'500'470'250'000'000;

    ConvertFile(Write(folder, {.timestamp_type = type, .first_ns = kFirst_ns}),
                folder.path() / "out");

    EXPECT_EQ(ScansOf(folder.path() / "out").begin()->first, 1'744'500'470'200'000);
  }
}

TEST(Convert, StampsSincePowerOnCountFromTheGivenStart) {
  const TestFolder folder;
  const Path lvx = Write(folder, {});
  const Path named = folder.path() / "1744500470.300000.lvx";
  std::filesystem::copy_file(lvx, named);

  ConvertFile(lvx, folder.path() / "default");
  ConvertFile(lvx, folder.path() / "given", {.start_utime = 1'700'000'000'500'000});
  ConvertFile(named, folder.path() / "named");

  EXPECT_EQ(ScansOf(folder.path() / "default").begin()->first, io::kFirstScanUtime);
  EXPECT_EQ(ScansOf(folder.path() / "given").begin()->first, 1'700'000'000'500'000);
  EXPECT_EQ(ScansOf(folder.path() / "named").begin()->first, 1'744'500'470'300'000);
  EXPECT_EQ(PointsIn(ScansOf(folder.path() / "given")),
            PointsIn(ScansOf(folder.path() / "default")));
}

TEST(Convert, StampsThatBeginAnewEachSecondGoOn) {
  const TestFolder folder;
  const Recording recording{.timestamp_type = TimestampType::kPps, .packets = 3000};

  const Report report = ConvertFile(Write(folder, recording), folder.path() / "out");

  EXPECT_EQ(report.read.lost_packets, 0);
  EXPECT_EQ(report.read.left_out, 0);
  EXPECT_EQ(ScansOf(folder.path() / "out").size(), 29U);  // 2.88 s.
}

TEST(Convert, LostPacketsAreCountedAndNeverFilled) {
  const TestFolder folder;
  const Recording recording{.lost_from = 200, .lost_to = 210};

  const Report report = ConvertFile(Write(folder, recording), folder.path() / "a.lcm");
  const Report again = ConvertFile(folder.path() / "a.lcm", folder.path() / "b.lvx");
  const Report back = ConvertFile(folder.path() / "b.lvx", folder.path() / "back");

  EXPECT_EQ(report.read.packets, 490);
  EXPECT_EQ(report.read.lost_packets, 10);
  EXPECT_EQ(again.read.lost_packets, 10);
  EXPECT_EQ(back.written.points, report.written.points);
  EXPECT_GE(back.read.lost_packets, 9) << "the hole is still one, at most a packet narrower";
  EXPECT_LE(back.read.lost_packets, 10);
}

TEST(Convert, SeveralSensorsStayApart) {
  const TestFolder folder;
  const Path& at = folder.path();
  const Path lvx = Write(folder, {.packets = 300, .devices = {1, 0}});

  ConvertFile(lvx, at / "a.lcm", {.sensors = {"left", "right"}});
  ConvertFile(at / "a.lcm", at / "from_log");
  ConvertFile(lvx, at / "direct", {.sensors = {"left", "right"}});
  const Report codes = ConvertFile(lvx, at / "codes");
  ConvertFile(at / "a.lcm", at / "b.lvx");
  ConvertFile(at / "b.lvx", at / "from_lvx");

  for (const std::string sensor : {"left", "right"}) {
    const Scans scans = ScansOf(at / "direct" / sensor);
    EXPECT_TRUE(ScansOf(at / "from_log" / sensor) == scans);
    EXPECT_TRUE(ScansOf(at / "from_lvx" / sensor) == scans);
    EXPECT_GT(PointsIn(scans), 20'000U);
  }
  EXPECT_FALSE(ScansOf(at / "direct" / "left") == ScansOf(at / "direct" / "right"));
  EXPECT_TRUE(std::filesystem::is_directory(at / "codes" / "3GGDJ6K0010101"));
  EXPECT_EQ(codes.written.scans, 6);
}

TEST(Convert, ThePeriodCutsScans) {
  const TestFolder folder;
  const Path lvx = Write(folder, {});

  ConvertFile(lvx, folder.path() / "out", {.scan_period_us = 50'000});

  const Scans scans = ScansOf(folder.path() / "out");
  EXPECT_EQ(scans.size(), 10U);  // 480 ms.
  EXPECT_EQ(std::next(scans.begin())->first - scans.begin()->first, 50'000);
}

TEST(Convert, AFileThatWasCutIsConvertedAsFarAsItGoes) {
  const TestFolder folder;
  const Path lvx = Write(folder, {});
  std::filesystem::resize_file(lvx, std::filesystem::file_size(lvx) - 100);

  const Report report = ConvertFile(lvx, folder.path() / "a.lcm");

  EXPECT_EQ(report.read.packets, 499);
  EXPECT_THAT(report.read.problems, IsEmpty());
  ASSERT_EQ(report.read.remarks.size(), 1U);
  EXPECT_THAT(report.read.remarks[0], HasSubstr("is cut short"));
}

TEST(Convert, DamageIsAProblemThatIsNamed) {
  const TestFolder folder;
  const Path lvx = Write(folder, {});
  std::fstream(lvx, std::ios::binary | std::ios::in | std::ios::out).seekp(88 + 24 + 1).put('\0');

  const Report report = ConvertFile(lvx, folder.path() / "a.lcm");

  ASSERT_GE(report.read.problems.size(), 1U);
  EXPECT_THAT(report.read.problems[0], HasSubstr("in.lvx: byte 112: no package"));
}

TEST(Convert, RefusesWhatMakesNoSense) {
  const TestFolder folder;
  const Path lvx = Write(folder, {});
  const Path& at = folder.path();
  ConvertFile(lvx, at / "out");
  std::filesystem::create_hard_link(lvx, at / "same.lcm");

  EXPECT_THAT([&] { ConvertFile(lvx, at / "b.lvx"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("nothing to convert")));
  EXPECT_THAT([&] { ConvertFile(at / "none.lvx", at / "b.lcm"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("none.lvx: no such file")));
  EXPECT_THAT([&] { ConvertFile(lvx, at / "out"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("holds scans already")));
  EXPECT_THAT([&] { ConvertFile(lvx, at / "same.lcm"); }, testing::Throws<std::runtime_error>());
  EXPECT_GT(std::filesystem::file_size(lvx), 100'000U);
  folder.Write("text.lcm", "this is no log");
  EXPECT_THAT([&] { ConvertFile(at / "text.lcm", at / "b.lvx"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("holds no usable LIDAR_POINTS")));
}

TEST(Convert, TheVendorsRecordingIsConvertedWithoutLoss) {
  const std::string name = "livox/mid70_written_by_vendor_sdk.lvx";
  const auto path = test::TestData(name);
  if (!path) GTEST_SKIP() << test::MissingData(name);
  const TestFolder folder;

  const Report report = ConvertFile(*path, folder.path() / "a.lcm");
  const Report back = ConvertFile(folder.path() / "a.lcm", folder.path() / "b.lvx");

  EXPECT_EQ(report.read.packets, 5225);
  EXPECT_EQ(report.written.points, 5225 * 96);
  EXPECT_EQ(report.read.lost_packets, 0);
  EXPECT_EQ(back.written.packets, 5225);
  EXPECT_THAT(Describe(report),
              HasSubstr("51 scans, 501600 points, 5225 packets read, 0 packets lost"));
}

}  // namespace
}  // namespace clearway::convert
