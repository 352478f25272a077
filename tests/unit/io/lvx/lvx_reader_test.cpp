// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/lvx/lvx_reader.hpp"

#include <array>
#include <bit>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/io/lvx/lvx_maker.hpp"
#include "tests/unit/io/temporary_folder.hpp"

namespace clearway::io {
namespace {

using test::BytesOf;
using test::LvxMaker;
using test::MakePackage;
using test::ReadAll;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

TEST(LvxReader, GivesEachPackageAsItWasOnTheWire) {
  for (const std::uint8_t type : std::vector<std::uint8_t>{0, 1, 2, 3, 4, 5}) {
    const LvxMaker maker{
        .frames = {{MakePackage(0, type, 1), MakePackage(0, type, 2)}, {MakePackage(0, type, 3)}}};
    LvxReader reader(maker.File(), "a.lvx");

    const auto packages = ReadAll(reader);

    EXPECT_THAT(BytesOf(packages),
                ElementsAre(maker.frames[0][0], maker.frames[0][1], maker.frames[1][0]));
    EXPECT_EQ(packages[0].byte, 88U + 24U);
    EXPECT_EQ(packages[2].frame, 1);
    EXPECT_EQ(reader.report().frames, 2);
    EXPECT_EQ(reader.report().packages, 3);
    EXPECT_EQ(reader.report().first_problem + reader.report().cut, "");
    EXPECT_EQ(reader.position(), reader.size());
  }
}

TEST(LvxReader, KnowsDevicesByTheirIndexNotByTheirPlace) {
  const LvxMaker maker{.devices = {1, 7, 0},
                       .frames = {{MakePackage(0, 2, 1), MakePackage(7, 4, 2)}}};
  LvxReader reader(maker.File(), "a.lvx");

  const auto packages = ReadAll(reader);

  ASSERT_EQ(reader.header().devices.size(), 3U);
  EXPECT_EQ(reader.header().devices[0].lidar_code, "3GGDJ6K0010101");
  EXPECT_EQ(reader.DeviceWithIndex(7), &reader.header().devices[1]);
  EXPECT_EQ(reader.DeviceWithIndex(2), nullptr);
  EXPECT_EQ(packages[1].device_index, 7);
  EXPECT_EQ(reader.report().unknown_devices, 0);
}

TEST(LvxReader, GivesThePackageOfAOneFrameFileThatTheVendorsReaderRefuses) {
  const LvxMaker maker{.frames = {{MakePackage(0, 2, 1)}}};
  ASSERT_LT(maker.File().size(), 1635U);
  LvxReader reader(maker.File(), "a.lvx");

  EXPECT_EQ(ReadAll(reader).size(), 1U);
}

TEST(LvxReader, AFileWithoutFramesIsEmptyAndWhole) {
  LvxReader reader(LvxMaker{}.File(), "a.lvx");

  EXPECT_THAT(ReadAll(reader), IsEmpty());
  EXPECT_EQ(reader.report().frames, 0);
  EXPECT_FALSE(reader.report().cut_at);
}

TEST(LvxReader, EmptyFramesAreFrames) {
  LvxReader reader(LvxMaker{.frames = {{}, {MakePackage(0, 2, 1)}, {}}}.File(), "a.lvx");

  EXPECT_EQ(ReadAll(reader).size(), 1U);
  EXPECT_EQ(reader.report().frames, 3);
  EXPECT_EQ(reader.report().damages, 0);
}

std::string FloatPackage(const std::vector<std::array<float, 3>>& points) {
  std::string package = MakePackage(0, 0, 1'234'567).substr(0, 19);
  for (std::size_t i = 0; i < 100; ++i) {
    const auto point = i < points.size() ? points[i] : std::array<float, 3>{};
    for (const float value : point) {
      test::AppendNumber(package, std::bit_cast<std::uint32_t>(value), 4);
    }
    package += static_cast<char>(i);
  }
  return package;
}

TEST(LvxReader, Version10HoldsMetresAndBecomesAPacketOfMillimetres) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const LvxMaker maker{.is_1_0 = true,
                       .frames = {{FloatPackage({{1.0F, -0.5F, 0.25F},
                                                 {1.0004F, 2.0006F, -3.0F},
                                                 {kNan, 1.0F, 1.0F},
                                                 {1e9F, 0.0F, 0.0F}})}}};
  LvxReader reader(maker.File(), "a.lvx");

  const auto package = reader.Next();

