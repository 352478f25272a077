// SPDX-License-Identifier: BSD-3-Clause
// The host's side of the conversation against an emulated MID-70: connections, and what ends them.
#include "common/core/livox/sensor_link.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <gmock/gmock.h>

#include "tests/unit/livox/sensor_link_fixture.hpp"

namespace clearway::core::livox {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::Ge;
using testing::HasSubstr;
using Kind = LinkEvent::Kind;

class SensorLinkTest : public SensorLinkFixture {};

bool IsHeartbeat(CommandCode code) {
  return code == CommandCode::kHeartbeat;
}

TEST_F(SensorLinkTest, ConnectsToASensorThatAnnouncesItselfAndSamples) {
  RunFor(3 * kSecond_us);

  EXPECT_EQ(link_->state(), LinkState::kSampling);
  EXPECT_EQ(Report().health, Health::kOk);
  EXPECT_EQ(Text(), "samples");
  EXPECT_EQ(link_->counts().connections, 1);
  EXPECT_EQ(link_->counts().handshakes, 1);
  EXPECT_EQ(link_->counts().odd_frames, 0);
  EXPECT_EQ(link_->firmware(), (std::array<std::uint8_t, 4>{10, 3, 0, 1}));
  EXPECT_TRUE(link_->accepts_data());
  EXPECT_FALSE(link_->counts().repeats > 0) << "on a good cable everything is said once";
}

TEST_F(SensorLinkTest, TellsTheSensorItsSettingsInOrderBeforeItSamples) {
  MakeLink({.return_mode = ReturnMode::kDual, .coordinates = Coordinates::kSpherical});

  Connect();

  std::vector<CommandCode> order;
  for (const Frame& frame : sent_) {
    if (!IsHeartbeat(frame.code)) order.push_back(frame.code);
  }
  EXPECT_THAT(order,
              ElementsAre(CommandCode::kHandshake,
                          CommandCode::kDeviceInfo,
                          CommandCode::kCoordinates,
                          CommandCode::kSetReturnMode,
                          CommandCode::kGetExtrinsic,
                          CommandCode::kSampling));
  EXPECT_EQ(sensor_->sampling(now_us_)->data_type, DataType::kDualSpherical);
  EXPECT_EQ(sensor_->sampling(now_us_)->to, (Endpoint{kHost, 56001}));
}

TEST_F(SensorLinkTest, AsksAKnownAddressWithoutABroadcast) {
  cable_ = [](const Frame& frame) { return frame.code != CommandCode::kBroadcast; };
  RunFor(kSecond_us);
  EXPECT_EQ(link_->state(), LinkState::kSearching);

  link_->Offer({kSensor, kDevicePort}, kHost, now_us_);
  RunFor(3 * kSecond_us);

  EXPECT_EQ(link_->state(), LinkState::kSampling);
}

TEST_F(SensorLinkTest, AHandshakeNamesTheNewestAddressOfThisHost) {
  cable_ = [](const Frame&) { return false; };
  link_->Offer({kSensor, kDevicePort}, kHost, now_us_);
  RunFor(kSecond_us);
  link_->Offer({kSensor, kDevicePort}, kHost + 7, now_us_);
  RunFor(5 * kSecond_us);

  EXPECT_EQ(ParseHandshake(handshakes_.front().body)->host_ip, kHost);
  EXPECT_EQ(ParseHandshake(handshakes_.back().body)->host_ip, kHost + 7);
}

TEST_F(SensorLinkTest, AsksASilentAddressLessAndLessOften) {
  cable_ = [](const Frame&) { return false; };
  link_->Offer({kSensor, kDevicePort}, kHost, now_us_);

  RunFor(60 * kSecond_us);

  std::vector<double> gaps_s;
  for (std::size_t i = 1; i < handshakes_.size(); ++i) {
    gaps_s.push_back(1e-6 * static_cast<double>(handshakes_[i].at_us - handshakes_[i - 1].at_us));
  }
  ASSERT_GE(gaps_s.size(), 10U);
  EXPECT_LE(gaps_s.size(), 16U);
  for (std::size_t i = 0; i < gaps_s.size(); ++i) {
    EXPECT_NEAR(gaps_s[i], std::min(0.5 * std::pow(2.0, static_cast<double>(i)), 5.0), 0.011) << i;
  }
}

TEST_F(SensorLinkTest, AFloodOfBroadcastsDoesNotMakeAFloodOfHandshakes) {
  cable_ = [](const Frame&) { return false; };

  for (int i = 0; i < 2000; ++i) {
    link_->OnBroadcast({kSensor, kDevicePort}, kHost, now_us_);
    TakeFromLink();
    Step();
  }

  EXPECT_LE(handshakes_.size(), 51U) << "10 s, one each 200 ms";
  EXPECT_GE(handshakes_.size(), 10U);
}

TEST_F(SensorLinkTest, ShakesHandsInTurnAsDescribedAndAsTheVendorsSdkDoes) {
  cable_ = [](const Frame&) { return false; };
  link_->Offer({kSensor, kDevicePort}, kHost, now_us_);

  RunFor(3 * kSecond_us);

  ASSERT_GE(handshakes_.size(), 2U);
  EXPECT_EQ(handshakes_[0].type, FrameType::kCommand);
  EXPECT_EQ(handshakes_[1].type, FrameType::kAck);
}

TEST_F(SensorLinkTest, ConnectsAnewWhenHeartbeatsAreNotAnsweredAlthoughPointsArrive) {
  Connect();
  cable_ = [](const Frame& frame) { return !IsHeartbeat(frame.code); };
  RunUntil([this] { return link_->counts().losses > 0; }, 10 * kSecond_us);
  const bool took_points_meanwhile = link_->accepts_data();
  cable_ = {};
  RunFor(5 * kSecond_us);

  EXPECT_TRUE(took_points_meanwhile);
  EXPECT_EQ(link_->state(), LinkState::kSampling);
  EXPECT_EQ(link_->counts().losses, 1);
  EXPECT_EQ(link_->counts().connections, 2);
  EXPECT_TRUE(HasEvent("answers no heartbeat"));
}

TEST_F(SensorLinkTest, AnswersThatTakeLongerThanTheTimeOutAreGoodAnswers) {
  delay_us_ = 400'000;

  RunFor(20 * kSecond_us);

  EXPECT_EQ(link_->state(), LinkState::kSampling);
  EXPECT_EQ(link_->counts().connections, 1);
  EXPECT_EQ(link_->counts().losses, 0);
}

TEST_F(SensorLinkTest, ACableThatWasPulledForAMinuteIsNoticedAndUsedAgain) {
  Connect();
  has_points_ = false;
  cable_ = [](const Frame&) { return false; };
  RunFor(60 * kSecond_us);
  EXPECT_EQ(Report().health, Health::kFault);
  EXPECT_THAT(Text(), HasSubstr("192.168.1.101 answers no handshake for"));
  EXPECT_THAT(Text(), HasSubstr("switched on and plugged in"));

  has_points_ = true;
  cable_ = {};
  const std::int64_t took_us =
      RunUntil([this] { return link_->state() == LinkState::kSampling; }, 20 * kSecond_us);

  EXPECT_LE(took_us, 3 * kSecond_us) << "the next broadcast, not the end of the back-off";
}

class SensorLinkRestartTest : public SensorLinkFixture, public testing::WithParamInterface<int> {};

// At 20 moments of the heartbeats' period and of the second.
TEST_P(SensorLinkRestartTest, GivesPointsWithin3SecondsOfTheFirstBroadcastAfterARestart) {
  Connect();
  RunFor(137'000 * GetParam());
  std::optional<std::int64_t> broadcast_us;
  cable_ = [&](const Frame& frame) {
    if (frame.code == CommandCode::kBroadcast && !broadcast_us) broadcast_us = now_us_;
    return true;
  };

  sensor_->PowerCycle(now_us_);
  const std::int64_t off_us = now_us_;
  RunUntil([&] { return last_data_us_ > off_us; }, 10 * kSecond_us);

  ASSERT_TRUE(broadcast_us.has_value());
  EXPECT_LE(now_us_ - *broadcast_us, 3 * kSecond_us);
  RunFor(kSecond_us);
  EXPECT_EQ(link_->state(), LinkState::kSampling);
  EXPECT_EQ(link_->counts().restarts, 1);
  EXPECT_EQ(link_->counts().losses, 0) << "found by its broadcast, not by silence";
  EXPECT_TRUE(HasEvent("was restarted"));
}

INSTANTIATE_TEST_SUITE_P(Moments, SensorLinkRestartTest, testing::Range(0, 20));

class SensorLinkLossTest : public SensorLinkFixture, public testing::WithParamInterface<int> {};

TEST_P(SensorLinkLossTest, ConnectsAndSetsUpThroughTheLossOfHalfOfAllFrames) {
  MakeLink({.return_mode = ReturnMode::kDual, .coordinates = Coordinates::kSpherical});
  std::mt19937 random(static_cast<unsigned>(GetParam()));
  cable_ = [&](const Frame&) { return (random() & 1U) == 0; };

  RunUntil([this] { return sensor_->sampling(now_us_).has_value(); }, 120 * kSecond_us);
  ASSERT_TRUE(sensor_->sampling(now_us_).has_value());

  cable_ = {};
  RunFor(25 * kSecond_us);
  EXPECT_EQ(Text(), "samples") << "what was given up meanwhile has been asked again";
  EXPECT_EQ(sensor_->sampling(now_us_)->data_type, DataType::kDualSpherical);
}

INSTANTIATE_TEST_SUITE_P(Seeds, SensorLinkLossTest, testing::Range(1, 31));

TEST_F(SensorLinkTest, ASensorThatAnnouncesItselfWhileItsPointsArriveIsLeftAlone) {
  Connect();

  for (int i = 0; i < 10; ++i) {
    link_->OnBroadcast({kSensor, kDevicePort}, kHost, now_us_);
    RunFor(kSecond_us);
  }

  EXPECT_EQ(link_->counts().broadcasts_while_connected, 10);
  EXPECT_EQ(link_->counts().connections, 1);
}

TEST_F(SensorLinkTest, FollowsASensorToAnotherAddress) {
  Connect();
  sensor_->ChangeAddress(kSensor + 1, now_us_);
  announces_from_ = kSensor + 1;

  RunFor(6 * kSecond_us);

  EXPECT_EQ(link_->state(), LinkState::kSampling);
  EXPECT_EQ(link_->address()->ip, kSensor + 1);
  EXPECT_TRUE(HasEvent("has moved from 192.168.1.101 to 192.168.1.102"));
}

TEST_F(SensorLinkTest, ASecondSensorWithTheSameCodeIsToldAndNotUsed) {
  Connect();

  link_->OnBroadcast({kSensor + 1, kDevicePort}, kHost, now_us_);
  RunFor(kSecond_us);

  EXPECT_EQ(link_->address()->ip, kSensor);
  EXPECT_EQ(link_->counts().connections, 1);
  EXPECT_EQ(Report().health, Health::kDegraded);
  EXPECT_THAT(Text(), HasSubstr("same broadcast code is at 192.168.1.102"));
}

TEST_F(SensorLinkTest, TakesASensorBackFromASecondHost) {
  Connect();
  SendAside(CommandCode::kHandshake, PackBody(Handshake{kHost + 1, 56001, 55501, 0}), kHost + 1);
  ASSERT_EQ(sensor_->host()->ip, kHost + 1);

  RunFor(6 * kSecond_us);

  EXPECT_EQ(link_->counts().losses, 1);
  EXPECT_EQ(link_->state(), LinkState::kSampling);
  EXPECT_EQ(sensor_->host()->ip, kHost);
}

TEST_F(SensorLinkTest, SaysThatAnotherHostTakesASensorAgainAndAgain) {
  Connect();
  for (int i = 0; i < 3; ++i) {
    SendAside(CommandCode::kHandshake, PackBody(Handshake{kHost + 1, 56001, 55501, 0}), kHost + 1);
    RunFor(5 * kSecond_us);
  }
  const LinkReport meanwhile = Report();
  RunFor(10 * kSecond_us);

  EXPECT_EQ(meanwhile.health, Health::kDegraded);
  EXPECT_EQ(meanwhile.text, "its connections do not last: another program or host takes it");
  EXPECT_EQ(link_->counts().losses, 3);
  EXPECT_EQ(Text(), "samples") << "the other one has given up";
}

TEST_F(SensorLinkTest, SaysThatASensorRefusesTheHandshakeAndGoesOnAsking) {
  MakeSensor({.lets_others_take_over = false}, {.ip = kSensor});
  cable_ = [](const Frame&) { return false; };
  RunFor(300'000);  // Until it has a network.
  cable_ = {};
  MakeLink({});
  SendAside(CommandCode::kHandshake, PackBody(Handshake{kHost + 1, 56001, 55501, 0}), kHost + 1);
  link_->Offer({kSensor, kDevicePort}, kHost, now_us_);
  RunFor(kSecond_us);

  EXPECT_EQ(Report().health, Health::kFault);
  EXPECT_EQ(Text(),
            "192.168.1.101 refuses the handshake (result 1): is another program or host connected "
            "to it?");
  RunFor(12 * kSecond_us);  // The other host is silent, and the sensor lets it go.
  EXPECT_EQ(link_->state(), LinkState::kSampling);
}

TEST_F(SensorLinkTest, SaysThatAFirewallMayKeepTheAnswersOut) {
  cable_ = [](const Frame& frame) {
    return frame.to_sensor || frame.code == CommandCode::kBroadcast;
  };
  // It announces itself and answers; a sensor that has been connected to is silent, so its
  // connection is not kept.
  RunUntil([this] { return handshakes_.size() >= 3; }, 20 * kSecond_us);
  link_->OnBroadcast({kSensor, kDevicePort}, kHost, now_us_);

  EXPECT_EQ(Report().health, Health::kFault);
  EXPECT_EQ(Text(),
            "192.168.1.101 announces itself, but its answers do not come: does a firewall stop UDP "
            "to port 55501?");
}

TEST_F(SensorLinkTest, ClosingStopsTheSensorAndSaysGoodbye) {
  Connect();
  sent_.clear();

  link_->Close();
  TakeFromLink();
  RunFor(500'000);

  EXPECT_EQ(link_->state(), LinkState::kClosed);
  EXPECT_EQ(sensor_->host(), std::nullopt);
  std::vector<CommandCode> said;
  for (const Frame& frame : sent_) said.push_back(frame.code);
  EXPECT_THAT(said, ElementsAre(CommandCode::kSampling, CommandCode::kDisconnect));
  EXPECT_EQ(sent_.front().body, PackByte(0));
  link_->OnBroadcast({kSensor, kDevicePort}, kHost, now_us_);
  EXPECT_TRUE(link_->TakeOutgoing().empty()) << "nothing happens any more";
}

TEST_F(SensorLinkTest, ClosingWhileSearchingSaysNothing) {
  link_->Close();

  EXPECT_TRUE(link_->TakeOutgoing().empty());
}

TEST_F(SensorLinkTest, SequencesGoOnBeyondTheirLargestNumberWithoutZero) {
  MakeLink({.heartbeat_us = 50'000});
  Connect();

  RunFor(65'600 * std::int64_t{50'000});

  EXPECT_EQ(link_->counts().losses, 0);
  EXPECT_EQ(link_->counts().odd_frames, 0);
  EXPECT_EQ(Text(), "samples");
  const bool has_wrapped = std::any_of(
      sent_.begin() + 1000, sent_.end(), [](const Frame& frame) { return frame.sequence == 1; });
  EXPECT_TRUE(has_wrapped);  // That none is 0 is seen for each frame that is sent.
}

TEST_F(SensorLinkTest, AnswersThatNobodyAskedForAreCountedAndChangeNothing) {
  Connect();
  const auto ack = [](CommandCode code, std::uint16_t sequence, const Bytes& body) {
    return ControlFrame{FrameType::kAck, sequence, SetOf(code), IdOf(code), body};
  };
  const Bytes ok = PackByte(0);
  const Bytes no = PackByte(1);
  const Bytes heartbeat = PackBody(HeartbeatAck{.result = 0, .state = WorkState::kError});

  link_->OnFrame(ack(CommandCode::kHandshake, 1, no), now_us_);
  link_->OnFrame(ack(CommandCode::kHeartbeat, 60'000, heartbeat), now_us_);
  link_->OnFrame(ack(CommandCode::kSampling, 60'000, no), now_us_);
  link_->OnFrame(ack(CommandCode::kReboot, 3, ok), now_us_);
  link_->OnFrame({FrameType::kCommand, 3, 0, 3, ok}, now_us_);
  link_->OnFrame({FrameType::kMessage, 3, 0, 7, ok}, now_us_);

  EXPECT_EQ(link_->counts().odd_frames, 6);
  EXPECT_EQ(link_->state(), LinkState::kSampling);
  EXPECT_EQ(Text(), "samples");
}

}  // namespace
}  // namespace clearway::core::livox
