// SPDX-License-Identifier: BSD-3-Clause
#include "processes/livox_driver/heard_sensors.hpp"

#include <gmock/gmock.h>

namespace clearway {
namespace {

using core::livox::DeviceType;
using core::livox::LidarConfig;
using testing::HasSubstr;

constexpr std::int64_t kSecond = 1'000'000;

core::Endpoint At(int last_byte) {
  return {0xC0A80100U + static_cast<core::Ipv4>(last_byte), 65000};
}

LidarConfig Lidar(const std::string& code, const std::string& ip) {
  LidarConfig lidar;
  lidar.broadcast_code = code;
  lidar.ip = ip;
  return lidar;
}

class HeardSensorsTest : public testing::Test {
 protected:
  std::optional<std::size_t> Hear(HeardSensors& heard,
                                  const std::string& code,
                                  int last_byte,
                                  DeviceType type = DeviceType::kMid70) {
    return heard.Hear({code, type}, At(last_byte), now_us_).lidar;
  }

  std::int64_t now_us_ = 100 * kSecond;
};

TEST_F(HeardSensorsTest, FindsByCodeFirstThenByAddress) {
  HeardSensors heard({Lidar("", "192.168.1.101"), Lidar("B", ""), Lidar("C", "192.168.1.103")});

  EXPECT_EQ(Hear(heard, "A", 101), 0U);
  EXPECT_EQ(Hear(heard, "B", 101), 1U) << "a code says more than an address";
  EXPECT_EQ(Hear(heard, "C", 199), 2U) << "a sensor with another address than configured";
  EXPECT_EQ(Hear(heard, "D", 103), std::nullopt) << "another sensor at a configured address";
  EXPECT_EQ(heard.UnknownText(now_us_), "MID-70 D at 192.168.1.103");
}

TEST_F(HeardSensorsTest, TheOnlyOneIsChosenWhenNoOtherWasHeardForMoreThanABroadcastsPeriod) {
  HeardSensors heard({Lidar("", "")});
  EXPECT_EQ(Hear(heard, "A", 101), std::nullopt);
  now_us_ += kSecond;
  EXPECT_EQ(Hear(heard, "A", 101), std::nullopt);
  EXPECT_FALSE(heard.Choose(now_us_).has_value());

  now_us_ += HeardSensors::kDecide_us - kSecond;
  const auto choice = heard.Choose(now_us_);

  ASSERT_TRUE(choice.has_value());
  EXPECT_EQ(choice->lidar, 0U);
  EXPECT_EQ(choice->from, At(101));
  EXPECT_FALSE(heard.Choose(now_us_).has_value()) << "told once";
  EXPECT_EQ(Hear(heard, "A", 105), 0U) << "wherever it is from now on";
}

TEST_F(HeardSensorsTest, OfSeveralNoneIsChosenAndAllAreListed) {
  HeardSensors heard({Lidar("", "")});
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(Hear(heard, "A", 101), std::nullopt);
    EXPECT_EQ(Hear(heard, "B", 102), std::nullopt);
    EXPECT_FALSE(heard.Choose(now_us_).has_value());
    now_us_ += kSecond;
  }

  EXPECT_EQ(heard.ProblemOf(0, now_us_),
            "several sensors could be meant (MID-70 A at 192.168.1.101, MID-70 B at "
            "192.168.1.102): set livox_driver.lidar.broadcast_code to the right one");
}

TEST_F(HeardSensorsTest, WhenAllOthersAreSilentTheOneThatIsLeftIsChosen) {
  HeardSensors heard({Lidar("", "")});
  Hear(heard, "A", 101);
  Hear(heard, "B", 102);
  for (int i = 0; i < 4; ++i) {
    now_us_ += kSecond;
    Hear(heard, "B", 102);
  }

  ASSERT_TRUE(heard.Choose(now_us_).has_value());
  EXPECT_EQ(Hear(heard, "B", 102), 0U);
  EXPECT_EQ(heard.ProblemOf(0, now_us_), "");
}

// A connected sensor does not announce itself: its silence must not give its place away.
TEST_F(HeardSensorsTest, AnotherOneThatComesLaterDoesNotTakeThePlaceOfTheChosenOne) {
  HeardSensors heard({Lidar("", "")});
  Hear(heard, "A", 101);
  now_us_ += HeardSensors::kDecide_us;
  ASSERT_TRUE(heard.Choose(now_us_).has_value());

  for (int i = 0; i < 20; ++i) {
    now_us_ += kSecond;
    EXPECT_EQ(Hear(heard, "B", 102), std::nullopt);
    EXPECT_FALSE(heard.Choose(now_us_).has_value());
  }

  EXPECT_EQ(heard.UnknownText(now_us_), "MID-70 B at 192.168.1.102");
}

TEST_F(HeardSensorsTest, SensorsThatOthersMeanAreNoCandidates) {
  HeardSensors heard({Lidar("B", ""), Lidar("", "")});
  Hear(heard, "A", 101);
  Hear(heard, "B", 102);
  now_us_ += HeardSensors::kDecide_us;

  const auto choice = heard.Choose(now_us_);

  ASSERT_TRUE(choice.has_value());
  EXPECT_EQ(choice->lidar, 1U);
  EXPECT_EQ(choice->from, At(101));
}

TEST_F(HeardSensorsTest, OtherTypesAreNamedAndNeverUsed) {
  HeardSensors heard({Lidar("A", ""), Lidar("", "")});

  EXPECT_EQ(Hear(heard, "A", 101, DeviceType::kHorizon), std::nullopt);
  EXPECT_EQ(Hear(heard, "B", 102, DeviceType::kAvia), std::nullopt);
  EXPECT_EQ(Hear(heard, "C", 103, static_cast<DeviceType>(99)), std::nullopt);
  now_us_ += HeardSensors::kDecide_us;

  EXPECT_FALSE(heard.Choose(now_us_).has_value());
  EXPECT_EQ(heard.ProblemOf(0, now_us_),
            "is a Horizon A at 192.168.1.101; this driver speaks to MID-70s only");
  EXPECT_EQ(heard.ProblemOf(1, now_us_), "");
  EXPECT_EQ(heard.UnknownText(now_us_),
            "Horizon A at 192.168.1.101, Avia B at 192.168.1.102, unknown device C at "
            "192.168.1.103");
}

TEST_F(HeardSensorsTest, WhoIsSilentIsNotListed) {
  HeardSensors heard({Lidar("A", "")});
  Hear(heard, "B", 102);
  now_us_ += HeardSensors::kSilence_us + 1;

  EXPECT_EQ(heard.UnknownText(now_us_), "");
}

TEST_F(HeardSensorsTest, AFloodOfMadeUpCodesTakesNoMemoryAndHidesNobody) {
  HeardSensors heard({Lidar("A", "")});
  for (int i = 0; i < 10'000; ++i) {
    now_us_ += 100;
    Hear(heard, "X" + std::to_string(i), 7);
  }

  EXPECT_EQ(Hear(heard, "A", 101), 0U);
  EXPECT_LT(heard.UnknownText(now_us_).size(), HeardSensors::kMaxHeard * 40);
}

TEST_F(HeardSensorsTest, TellsWhoIsNew) {
  HeardSensors heard({Lidar("A", "")});

  EXPECT_TRUE(heard.Hear({"A", DeviceType::kMid70}, At(101), now_us_).is_new);
  EXPECT_FALSE(heard.Hear({"A", DeviceType::kMid70}, At(101), now_us_).is_new);
}

}  // namespace
}  // namespace clearway
