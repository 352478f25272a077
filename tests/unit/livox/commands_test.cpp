// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/commands.hpp"

#include <gtest/gtest.h>

#include "tests/unit/livox/protocol_maker.hpp"

namespace clearway::core::livox {
namespace {

Bytes Resized(Bytes bytes, std::size_t size) {
  bytes.resize(size);
  return bytes;
}

TEST(LivoxCommands, BodiesComeBackFromTheirBytes) {
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    const auto byte = [&random] { return static_cast<std::uint8_t>(test::Random(random, 256)); };
    const auto port = [&random] { return static_cast<std::uint16_t>(random()); };
    const Handshake handshake{static_cast<Ipv4>(random()), port(), port(), port()};
    const HeartbeatAck heartbeat{byte(),
                                 static_cast<WorkState>(test::Random(random, 6)),
                                 byte(),
                                 static_cast<std::uint32_t>(random())};
    const DeviceInfoAck info{byte(), {byte(), byte(), byte(), byte()}};
    const Extrinsic extrinsic{static_cast<float>(byte()),
                              -0.25F * static_cast<float>(byte()),
                              static_cast<float>(byte()) / 3.0F,
                              static_cast<std::int32_t>(random()),
                              static_cast<std::int32_t>(random()),
                              static_cast<std::int32_t>(random())};

    const auto handshake_back = ParseHandshake(PackBody(handshake));
    const auto heartbeat_back = ParseHeartbeatAck(PackBody(heartbeat));
    const auto info_back = ParseDeviceInfoAck(PackBody(info));

    ASSERT_TRUE(handshake_back && heartbeat_back && info_back);
    EXPECT_EQ(PackBody(*handshake_back), PackBody(handshake));
    EXPECT_EQ(handshake_back->host_ip, handshake.host_ip);
    EXPECT_EQ(handshake_back->imu_port, handshake.imu_port);
    EXPECT_EQ(heartbeat_back->state, heartbeat.state);
    EXPECT_EQ(heartbeat_back->progress, heartbeat.progress);
    EXPECT_EQ(heartbeat_back->features, heartbeat.features);
    EXPECT_EQ(info_back->firmware, info.firmware);
    EXPECT_EQ(ParseExtrinsic(PackBody(extrinsic)), extrinsic);
    const auto ack = ParseExtrinsicAck(PackBody(ExtrinsicAck{7, extrinsic}));
    ASSERT_TRUE(ack);
    EXPECT_EQ(ack->result, 7);
    EXPECT_EQ(ack->extrinsic, extrinsic);
  }
}

TEST(LivoxCommands, BodiesOfAnyOtherLengthAreRefused) {
  const Bytes bytes(64, std::byte{1});
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    const Bytes body = Resized(bytes, size);

    EXPECT_EQ(ParseHandshake(body).has_value(), size == 8 || size == 10) << size;
    EXPECT_EQ(ParseHeartbeatAck(body).has_value(), size == 7) << size;
    EXPECT_EQ(ParseDeviceInfoAck(body).has_value(), size == 5) << size;
    EXPECT_EQ(ParseExtrinsic(body).has_value(), size == 24) << size;
    EXPECT_EQ(ParseExtrinsicAck(body).has_value(), size == 25) << size;
    EXPECT_EQ(ParseByte(body).has_value(), size == 1) << size;
    EXPECT_EQ(ParseBroadcast(Resized(test::FromText("3GGDJ6K00100101"), size)).has_value(),
              size == 19)
        << size;
  }
}

TEST(LivoxCommands, ABroadcastCodeIsPrintableAndEndsInTime) {
  const auto parse = [](const std::string& code) {
    return ParseBroadcast(Resized(Resized(test::FromText(code), 16), 19));
  };

  EXPECT_TRUE(parse("3GGDJ6K00100101"));
  EXPECT_TRUE(parse("x"));
  EXPECT_FALSE(parse(""));
  EXPECT_FALSE(parse("3GGDJ6K001001010")) << "16 characters leave no room for the end";
  EXPECT_FALSE(parse("3GGDJ6K 0100101"));
  EXPECT_FALSE(parse("3GGDJ6K\n0100101"));
  EXPECT_FALSE(
      parse("3GGDJ6K\xE4"
            "0100101"));
}

TEST(LivoxCommands, ABroadcastOfAnUnknownKindOfDeviceIsOneAllTheSame) {
  Bytes body = Resized(Resized(test::FromText("3GGDJ6K00100101"), 16), 19);
  body[16] = std::byte{99};

  const auto broadcast = ParseBroadcast(body);

  ASSERT_TRUE(broadcast);
  EXPECT_STREQ(DeviceName(broadcast->type), "unknown device");
}

TEST(LivoxCommands, AnUnknownStateOfWorkIsUnknown) {
  Bytes body(7);
  body[1] = std::byte{200};

  EXPECT_EQ(ParseHeartbeatAck(body)->state, WorkState::kUnknown);
}

TEST(LivoxCommands, SetAndIdMakeTheCode) {
  EXPECT_EQ(SetOf(CommandCode::kSetUtcTime), 1);
  EXPECT_EQ(IdOf(CommandCode::kSetUtcTime), 10);
  EXPECT_EQ(CodeOf({.command_set = 1, .command_id = 6}), CommandCode::kSetReturnMode);
  EXPECT_STREQ(CommandName(static_cast<CommandCode>(0x0203)), "unknown command");
  EXPECT_EQ(FirmwareText({10, 3, 0, 1}), "10.3.0.1");
}

}  // namespace
}  // namespace clearway::core::livox
