// SPDX-License-Identifier: BSD-3-Clause
// Frames that other programs packed: the vendor's SDK, OpenPyLivox and a real Mid-40.
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/core/livox/commands.hpp"
#include "common/core/livox/device_status.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/livox/protocol_maker.hpp"

namespace clearway::core::livox {
namespace {

using test::FromHex;

constexpr Ipv4 kHost = 0xC0A80132;

// What both must be: what we pack, and what the vendor's code packed.
struct Vector {
  const char* name;
  FrameType type;
  std::uint16_t sequence;
  CommandCode code;
  Bytes data;
  const char* hex;
};

std::vector<Vector> Vectors() {
  const Bytes handshake = PackBody(
      Handshake{.host_ip = kHost, .data_port = 56001, .command_port = 55501, .imu_port = 56001});
  const DeviceStatus dirty{.window = Severity::kWarning, .system = Severity::kWarning};
  const Extrinsic extrinsic{.roll_deg = 1.5F,
                            .pitch_deg = -2.25F,
                            .yaw_deg = 90.0F,
                            .x_mm = 100,
                            .y_mm = -200,
                            .z_mm = 300};
  return {
      {"broadcast",
       FrameType::kMessage,
       0,
       CommandCode::kBroadcast,
       PackBody(Broadcast{.broadcast_code = "3GGDJ6K00100101", .type = DeviceType::kMid70}),
       "aa 01 22 00 02 00 00 59 7e 00 00 33 47 47 44 4a 36 4b 30 30 31 30 30 31 30 31 00 06 00 00 "
       "db d1 f2 3a"},
      {"handshake",
       FrameType::kCommand,
       2,
       CommandCode::kHandshake,
       handshake,
       "aa 01 19 00 00 02 00 6c 6b 00 01 c0 a8 01 32 c1 da cd d8 c1 da 6e e9 3b e7"},
      {"handshake as the SDK sends it",
       FrameType::kAck,
       2,
       CommandCode::kHandshake,
       handshake,
       "aa 01 19 00 01 02 00 b0 31 00 01 c0 a8 01 32 c1 da cd d8 c1 da 28 c6 c5 dd"},
      {"handshake acknowledged",
       FrameType::kAck,
       2,
       CommandCode::kHandshake,
       PackByte(0),
       "aa 01 10 00 01 02 00 d4 60 00 01 00 83 7a fa 4c"},
      {"heartbeat",
       FrameType::kCommand,
       3,
       CommandCode::kHeartbeat,
       {},
       "aa 01 0f 00 00 03 00 6c fd 00 03 4c d4 51 41"},
      {"heartbeat acknowledged, normal",
       FrameType::kAck,
       3,
       CommandCode::kHeartbeat,
       PackBody(HeartbeatAck{.state = WorkState::kNormal}),
       "aa 01 16 00 01 03 00 94 42 00 03 00 01 00 00 00 00 00 67 13 41 90"},
      {"heartbeat acknowledged, starting",
       FrameType::kAck,
       4,
       CommandCode::kHeartbeat,
       PackBody(HeartbeatAck{.state = WorkState::kInit, .progress = 42}),
       "aa 01 16 00 01 04 00 9c 0f 00 03 00 00 00 2a 00 00 00 95 e4 66 38"},
      {"heartbeat acknowledged, dirty",
       FrameType::kAck,
       5,
       CommandCode::kHeartbeat,
       PackBody(HeartbeatAck{.state = WorkState::kNormal, .progress = EncodeStatus(dirty)}),
       "aa 01 16 00 01 05 00 44 16 00 03 00 01 00 40 00 00 40 9e 1b cc 62"},
      {"device information",
       FrameType::kCommand,
       6,
       CommandCode::kDeviceInfo,
       {},
       "aa 01 0f 00 00 06 00 d4 83 00 02 46 56 32 e0"},
      {"device information acknowledged",
       FrameType::kAck,
       6,
       CommandCode::kDeviceInfo,
       PackBody(DeviceInfoAck{.firmware = {10, 3, 0, 1}}),
       "aa 01 14 00 01 06 00 a4 2a 00 02 00 0a 03 00 01 af d2 14 6b"},
      {"start sampling",
       FrameType::kCommand,
       7,
       CommandCode::kSampling,
       PackByte(1),
       "aa 01 10 00 00 07 00 b0 44 00 04 01 8d 78 fa 9b"},
      {"start sampling acknowledged",
       FrameType::kAck,
       7,
       CommandCode::kSampling,
       PackByte(0),
       "aa 01 10 00 01 07 00 6c 1e 00 04 00 1b 35 e2 c8"},
      {"stop sampling",
       FrameType::kCommand,
       8,
       CommandCode::kSampling,
       PackByte(0),
       "aa 01 10 00 00 08 00 78 c7 00 04 00 3d 82 3c 3c"},
      {"Cartesian coordinates",
       FrameType::kCommand,
       9,
       CommandCode::kCoordinates,
       PackByte(0),
       "aa 01 10 00 00 09 00 a0 de 00 05 00 45 94 c4 17"},
      {"dual return",
       FrameType::kCommand,
       10,
       CommandCode::kSetReturnMode,
       PackByte(static_cast<std::uint8_t>(ReturnMode::kDual)),
       "aa 01 10 00 00 0a 00 c8 f4 01 06 02 d6 a5 00 84"},
      {"get extrinsic",
       FrameType::kCommand,
       11,
       CommandCode::kGetExtrinsic,
       {},
       "aa 01 0f 00 00 0b 00 ac 33 01 02 ba 02 62 2e"},
      {"get extrinsic acknowledged",
       FrameType::kAck,
       11,
       CommandCode::kGetExtrinsic,
       PackBody(ExtrinsicAck{.result = 0, .extrinsic = extrinsic}),
       "aa 01 28 00 01 0b 00 3d 39 01 02 00 00 00 c0 3f 00 00 10 c0 00 00 b4 42 64 00 00 00 38 ff "
       "ff ff 2c 01 00 00 9f d6 a9 39"},
      {"abnormal status",
       FrameType::kMessage,
       12,
       CommandCode::kAbnormalStatus,
       FromHex("40 00 00 40"),
       "aa 01 13 00 02 0c 00 6c 08 00 07 40 00 00 40 18 ef a9 71"},
      {"disconnect",
       FrameType::kCommand,
       13,
       CommandCode::kDisconnect,
       {},
       "aa 01 0f 00 00 0d 00 7c 67 00 06 0a 2b ac ab"},
      {"OpenPyLivox: heartbeat",
       FrameType::kCommand,
       0,
       CommandCode::kHeartbeat,
       {},
       "AA010F0000000004D7000338BA8D0C"},
      {"OpenPyLivox: start",
       FrameType::kCommand,
       0,
       CommandCode::kSampling,
       PackByte(1),
       "AA011000000000B809000401228D5307"},
      {"OpenPyLivox: dual return",
       FrameType::kCommand,
       0,
       CommandCode::kSetReturnMode,
       PackByte(2),
       "AA011000000000B8090106022DD4AEAD"},
      {"Mid-40: handshake",
       FrameType::kCommand,
       0,
       CommandCode::kHandshake,
       FromHex("C0A82101 BD07 E8FD"),
       "AA0117000000006439 0001 C0A82101 BD07 E8FD 1E25F912"},
      {"Mid-40: handshake acknowledged",
       FrameType::kAck,
       0,
       CommandCode::kHandshake,
       PackByte(0),
       "AA01100001000064530001 00 F1343C29"},
  };
}

TEST(FramesOfOthers, AreWhatWePack) {
  for (const Vector& vector : Vectors()) {
    EXPECT_EQ(PackCommand(vector.type, vector.sequence, vector.code, vector.data),
              FromHex(vector.hex))
        << vector.name;
  }
}

TEST(FramesOfOthers, ParseAsWhatTheyAre) {
  for (const Vector& vector : Vectors()) {
    SCOPED_TRACE(vector.name);
    const Bytes bytes = FromHex(vector.hex);

    const ParsedFrame parsed = ParseFrame(bytes);

    ASSERT_EQ(parsed.defect, FrameDefect::kNone);
    EXPECT_EQ(parsed.frame->type, vector.type);
    EXPECT_EQ(parsed.frame->sequence, vector.sequence);
    EXPECT_EQ(CodeOf(*parsed.frame), vector.code);
    EXPECT_EQ(Bytes(parsed.frame->data.begin(), parsed.frame->data.end()), vector.data);
  }
}

TEST(FramesOfOthers, TheMid40sOldHandshakeHasNoImuPort) {
  const Bytes bytes = FromHex("AA0117000000006439 0001 C0A82101 BD07 E8FD 1E25F912");

  const auto handshake = ParseHandshake(ParseFrame(bytes).frame->data);

  ASSERT_TRUE(handshake);
  EXPECT_EQ(ToString(handshake->host_ip), "192.168.33.1");
  EXPECT_EQ(handshake->data_port, 1981);
  EXPECT_EQ(handshake->command_port, 65000);
  EXPECT_EQ(handshake->imu_port, 0);
}

// The file holds a name, lines of hex, and what the vendor's code made of them, frame by frame.
TEST(FramesOfOthers, AllNineteenOfTheVendorsCodeArePackedAlike) {
  const auto path = test::TestData("livox/control_frames.txt");
  if (!path) GTEST_SKIP() << test::MissingData("livox/control_frames.txt");
  std::ifstream stream(*path);
  std::string line;
  std::string hex;
  int frames = 0;
  while (std::getline(stream, line)) {
    if (line.rfind("  parse=OK", 0) != 0) {
      hex = line.rfind("  ", 0) == 0 ? hex + line : std::string();
      continue;
    }
    SCOPED_TRACE(line);
    const Bytes bytes = FromHex(hex);
    const ParsedFrame parsed = ParseFrame(bytes);
    ASSERT_EQ(parsed.defect, FrameDefect::kNone);
    EXPECT_EQ(PackFrame(*parsed.frame), bytes);
    const std::string expected = "  parse=OK set=" + std::to_string(parsed.frame->command_set) +
                                 " id=" + std::to_string(parsed.frame->command_id) +
                                 " seq=" + std::to_string(parsed.frame->sequence) +
                                 " datalen=" + std::to_string(parsed.frame->data.size()) + " ";
    EXPECT_EQ(line.rfind(expected, 0), 0U) << expected;
    ++frames;
    hex.clear();
  }
  EXPECT_EQ(frames, 19);
}

}  // namespace
}  // namespace clearway::core::livox
