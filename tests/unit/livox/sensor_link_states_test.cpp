// SPDX-License-Identifier: BSD-3-Clause
// The host's side of the conversation against an emulated MID-70: settings, what the sensor says of
// itself, and points that do not come.
#include <limits>

#include <gmock/gmock.h>

#include "tests/unit/livox/sensor_link_fixture.hpp"

namespace clearway::core::livox {
namespace {

using testing::HasSubstr;
using testing::Not;

class SensorLinkStatesTest : public SensorLinkFixture {
 protected:
  // Answers to `code` say no, with this result.
  void Refuse(CommandCode code, std::uint8_t result) {
    cable_ = [=](Frame& frame) {
      if (!frame.to_sensor && frame.code == code) frame.body = PackByte(result);
      return true;
    };
  }
};

struct Setting {
  CommandCode code;
  const char* text;
};
class SensorLinkSettingTest : public SensorLinkStatesTest,
                              public testing::WithParamInterface<Setting> {};

TEST_P(SensorLinkSettingTest, ASettingThatIsRefusedIsToldPreventsNoPointsAndIsAskedAgain) {
  Refuse(GetParam().code, 5);

  RunFor(5 * kSecond_us);
  EXPECT_EQ(link_->state(), LinkState::kSampling);
  EXPECT_EQ(Report().health, Health::kDegraded);
  EXPECT_EQ(Text(), std::string("takes no: ") + GetParam().text);
  EXPECT_TRUE(HasEvent("(result 5)"));
  EXPECT_TRUE(sensor_->sampling(now_us_).has_value());
  const int asked = CountSent(GetParam().code);

  cable_ = {};
  RunFor(SensorLink::kSettingAgain_us + kSecond_us);

  EXPECT_EQ(Text(), "samples");
  EXPECT_EQ(CountSent(GetParam().code), asked + 1);
}

TEST_P(SensorLinkSettingTest, ASettingThatIsNotAnsweredIsToldAndPreventsNoPoints) {
  cable_ = [](const Frame& frame) { return frame.to_sensor || frame.code != GetParam().code; };

  RunFor(8 * kSecond_us);

  EXPECT_EQ(link_->state(), LinkState::kSampling);
  EXPECT_EQ(Text(), std::string("takes no: ") + GetParam().text);
  EXPECT_EQ(CountSent(GetParam().code), 10);
}

INSTANTIATE_TEST_SUITE_P(Settings,
                         SensorLinkSettingTest,
                         testing::Values(Setting{CommandCode::kDeviceInfo, "device information"},
                                         Setting{CommandCode::kCoordinates, "coordinate system"},
                                         Setting{CommandCode::kSetReturnMode, "set return mode"},
                                         Setting{CommandCode::kGetExtrinsic, "get extrinsic"}));

TEST_F(SensorLinkStatesTest, WhatIsRefusedWhileItStartsUpIsAskedAgainWhenItIsReady) {
  MakeSensor({.start_up_us = 5 * kSecond_us}, {.ip = kSensor});
  MakeLink({.return_mode = ReturnMode::kDual});
  cable_ = [this](Frame& frame) {
    const bool starts_up = sensor_->StateAt(now_us_) == WorkState::kInit;
    const bool is_it = frame.code == CommandCode::kSetReturnMode;
    if (starts_up && is_it && frame.to_sensor) frame.body = PackByte(77);  // Which it refuses.
    return true;
  };

  RunFor(7 * kSecond_us);

  EXPECT_EQ(Text(), "samples");
  EXPECT_EQ(sensor_->memory().return_mode, ReturnMode::kDual);
}

TEST_F(SensorLinkStatesTest, SamplingThatIsRefusedIsAskedForOnceASecond) {
  Refuse(CommandCode::kSampling, 1);
  RunFor(3 * kSecond_us);
  const int before = CountSent(CommandCode::kSampling);
  RunFor(10 * kSecond_us);
  const int asked = CountSent(CommandCode::kSampling) - before;

  EXPECT_EQ(link_->state(), LinkState::kStarting);
  EXPECT_NEAR(asked, 10, 1);
  cable_ = {};
  RunFor(2 * kSecond_us);
  EXPECT_EQ(Text(), "samples");
}

TEST_F(SensorLinkStatesTest, TellsHowFarTheSensorHasStartedUpAndThatItTakesTooLong) {
  MakeSensor({.start_up_us = 100 * kSecond_us}, {.ip = kSensor});

  RunFor(20 * kSecond_us);
  EXPECT_EQ(Report().health, Health::kWaiting);
  EXPECT_THAT(Text(), testing::AnyOf("starts up, 19 %", "starts up, 20 %"));
  EXPECT_EQ(link_->state(), LinkState::kStarting);

  RunFor(20 * kSecond_us);
  EXPECT_EQ(Report().health, Health::kFault);
  EXPECT_THAT(Text(), HasSubstr("switch it off and on, check its supply"));

  RunFor(62 * kSecond_us);
  EXPECT_EQ(Text(), "samples");
}

struct Sleep {
  std::uint8_t mode;
  const char* text;
};
class SensorLinkSleepTest : public SensorLinkStatesTest,
                            public testing::WithParamInterface<Sleep> {};

TEST_P(SensorLinkSleepTest, ASensorThatSleepsIsWoken) {
  Connect();
  SendAside(CommandCode::kMode, PackByte(GetParam().mode));
  bool is_told = false;
  RunUntil(
      [&] {
        is_told = is_told || Text().find(GetParam().text) != std::string::npos;
        return is_told;
      },
      2 * kSecond_us);
  RunFor(6 * kSecond_us);

  EXPECT_TRUE(is_told);
  EXPECT_EQ(Text(), "samples");
  EXPECT_EQ(link_->counts().connections, 1);
  EXPECT_LE(CountSent(CommandCode::kMode), 3);
}

INSTANTIATE_TEST_SUITE_P(Modes,
                         SensorLinkSleepTest,
                         testing::Values(Sleep{2, "is saving power; told to work normally"},
                                         Sleep{3, "is standing by; told to work normally"}));

TEST_F(SensorLinkStatesTest, AnErrorIsToldWithItsCauseAndPointsComeBackAfterIt) {
  Connect();
  sensor_->SetStatus({.motor = Severity::kError, .system = Severity::kError});
  RunFor(2 * kSecond_us);
  EXPECT_EQ(Report().health, Health::kFault);
  EXPECT_EQ(Text(), "is in error: its motor has failed: switch it off and on");

  sensor_->SetStatus({});
  RunFor(3 * kSecond_us);

  EXPECT_EQ(Text(), "samples");
}

struct Complaint {
  DeviceStatus status;
  const char* text;
};
class SensorLinkComplaintTest : public SensorLinkStatesTest,
                                public testing::WithParamInterface<Complaint> {};

TEST_P(SensorLinkComplaintTest, WhatTheSensorFindsWrongIsToldWhilePointsArrive) {
  Connect();
  sensor_->SetStatus(GetParam().status);
  RunFor(kSecond_us);
  EXPECT_EQ(link_->state(), LinkState::kSampling);
  EXPECT_EQ(Report().health, Health::kDegraded);
  EXPECT_THAT(Text(), HasSubstr(GetParam().text));

  sensor_->SetStatus({});
  RunFor(kSecond_us);

  EXPECT_EQ(Text(), "samples");
}

INSTANTIATE_TEST_SUITE_P(
    Complaints,
    SensorLinkComplaintTest,
    testing::Values(Complaint{{.temperature = Severity::kWarning}, "temperature is high or low"},
                    Complaint{{.voltage = Severity::kWarning}, "supply voltage"},
                    Complaint{{.motor = Severity::kWarning}, "motor"},
                    Complaint{{.window = Severity::kWarning}, "window is dirty"},
                    Complaint{{.window = Severity::kError}, "window is covered"}));

TEST_F(SensorLinkStatesTest, AStatusMessageIsHeardWithoutPoints) {
  Connect();
  has_points_ = false;
  Bytes body;
  Append(body, EncodeStatus({.window = Severity::kWarning}));

  link_->OnFrame({FrameType::kMessage, 12, 0, 7, body}, now_us_);

  EXPECT_EQ(link_->status().window, Severity::kWarning);
}

TEST_F(SensorLinkStatesTest, PointsThatDoNotComeAreToldAndAskedForOnceASecond) {
  Connect();
  has_points_ = false;
  const int before = CountSent(CommandCode::kSampling);
  RunFor(10 * kSecond_us);
  const int asked = CountSent(CommandCode::kSampling) - before;

  EXPECT_EQ(Report().health, Health::kFault);
  EXPECT_THAT(Text(), HasSubstr("answers, but sends no points for 10 s"));
  EXPECT_THAT(Text(), HasSubstr("firewall stop UDP to port 56001?"));
  EXPECT_NEAR(asked, 9, 1);
  EXPECT_EQ(link_->counts().connections, 1);

  has_points_ = true;
  RunFor(kSecond_us);
  EXPECT_EQ(Text(), "samples");
}

TEST_F(SensorLinkStatesTest, HeartbeatsThatAreRefusedDoNotKeepAConnection) {
  Connect();
  cable_ = [](Frame& frame) {
    if (!frame.to_sensor && frame.code == CommandCode::kHeartbeat) {
      frame.body = PackBody(HeartbeatAck{.result = 2, .state = WorkState::kNormal});
    }
    return true;
  };

  RunFor(4 * kSecond_us);

  EXPECT_GE(link_->counts().losses, 1);
  EXPECT_TRUE(HasEvent("refuses heartbeats (result 2)"));
}

class SensorLinkExtrinsicTest : public SensorLinkStatesTest {
 protected:
  const Extrinsic mounted_{.roll_deg = 0.0F,
                           .pitch_deg = 10.0F,
                           .yaw_deg = -90.0F,
                           .x_mm = 200,
                           .y_mm = -50,
                           .z_mm = 300};
};

TEST_F(SensorLinkExtrinsicTest, ASensorThatWasToldNothingIsNotComplainedAbout) {
  MakeLink({.extrinsic = mounted_});

  Connect();

  EXPECT_EQ(link_->stored_extrinsic(), Extrinsic{});
  EXPECT_FALSE(HasEvent("believes"));
}

TEST_F(SensorLinkExtrinsicTest, ADifferenceIsToldAndTheSensorIsLeftAsItIs) {
  Extrinsic other = mounted_;
  other.z_mm = 306;
  MakeSensor({}, {.ip = kSensor, .extrinsic = other});
  MakeLink({.extrinsic = mounted_});

  Connect();

  EXPECT_TRUE(HasEvent("believes to be mounted at x 200 y -50 z 306 mm"));
  EXPECT_TRUE(
      HasEvent("the configuration says x 200 y -50 z 300 mm, roll 0.0 pitch 10.0 yaw -90.0"));
  EXPECT_EQ(sensor_->memory().extrinsic, other);
}

TEST_F(SensorLinkExtrinsicTest, WhatDiffersByRoundingOrAWholeTurnIsTheSame) {
  Extrinsic other = mounted_;
  other.yaw_deg = 270.05F;
  other.x_mm = 195;
  MakeSensor({}, {.ip = kSensor, .extrinsic = other});
  MakeLink({.extrinsic = mounted_});

  Connect();

  EXPECT_FALSE(HasEvent("believes"));
}

TEST_F(SensorLinkExtrinsicTest, IsWrittenWhenThatIsAskedFor) {
  MakeLink({.extrinsic = mounted_, .write_extrinsic = true});

  Connect();

  EXPECT_EQ(sensor_->memory().extrinsic, mounted_);
  EXPECT_EQ(link_->stored_extrinsic(), mounted_);
}

TEST_F(SensorLinkExtrinsicTest, NumbersThatAreNoneAreToldAsSuch) {
  Extrinsic odd = mounted_;
  odd.roll_deg = std::numeric_limits<float>::quiet_NaN();
  odd.pitch_deg = std::numeric_limits<float>::infinity();
  odd.x_mm = std::numeric_limits<std::int32_t>::min();
  cable_ = [odd](Frame& frame) {
    if (!frame.to_sensor && frame.code == CommandCode::kGetExtrinsic) {
      frame.body = PackBody(ExtrinsicAck{.result = 0, .extrinsic = odd});
    }
    return true;
  };

  Connect();

  EXPECT_TRUE(HasEvent("roll ? pitch ?"));
}

}  // namespace
}  // namespace clearway::core::livox
