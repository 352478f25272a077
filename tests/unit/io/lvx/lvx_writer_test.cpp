// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/lvx/lvx_writer.hpp"

#include <random>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/file_bytes.hpp"
#include "common/io/lvx/lvx_reader.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/io/lvx/lvx_maker.hpp"
#include "tests/unit/io/temporary_folder.hpp"

namespace clearway::io {
namespace {

using test::BytesOf;
using test::LvxMaker;
using test::MakePackage;
using test::ReadAll;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

core::livox::Bytes Packet(std::uint64_t seed, std::uint8_t type = 2) {
  const std::string package = MakePackage(0, type, seed);
  core::livox::Bytes bytes;
  for (std::size_t i = 1; i < package.size(); ++i) bytes.push_back(std::byte(package[i]));
  return bytes;
}

LvxHeader HeaderOf(const std::vector<std::uint8_t>& indices) {
  LvxHeader header;
  for (const std::uint8_t index : indices) {
    header.devices.push_back(
        {.lidar_code = "3GGDJ6K0010" + std::to_string(index) + "01", .index = index});
  }
  return header;
}

// The file's content as frames, so that it can be written again.
void Rewrite(const std::filesystem::path& from, const std::filesystem::path& to) {
  LvxReader reader(from);
  LvxWriter writer(to, reader.header());
  std::int64_t frame = 0;
  while (const auto package = reader.Next()) {
    for (; frame < package->frame; ++frame) writer.EndFrame();
    EXPECT_TRUE(writer.Add(package->device_index, package->packet));
  }
  for (; frame < reader.report().frames; ++frame) writer.EndFrame();
  writer.Close();
}

TEST(LvxWriter, WritesWhatTheFormatDescribes) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.lvx";
  LvxWriter writer(path, HeaderOf({1, 0}));

  EXPECT_TRUE(writer.Add(0, Packet(1)));
  EXPECT_TRUE(writer.Add(1, Packet(2, 4)));
  writer.EndFrame();
  EXPECT_TRUE(writer.Add(0, Packet(3, 3)));
  writer.Close();

