// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/emulated_mid70.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>

#include "common/core/simulation/noise.hpp"

namespace clearway::core {
namespace {

using livox::Bytes;
using livox::CommandCode;
using livox::FrameType;
using livox::WorkState;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr Ipv4 kSensorIp = 0xC0A80165;  // 192.168.1.101
constexpr Endpoint kHost{0xC0A80132, 55501};
constexpr Endpoint kOther{0xC0A80133, 55501};
constexpr std::int64_t kSecond_us = 1'000'000;

Bytes FromHex(std::string_view text) {
  const auto digit = [](char c) {
    return static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10);
  };
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < text.size();) {
    if (text[i] == ' ') {
      ++i;
      continue;
    }
    bytes.push_back(static_cast<std::byte>(digit(text[i]) << 4U | digit(text[i + 1])));
    i += 2;
  }
  return bytes;
}

// As the vendor's SDK packs them for host 192.168.1.50.
const Bytes kHandshakeOfSdk = FromHex("aa0119000102 00b031 0001c0a80132c1dacdd8c1da 28c6c5dd");
const Bytes kHandshakeOfWiki = FromHex("aa0119000002006c6b0001c0a80132c1dacdd8c1da6ee93be7");
const Bytes kHandshakeAck = FromHex("aa011000010200d460000100837afa4c");
const Bytes kHeartbeat = FromHex("aa010f000003006cfd00034cd45141");

// A sensor at its command port, and the time.
class EmulatedMid70Test : public testing::Test {
 protected:
  explicit EmulatedMid70Test(const EmulatedMid70Config& config = {})
      : device_(config, {.ip = kSensorIp}, 0) {}