  ASSERT_TRUE(package);
  EXPECT_EQ(reader.header().version, LvxVersion::k1_0);
  ASSERT_EQ(package->float_points.size(), 100U);
  EXPECT_EQ(package->float_points[1].x_m, 1.0004F);
  EXPECT_EQ(package->float_points[99].reflectivity, 99);
  const auto parsed = core::livox::ParsePacket(package->packet);
  ASSERT_EQ(parsed.defect, core::livox::PacketDefect::kNone);
  EXPECT_EQ(parsed.packet->header.timestamp, 1'234'567U);
  std::vector<core::livox::Point> points(100);
  core::livox::DecodePoints(*parsed.packet, points);
  EXPECT_EQ(points[0], (core::livox::Point{1.0F, -0.5F, 0.25F, 0, 0}));
  EXPECT_EQ(points[1], (core::livox::Point{1.0F, 2.001F, -3.0F, 1, 0}));
  EXPECT_FALSE(points[2].is_return()) << "NaN is no return";
  EXPECT_FALSE(points[3].is_return()) << "nor is what the wire cannot say";
  EXPECT_FALSE(reader.Next());
  EXPECT_EQ(reader.report().damages, 0);
}

TEST(LvxReader, AFrameOfVersion10ThatStatesAnotherCountIsDamaged) {
  LvxMaker maker{.is_1_0 = true, .frames = {{FloatPackage({})}, {FloatPackage({})}}};
  std::string file = maker.File();
  file[83 + 24] = 9;
  LvxReader reader(file, "a.lvx");

  EXPECT_EQ(ReadAll(reader).size(), 2U);
  EXPECT_EQ(reader.report().damages, 1);
  EXPECT_THAT(reader.report().first_problem, HasSubstr("holds 1 packages and states 9"));
}

class LvxHeaderTest : public testing::Test {
 protected:
  static auto Refuses(const std::string& text) {
    return ThrowsMessage<ReadError>(AllOf(HasSubstr("a.lvx: byte "), HasSubstr(text)));
  }
  std::string file_ = LvxMaker{.devices = {0, 1}, .frames = {{MakePackage(0, 2, 1)}}}.File();
  [[nodiscard]] auto Opening() const {
    return [file = file_] { LvxReader(file, "a.lvx"); };
  }
};

TEST_F(LvxHeaderTest, AForeignSignatureIsRefused) {
  file_[0] = 'L';
  EXPECT_THAT(Opening(), Refuses("byte 0: begins with \"Livox_tech"));
}

TEST_F(LvxHeaderTest, LvxTwoIsRefusedByName) {
  file_[16] = 2;
  file_[17] = 0;
  EXPECT_THAT(Opening(), Refuses("byte 16: LVX version 2.0; 1.0 and 1.1 are read"));
}

TEST_F(LvxHeaderTest, AnUnknownMinorVersionIsRefused) {
  file_[17] = 2;
  EXPECT_THAT(Opening(), Refuses("LVX version 1.2"));
}

TEST_F(LvxHeaderTest, AForeignMagicNumberIsRefused) {
  file_[20] = 0;
  EXPECT_THAT(Opening(), Refuses("byte 20: magic number 0xac0ea700; expected 0xac0ea767"));
}

TEST_F(LvxHeaderTest, AListWithoutDevicesIsRefused) {
  file_[28] = 0;
  EXPECT_THAT(Opening(), Refuses("byte 28: lists no device"));
}

TEST_F(LvxHeaderTest, AnIndexTwiceIsRefused) {
  file_[29 + 59 + 32] = 0;
  EXPECT_THAT(Opening(), Refuses("byte 120: lists two devices with index 0"));
}

TEST_F(LvxHeaderTest, CutAnywhereIsRefusedWithTheByte) {
  const std::string whole = LvxMaker{.devices = {0, 1}}.Header();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    file_ = whole.substr(0, size);
    EXPECT_THAT(Opening(), Refuses("byte " + std::to_string(size) + ": the file ends inside"));
  }
}

TEST(LvxReader, WhatIsNoFileIsRefused) {
  const test::TemporaryFolder folder;

  EXPECT_THAT([&] { LvxReader(folder.path() / "none.lvx"); },
              ThrowsMessage<ReadError>(HasSubstr("none.lvx: no such file")));
  EXPECT_THAT([&] { LvxReader(folder.path()); },
              ThrowsMessage<ReadError>(HasSubstr("is not a file")));
}

}  // namespace
}  // namespace clearway::io