  const LvxMaker expected{
      .devices = {1, 0},
      .frames = {{MakePackage(0, 2, 1), MakePackage(1, 4, 2)}, {MakePackage(0, 3, 3)}}};
  EXPECT_EQ(ReadFileBytes(path), expected.File());
  EXPECT_EQ(writer.frames(), 2);
  EXPECT_EQ(writer.packages(), 3);
}

TEST(LvxWriter, TheHeaderComesBackWithAllThatItHolds) {
  const TemporaryFolder folder;
  const LvxHeader header{.frame_duration_ms = 100,
                         .devices = {{.lidar_code = "0123456789abcdef",
                                      .hub_code = "13UUG1R00400170",
                                      .index = 200,
                                      .type = core::livox::DeviceType::kAvia,
                                      .extrinsic_enabled = true,
                                      .roll_deg = 1.5F,
                                      .pitch_deg = -2.25F,
                                      .yaw_deg = 180.0F,
                                      .x_m = 0.1F,
                                      .y_m = -0.2F,
                                      .z_m = 0.3F},
                                     {.lidar_code = "3GGDJ6K00100101", .index = 3}}};

  LvxWriter(folder.path() / "a.lvx", header).Close();

  EXPECT_EQ(LvxReader(folder.path() / "a.lvx").header(), header);
}

TEST(LvxWriter, RandomRecordingsComeBackBitForBit) {
  const TemporaryFolder folder;
  std::mt19937 random(11);
  for (int i = 0; i < 30; ++i) {
    LvxMaker maker{.devices = {0, 1, 2}};
    maker.frames.resize(random() % 6);
    for (auto& frame : maker.frames) {
      for (std::size_t k = random() % 20; k > 0; --k) {
        frame.push_back(MakePackage(static_cast<std::uint8_t>(random() % 3),
                                    static_cast<std::uint8_t>(random() % 6),
                                    random()));
      }
    }
    const auto from = folder.Write("from.lvx", maker.File());

    Rewrite(from, folder.path() / "to.lvx");

    EXPECT_EQ(ReadFileBytes(folder.path() / "to.lvx"), maker.File());
  }
}

TEST(LvxWriter, ARecordingThatIsNotClosedIsGoodUpToItsLastFrame) {
  const TemporaryFolder folder;
  LvxWriter writer(folder.path() / "a.lvx", HeaderOf({0}));
  ASSERT_TRUE(writer.Add(0, Packet(1)));
  writer.EndFrame();
  ASSERT_TRUE(writer.Add(0, Packet(2)));

  LvxReader reader(folder.path() / "a.lvx");

  EXPECT_THAT(BytesOf(ReadAll(reader)), ElementsAre(MakePackage(0, 2, 1)));
  EXPECT_FALSE(reader.report().cut_at);
}

TEST(LvxWriter, CutsFramesOnTheGridOfTheirDuration) {
  const TemporaryFolder folder;
  LvxWriter writer(folder.path() / "a.lvx", HeaderOf({0}));
  constexpr std::int64_t kStart = 1'700'000'000'123'456;
  const std::vector<std::pair<std::int64_t, std::int64_t>> utime_and_frame{{0, 0},
                                                                           {49'999, 0},
                                                                           {50'000, 1},
                                                                           {99'999, 1},
                                                                           {149'999, 2},
                                                                           {3'600'000'000, 3},
                                                                           {-10'000'000, 4},
                                                                           {-9'960'000, 4},
                                                                           {-9'950'000, 5}};

  for (const auto& [utime, frame] : utime_and_frame) {
    ASSERT_TRUE(writer.Add(0, Packet(7), kStart + utime));
    EXPECT_EQ(writer.frames(), frame) << utime;
  }
  writer.Close();

  LvxReader reader(folder.path() / "a.lvx");
  EXPECT_EQ(ReadAll(reader).size(), utime_and_frame.size());
  EXPECT_EQ(reader.report().frames, 6);
}

TEST(LvxWriter, RefusesAndCountsWhatTheFormatCannotHold) {
  const TemporaryFolder folder;
  LvxWriter writer(folder.path() / "a.lvx", HeaderOf({0}));
  core::livox::Bytes short_packet = Packet(1);
  short_packet.resize(18 + 95 * 14);

  EXPECT_FALSE(writer.Add(0, short_packet)) << "not full";
  EXPECT_FALSE(writer.Add(1, Packet(1))) << "not listed";
  EXPECT_FALSE(writer.Add(0, Packet(1, 6))) << "no type of a MID-70";
  EXPECT_FALSE(writer.Add(0, {})) << "nothing";
  EXPECT_EQ(writer.refused(), 4);
  EXPECT_EQ(writer.packages(), 0);
  writer.Close();

  LvxReader reader(folder.path() / "a.lvx");
  EXPECT_FALSE(reader.Next());
}

TEST(LvxWriter, RefusesHeadersThatNoReaderCouldUse) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.lvx";
  LvxHeader long_code = HeaderOf({0});
  long_code.devices[0].lidar_code = "0123456789abcdefg";
  LvxHeader no_time = HeaderOf({0});
  no_time.frame_duration_ms = 0;

  EXPECT_THROW(LvxWriter(path, LvxHeader{}), std::invalid_argument);
  EXPECT_THROW(LvxWriter(path, HeaderOf({1, 2, 1})), std::invalid_argument);
  EXPECT_THROW(LvxWriter(path, HeaderOf(std::vector<std::uint8_t>(256))), std::invalid_argument);
  EXPECT_THROW(LvxWriter(path, long_code), std::invalid_argument);
  EXPECT_THROW(LvxWriter(path, no_time), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(path)) << "and replace nothing";
}

TEST(LvxWriter, SaysWhereItCannotWrite) {
  EXPECT_THAT([] { LvxWriter("/nowhere/a.lvx", HeaderOf({0})); },
              ThrowsMessage<std::runtime_error>(HasSubstr("/nowhere/a.lvx: cannot be written")));
}

TEST(LvxWriter, SaysThatTheDiskIsFull) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";

  EXPECT_THAT([] { LvxWriter("/dev/full", HeaderOf({0})); },
              ThrowsMessage<std::runtime_error>(HasSubstr("No space left")));
}

TEST(LvxRecordings, WhatTheVendorsSdkWroteIsReadCompletelyAndWrittenAlike) {
  const std::string name = "livox/mid70_written_by_vendor_sdk.lvx";
  const auto path = test::TestData(name);
  if (!path) GTEST_SKIP() << test::MissingData(name);
  const TemporaryFolder folder;
  LvxReader reader(*path);

  std::uint64_t last = 0;
  while (const auto package = reader.Next()) {
    const auto parsed = core::livox::ParsePacket(package->packet);
    ASSERT_EQ(parsed.defect, core::livox::PacketDefect::kNone);
    const std::uint64_t timestamp = parsed.packet->header.timestamp;
    if (last != 0) {
      EXPECT_EQ(timestamp - last, 960'000U);
    }
    last = timestamp;
  }
  Rewrite(*path, folder.path() / "again.lvx");

  EXPECT_EQ(reader.report().frames, 100);
  EXPECT_EQ(reader.report().packages, 5225);
  EXPECT_EQ(reader.report().first_problem + reader.report().cut, "");
  EXPECT_TRUE(reader.header().devices[0].extrinsic_enabled);
  EXPECT_EQ(ReadFileBytes(folder.path() / "again.lvx"), ReadFileBytes(*path));
}

TEST(LvxRecordings, TheSmallFilesOfBothVersionsAreReadCompletely) {
  for (const std::string name : {"livox/mini_v10.lvx", "livox/mini_v11.lvx"}) {
    const auto path = test::TestData(name);
    if (!path) GTEST_SKIP() << test::MissingData(name);
    LvxReader reader(*path);

    const auto packages = ReadAll(reader);

    EXPECT_EQ(packages.size(), 2U);
    EXPECT_EQ(reader.report().frames, 2);
    EXPECT_EQ(reader.report().first_problem + reader.report().cut, "");
    EXPECT_EQ(reader.header().devices[0].lidar_code, "3GGDJ6K00100101");
  }
}

}  // namespace
}  // namespace clearway::io