  std::vector<EmulatedMid70::Outgoing> Tell(const Bytes& bytes, const Endpoint& from = kHost) {
    return device_.Receive(from, bytes, now_us_);
  }
  // The body of the answer to a command; nothing when there was none.
  std::optional<Bytes> Ask(CommandCode code, const Bytes& body = {}, const Endpoint& from = kHost) {
    ++sequence_;
    const auto answers = Tell(livox::PackCommand(FrameType::kCommand, sequence_, code, body), from);
    if (answers.empty()) return std::nullopt;
    const livox::ParsedFrame parsed = livox::ParseFrame(answers.front().bytes);
    EXPECT_THAT(answers, SizeIs(1));
    EXPECT_TRUE(parsed.frame.has_value());
    EXPECT_EQ(parsed.frame->type, FrameType::kAck);
    EXPECT_EQ(parsed.frame->sequence, sequence_);
    EXPECT_EQ(livox::CodeOf(*parsed.frame), code);
    return Bytes(parsed.frame->data.begin(), parsed.frame->data.end());
  }
  bool Does(CommandCode code, const Bytes& body = {}, const Endpoint& from = kHost) {
    const std::optional<Bytes> answer = Ask(code, body, from);
    return answer && answer->front() == std::byte{0};
  }
  bool Shake(const Endpoint& host = kHost) {
    const livox::Handshake body{
        .host_ip = host.ip, .data_port = 56001, .command_port = host.port, .imu_port = 57001};
    return Does(CommandCode::kHandshake, livox::PackBody(body), host);
  }
  livox::HeartbeatAck Beat() {
    const std::optional<Bytes> answer = Ask(CommandCode::kHeartbeat);
    return livox::ParseHeartbeatAck(answer.value_or(Bytes())).value_or(livox::HeartbeatAck{1});
  }
  // Lets time pass in steps of 10 ms; all that the sensor says unasked.
  std::vector<EmulatedMid70::Outgoing> Pass(std::int64_t duration_us, bool has_heartbeat = false) {
    std::vector<EmulatedMid70::Outgoing> all;
    for (const std::int64_t end_us = now_us_ + duration_us; now_us_ < end_us; now_us_ += 10'000) {
      if (has_heartbeat && now_us_ % 800'000 == 0) (void)Beat();
      for (auto& outgoing : device_.Advance(now_us_)) all.push_back(std::move(outgoing));
    }
    return all;
  }
  void ConnectAndStart() {
    Pass(2 * kSecond_us);
    ASSERT_TRUE(Shake());
    ASSERT_TRUE(Does(CommandCode::kSampling, livox::PackByte(1)));
  }
  [[nodiscard]] bool IsSampling() const { return device_.sampling(now_us_).has_value(); }

  std::int64_t now_us_ = 0;
  std::uint16_t sequence_ = 100;
  EmulatedMid70 device_;
};

TEST_F(EmulatedMid70Test, AnnouncesItselfOnceASecondAsTheVendorsFrameDoes) {
  const auto said = Pass(3 * kSecond_us);

  ASSERT_THAT(said, SizeIs(3));
  EXPECT_EQ(said[0].to, (Endpoint{kBroadcastIpv4, 55000}));
  EXPECT_EQ(said[0].bytes,
            FromHex("aa012200020000597e0000334747444a364b303031303031303100060000dbd1f23a"));
  EXPECT_EQ(said[1].bytes,
            FromHex("aa01220002010081670000334747444a364b3030313030313031000600006ea77097"));
}

TEST_F(EmulatedMid70Test, TakesTheHandshakeOfTheSdkAndThatOfTheWiki) {
  for (const Bytes& handshake : {kHandshakeOfSdk, kHandshakeOfWiki}) {
    now_us_ += kSecond_us;
    const auto answers = Tell(handshake);

    ASSERT_THAT(answers, SizeIs(1));
    EXPECT_EQ(answers[0].bytes, kHandshakeAck);
    EXPECT_EQ(answers[0].to, kHost);
    EXPECT_EQ(device_.host(), kHost);
  }
}

TEST_F(EmulatedMid70Test, TakesTheOldHandshakeWithoutAnImuPort) {
  now_us_ = kSecond_us;

  const auto answers =
      Tell(FromHex("aa01170000000064390001c0a82101bd07e8fd1e25f912"), {0xC0A82101, 4711});

  ASSERT_THAT(answers, SizeIs(1));
  EXPECT_EQ(answers[0].bytes, FromHex("aa0110000100006453000100f1343c29"));
  EXPECT_EQ(answers[0].to, (Endpoint{0xC0A82101, 65000}));
}

TEST_F(EmulatedMid70Test, AnswersByteForByteAsTheVendorsFramesDo) {
  Pass(2 * kSecond_us);
  (void)Tell(kHandshakeOfSdk);

  const auto beat = Tell(kHeartbeat);
  const auto info = Tell(FromHex("aa010f00000600d483000246 5632e0"));

  ASSERT_THAT(beat, SizeIs(1));
  EXPECT_EQ(beat[0].bytes, FromHex("aa0116000103009442000300010000000000 67134190"));
  ASSERT_THAT(info, SizeIs(1));
  EXPECT_EQ(info[0].bytes, FromHex("aa011400010600a42a0002000a030001afd2146b"));
}

TEST_F(EmulatedMid70Test, TellsAndKeepsItsExtrinsic) {
  Pass(2 * kSecond_us);
  (void)Tell(kHandshakeOfSdk);
  const livox::Extrinsic extrinsic{1.5F, -2.25F, 90.0F, 100, -200, 300};

  EXPECT_TRUE(Does(CommandCode::kSetExtrinsic, livox::PackBody(extrinsic)));
  device_.PowerCycle(now_us_);
  now_us_ += kSecond_us;
  (void)Tell(kHandshakeOfSdk);
  const auto answers = Tell(FromHex("aa010f00000b00ac330102ba02622e"));

  ASSERT_THAT(answers, SizeIs(1));
  EXPECT_EQ(answers[0].bytes,
            FromHex("aa012800010b003d39010200 0000c03f000010c00000b442 "
                    "64000000 38ffffff 2c010000 9fd6a939"));
}

TEST_F(EmulatedMid70Test, SendsAnAbnormalStatusTenTimesASecondAsTheVendorsFrameDoes) {
  ConnectAndStart();
  device_.SetStatus({.window = livox::Severity::kWarning, .system = livox::Severity::kWarning});

  const auto said = Pass(kSecond_us);

  ASSERT_THAT(said, SizeIs(10));
  EXPECT_EQ(said[0].to, kHost);
  const livox::ParsedFrame parsed = livox::ParseFrame(said[0].bytes);
  ASSERT_TRUE(parsed.frame.has_value());
  EXPECT_EQ(parsed.frame->type, FrameType::kMessage);
  EXPECT_EQ(livox::CodeOf(*parsed.frame), CommandCode::kAbnormalStatus);
  EXPECT_EQ(livox::Load<std::uint32_t>(parsed.frame->data, 0), 0x40000040U);
  EXPECT_EQ(Beat().progress, 0x40000040U);
  EXPECT_TRUE(IsSampling()) << "a dirty window still lets points through";
}

TEST_F(EmulatedMid70Test, FallsSilentWhileConnected) {
  Pass(kSecond_us);
  ASSERT_TRUE(Shake());

  EXPECT_THAT(Pass(4 * kSecond_us), IsEmpty());
}

TEST_F(EmulatedMid70Test, TellsItsProgressUntilItMeasures) {
  now_us_ = 400'000;
  ASSERT_TRUE(Shake());

  const livox::HeartbeatAck early = Beat();
  now_us_ = 990'000;
  const livox::HeartbeatAck late = Beat();
  now_us_ = kSecond_us;
  const livox::HeartbeatAck done = Beat();

  EXPECT_EQ(early.state, WorkState::kInit);
  EXPECT_EQ(early.progress, 40U);
  EXPECT_EQ(late.progress, 99U);
  EXPECT_EQ(done.state, WorkState::kNormal);
  EXPECT_EQ(done.progress, 0U);
}

TEST_F(EmulatedMid70Test, SendsPointsFromStartToStopAndOnlyWhenItMeasures) {
  now_us_ = 400'000;
  ASSERT_TRUE(Shake());
  ASSERT_TRUE(Does(CommandCode::kSampling, livox::PackByte(1)));
  EXPECT_FALSE(IsSampling());

  now_us_ = kSecond_us;
  ASSERT_TRUE(IsSampling());
  EXPECT_EQ(device_.sampling(now_us_)->to, (Endpoint{kHost.ip, 56001}));
  ASSERT_TRUE(Does(CommandCode::kSampling, livox::PackByte(0)));

  EXPECT_FALSE(IsSampling());
}

TEST_F(EmulatedMid70Test, TheDataTypeFollowsReturnModeAndCoordinates) {
  ConnectAndStart();
  std::vector<livox::DataType> types;

  for (const std::uint8_t coordinates : std::to_array<std::uint8_t>({0, 1})) {
    for (const std::uint8_t mode : std::to_array<std::uint8_t>({0, 1, 2})) {
      ASSERT_TRUE(Does(CommandCode::kCoordinates, livox::PackByte(coordinates)));
      ASSERT_TRUE(Does(CommandCode::kSetReturnMode, livox::PackByte(mode)));
      EXPECT_EQ(Ask(CommandCode::kGetReturnMode), (Bytes{std::byte{0}, std::byte{mode}}));
      types.push_back(device_.sampling(now_us_)->data_type);
    }
  }

  using livox::DataType;
  EXPECT_THAT(types,
              ElementsAre(DataType::kExtendedCartesian,
                          DataType::kExtendedCartesian,
                          DataType::kDualCartesian,
                          DataType::kExtendedSpherical,
                          DataType::kExtendedSpherical,
                          DataType::kDualSpherical));
}

TEST_F(EmulatedMid70Test, AHostThatIsNotHeardForSoLongIsGone) {
  ConnectAndStart();
  Pass(20 * kSecond_us, true);
  EXPECT_TRUE(IsSampling());
  (void)Beat();

  EXPECT_THAT(Pass(4'990'000), IsEmpty());
  EXPECT_TRUE(IsSampling());
  const auto said = Pass(2 * kSecond_us);

  EXPECT_FALSE(IsSampling());
  EXPECT_EQ(device_.counts().host_timeouts, 1);
  EXPECT_THAT(said, SizeIs(2)) << "it announces itself again";
}

TEST_F(EmulatedMid70Test, OtherCommandsThanHeartbeatsDoNotKeepTheHost) {
  ConnectAndStart();

  for (int i = 0; i < 12; ++i) {
    Pass(500'000);
    (void)Ask(CommandCode::kDeviceInfo);
  }

  EXPECT_FALSE(IsSampling());
  EXPECT_EQ(device_.counts().host_timeouts, 1);
}

TEST_F(EmulatedMid70Test, SaysGoodbyeAndAnnouncesItselfAtOnce) {
  ConnectAndStart();

  EXPECT_TRUE(Does(CommandCode::kDisconnect));

  EXPECT_FALSE(IsSampling());
  EXPECT_FALSE(device_.host().has_value());
  EXPECT_THAT(device_.Advance(now_us_), SizeIs(1));
}

TEST_F(EmulatedMid70Test, AnswersNobodyButTheConnectedHost) {
  Pass(kSecond_us);
  EXPECT_FALSE(Ask(CommandCode::kDeviceInfo).has_value()) << "before the handshake";
  ASSERT_TRUE(Shake());

  EXPECT_FALSE(Ask(CommandCode::kSampling, livox::PackByte(1), kOther).has_value());

  EXPECT_FALSE(IsSampling());
  EXPECT_EQ(device_.counts().foreign, 2);
}

TEST_F(EmulatedMid70Test, ASecondHostTakesItOver) {
  ConnectAndStart();

  EXPECT_TRUE(Shake(kOther));

  EXPECT_EQ(device_.host(), kOther);
  EXPECT_FALSE(IsSampling()) << "each handshake begins anew";
  EXPECT_FALSE(Ask(CommandCode::kHeartbeat).has_value()) << "the first host is not answered";
  EXPECT_EQ(device_.counts().takeovers, 1);
}

class FaithfulMid70Test : public EmulatedMid70Test {
 protected:
  FaithfulMid70Test() : EmulatedMid70Test({.lets_others_take_over = false}) {}
};

TEST_F(FaithfulMid70Test, RefusesASecondHostWhenToldTo) {
  ConnectAndStart();

  EXPECT_FALSE(Shake(kOther));

  EXPECT_EQ(device_.host(), kHost);
  EXPECT_TRUE(IsSampling());
}

TEST_F(EmulatedMid70Test, RefusesAHandshakeThatSaysNoAddressOrPort) {
  Pass(kSecond_us);
  const auto shake = [this](const livox::Handshake& body) {
    return Does(CommandCode::kHandshake, livox::PackBody(body));
  };

  EXPECT_FALSE(shake({0, 56001, 55501, 0}));
  EXPECT_FALSE(shake({kBroadcastIpv4, 56001, 55501, 0}));
  EXPECT_FALSE(shake({kHost.ip, 0, 55501, 0}));
  EXPECT_FALSE(shake({kHost.ip, 56001, 0, 0}));
  EXPECT_FALSE(Does(CommandCode::kHandshake, Bytes(9)));

  EXPECT_FALSE(device_.host().has_value());
}

TEST_F(EmulatedMid70Test, RefusesWhatIsUnknownOrMalformed) {
  ConnectAndStart();

  for (const auto code : {0x0012, 0x0103, 0x0104, 0x0108, 0x01FF, 0x0201}) {
    const std::optional<Bytes> answer = Ask(static_cast<CommandCode>(code));
    ASSERT_TRUE(answer.has_value()) << code;
    EXPECT_NE(answer->front(), std::byte{0}) << code;
  }
  EXPECT_FALSE(Does(CommandCode::kSampling));
  EXPECT_FALSE(Does(CommandCode::kSampling, livox::PackByte(2)));
  EXPECT_FALSE(Does(CommandCode::kCoordinates, livox::PackByte(2)));
  EXPECT_FALSE(Does(CommandCode::kSetReturnMode, livox::PackByte(3)));
  EXPECT_FALSE(Does(CommandCode::kMode, livox::PackByte(0)));
  EXPECT_FALSE(Does(CommandCode::kReboot, livox::PackByte(0)));
  EXPECT_FALSE(Does(CommandCode::kSetExtrinsic, Bytes(23)));
  EXPECT_FALSE(Does(CommandCode::kSetUtcTime, Bytes(8))) << "month 0";
  EXPECT_TRUE(IsSampling());
}

TEST_F(EmulatedMid70Test, SleepsAndStartsUpAgain) {
  ConnectAndStart();

  ASSERT_TRUE(Does(CommandCode::kMode, livox::PackByte(3)));
  EXPECT_EQ(Beat().state, WorkState::kStandby);
  EXPECT_FALSE(IsSampling());
  ASSERT_TRUE(Does(CommandCode::kMode, livox::PackByte(1)));
  EXPECT_EQ(Beat().state, WorkState::kInit);
  now_us_ += kSecond_us;

  EXPECT_EQ(Beat().state, WorkState::kNormal);
  EXPECT_TRUE(IsSampling());
}

TEST_F(EmulatedMid70Test, AMotorErrorStopsThePoints) {
  ConnectAndStart();

  device_.SetStatus({.motor = livox::Severity::kError, .system = livox::Severity::kError});

  EXPECT_EQ(Beat().state, WorkState::kError);
  EXPECT_FALSE(IsSampling());
}

TEST_F(EmulatedMid70Test, RebootsAfterTheDelayAndKeepsWhatItKeeps) {
  ConnectAndStart();
  ASSERT_TRUE(Does(CommandCode::kSetReturnMode, livox::PackByte(2)));
  ASSERT_TRUE(Does(CommandCode::kCoordinates, livox::PackByte(1)));
  Bytes delay;
  livox::Append(delay, std::uint16_t{500});

  ASSERT_TRUE(Does(CommandCode::kReboot, delay));
  const std::int64_t told_us = now_us_;
  Pass(490'000);
  EXPECT_TRUE(IsSampling());
  const auto said = Pass(kSecond_us);

  EXPECT_EQ(device_.started_us(), told_us + 500'000);
  EXPECT_FALSE(IsSampling());
  EXPECT_THAT(said, SizeIs(1));
  now_us_ += kSecond_us;
  ASSERT_TRUE(Shake());
  ASSERT_TRUE(Does(CommandCode::kSampling, livox::PackByte(1)));
  EXPECT_EQ(device_.sampling(now_us_)->data_type, livox::DataType::kDualCartesian);
}

TEST_F(EmulatedMid70Test, ASetAddressHoldsFromTheNextStartOn) {
  ConnectAndStart();
  const Bytes body = FromHex("01 c0a80166 ffffff00 c0a80101");

  EXPECT_TRUE(Does(CommandCode::kSetIp, body));
  EXPECT_EQ(Ask(CommandCode::kGetIp), FromHex("00 01 c0a80166 ffffff00 c0a80101"));
  EXPECT_EQ(device_.ip(), kSensorIp);
  device_.PowerCycle(now_us_);

  EXPECT_EQ(device_.ip(), kSensorIp + 1);
  now_us_ += kSecond_us;
  ASSERT_TRUE(Shake());
  EXPECT_FALSE(Does(CommandCode::kSetIp, FromHex("01 00000000 ffffff00 c0a80101")));
  EXPECT_FALSE(Does(CommandCode::kSetIp, FromHex("02 c0a80166 ffffff00 c0a80101")));
  EXPECT_FALSE(Does(CommandCode::kSetIp, FromHex("01 c0a80166")));
}

TEST_F(EmulatedMid70Test, HasOneParameterTheSlot) {
  ConnectAndStart();

  EXPECT_EQ(Ask(CommandCode::kSetParameter, FromHex("0300 0100 07")), FromHex("00 0000 00"));
  EXPECT_EQ(Ask(CommandCode::kGetParameter, FromHex("01 0300")),
            FromHex("00 0000 00 0300 0100 07"));
  EXPECT_EQ(device_.memory().slot, 7);
  EXPECT_EQ(Ask(CommandCode::kSetParameter, FromHex("0300 0100 0a")), FromHex("01 0300 01"));
  EXPECT_EQ(Ask(CommandCode::kSetParameter, FromHex("0100 0100 01")), FromHex("01 0100 01"));
  EXPECT_EQ(Ask(CommandCode::kGetParameter, FromHex("02 0300 0200")), FromHex("01 0200 01"));
  EXPECT_EQ(Ask(CommandCode::kGetParameter, FromHex("02 0300")), FromHex("01 0000 01"));
  EXPECT_EQ(Ask(CommandCode::kResetParameters, FromHex("01 01 0300")), FromHex("00 0000 00"));
  EXPECT_EQ(device_.memory().slot, 1);
}

TEST_F(EmulatedMid70Test, KeepsTheTimeThatItIsTold) {
  ConnectAndStart();
  const std::int64_t utc_ns = 1'700'000'000'123'456'000;
  Bytes body;
  livox::Append(body, livox::ToGpsTimestamp(utc_ns));

  EXPECT_TRUE(Does(CommandCode::kSetUtcTime, body));

  ASSERT_TRUE(device_.utc().has_value());
  EXPECT_EQ(device_.utc()->utc_ns, utc_ns);
  EXPECT_EQ(device_.utc()->told_us, now_us_);
}

TEST_F(EmulatedMid70Test, IgnoresAndCountsWhatIsBrokenOrNoCommand) {
  ConnectAndStart();
  Bytes broken = kHeartbeat;
  broken.back() ^= std::byte{1};

  EXPECT_THAT(Tell(broken), IsEmpty());
  EXPECT_THAT(Tell({}), IsEmpty());
  EXPECT_THAT(Tell(livox::PackCommand(FrameType::kAck, 1, CommandCode::kHeartbeat, {})), IsEmpty());
  EXPECT_THAT(Tell(livox::PackCommand(FrameType::kMessage, 1, CommandCode::kHandshake, Bytes(10))),
              IsEmpty());
  // The two that deafen and that crash the vendor's own SDK.
  EXPECT_THAT(Tell(FromHex("aa01401f020000 3ab8 0000")), IsEmpty());
  EXPECT_THAT(Tell(FromHex("aa010100020000 0403 0000")), IsEmpty());

  using livox::FrameDefect;
  const auto& broken_counts = device_.counts().broken;
  EXPECT_EQ(broken_counts[static_cast<std::size_t>(FrameDefect::kCrc)], 1);
  EXPECT_EQ(broken_counts[static_cast<std::size_t>(FrameDefect::kTooShort)], 3);
  EXPECT_EQ(device_.counts().unasked, 2);
  EXPECT_TRUE(IsSampling());
}

TEST_F(EmulatedMid70Test, HasNoNetworkBeforeItHasBooted) {
  now_us_ = 199'999;
  EXPECT_FALSE(Shake());
  now_us_ = 200'000;
  EXPECT_TRUE(Shake());
}

TEST_F(EmulatedMid70Test, AnotherAddressLosesTheConnection) {
  ConnectAndStart();

  device_.ChangeAddress(kSensorIp + 1, now_us_);

  EXPECT_EQ(device_.ip(), kSensorIp + 1);
  EXPECT_FALSE(IsSampling());
  EXPECT_THAT(device_.Advance(now_us_), SizeIs(1));
}

// Whatever it is told, by whomever: points only for a host that shook hands and was heard within
// the time-out, broadcasts only without one, and never more than one answer.
TEST_F(EmulatedMid70Test, HoldsItsPromisesUnderRandomCommands) {
  std::uint64_t random = 1;
  const auto draw = [&random](std::uint64_t below) {
    return (random = SplitMix64(random)) % below;
  };
  std::int64_t heard_us = -1'000'000'000;
  std::int64_t last_broadcast_us = -1'000'000'000;
  for (int step = 0; step < 50'000; ++step) {
    now_us_ += static_cast<std::int64_t>(draw(300'000));
    const auto outgoing = device_.Advance(now_us_);
    ASSERT_LE(outgoing.size(), 1U);
    if (!outgoing.empty() && outgoing[0].code == CommandCode::kBroadcast) {
      ASSERT_FALSE(device_.host().has_value());
      ASSERT_GE(now_us_ - last_broadcast_us, 0);
      last_broadcast_us = now_us_;
    }
    const Endpoint from = draw(4) == 0 ? kOther : kHost;
    const auto code = static_cast<CommandCode>(draw(2) << 8U | draw(16));
    Bytes body(draw(14));
    for (std::byte& byte : body) byte = static_cast<std::byte>(draw(5));
    const auto answers = Tell(livox::PackCommand(FrameType::kCommand, 1, code, body), from);
    ASSERT_LE(answers.size(), 1U);
    const bool is_word = code == CommandCode::kHandshake || code == CommandCode::kHeartbeat;
    if (is_word && !answers.empty()) heard_us = now_us_;
    if (device_.host() || device_.sampling(now_us_)) {
      ASSERT_LT(now_us_ - heard_us, 5 * kSecond_us) << "step " << step;
    }
    ASSERT_TRUE(!device_.sampling(now_us_) || device_.host().has_value());
    if (device_.host() && draw(3) == 0) (void)Ask(CommandCode::kSampling, livox::PackByte(1));
  }
  EXPECT_GT(device_.counts().handshakes, 10);
  EXPECT_GT(device_.counts().starts, 1);
}

}  // namespace
}  // namespace clearway::core
