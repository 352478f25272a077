// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/device_status.hpp"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::core::livox {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(DeviceStatus, AllClearIsZero) {
  EXPECT_EQ(DecodeStatus(0), DeviceStatus{});
  EXPECT_EQ(EncodeStatus({}), 0U);
  EXPECT_EQ(WorstOf({}), Severity::kOk);
  EXPECT_THAT(Complaints({}), IsEmpty());
}

TEST(DeviceStatus, EachBitHasItsMeaning) {
  EXPECT_EQ(DecodeStatus(1U << 0U).temperature, Severity::kWarning);
  EXPECT_EQ(DecodeStatus(2U << 0U).temperature, Severity::kError);
  EXPECT_EQ(DecodeStatus(1U << 2U).voltage, Severity::kWarning);
  EXPECT_EQ(DecodeStatus(2U << 4U).motor, Severity::kError);
  EXPECT_EQ(DecodeStatus(1U << 6U).window, Severity::kWarning);
  EXPECT_TRUE(DecodeStatus(1U << 8U).firmware_abnormal);
  EXPECT_TRUE(DecodeStatus(1U << 9U).pps_present);
  EXPECT_TRUE(DecodeStatus(1U << 10U).near_end_of_life);
  EXPECT_TRUE(DecodeStatus(1U << 11U).fan_warning);
  EXPECT_TRUE(DecodeStatus(1U << 12U).self_heating);
  EXPECT_TRUE(DecodeStatus(1U << 13U).ptp_present);
  EXPECT_EQ(DecodeStatus(1U << 14U).time_sync, TimeSync::kPtp);
  EXPECT_EQ(DecodeStatus(4U << 14U).time_sync, TimeSync::kAbnormal);
  EXPECT_EQ(DecodeStatus(7U << 14U).time_sync, TimeSync::kAbnormal) << "not defined: not good";
  EXPECT_EQ(DecodeStatus(2U << 30U).system, Severity::kError);
}

TEST(DeviceStatus, ReservedBitsMeanNothing) {
  EXPECT_EQ(DecodeStatus(0x3FFE0000U), DeviceStatus{});
}

TEST(DeviceStatus, ComesBackFromItsCode) {
  std::mt19937 random(8);
  for (int i = 0; i < 10'000; ++i) {
    const auto status = DecodeStatus(static_cast<std::uint32_t>(random()));

    EXPECT_EQ(DecodeStatus(EncodeStatus(status)), status);
  }
}

TEST(DeviceStatus, ADirtyWindowIsNamedWithWhatToDo) {
  const DeviceStatus status = DecodeStatus(0x40000040);

  EXPECT_EQ(WorstOf(status), Severity::kWarning);
  EXPECT_THAT(Complaints(status), ElementsAre(HasSubstr("clean it")));
}

TEST(DeviceStatus, ASystemErrorWithoutAReasonIsToldAllTheSame) {
  const DeviceStatus status = DecodeStatus(2U << 30U);

  EXPECT_EQ(WorstOf(status), Severity::kError);
  EXPECT_THAT(Complaints(status), ElementsAre(HasSubstr("without a reason")));
}

// Whatever is wrong is told: a code that is not all right never leaves the user without a word.
TEST(DeviceStatus, WhateverIsNotWellIsTold) {
  for (unsigned bit = 0; bit < 32; ++bit) {
    const DeviceStatus status = DecodeStatus(1U << bit);

    EXPECT_EQ(Complaints(status).empty(), WorstOf(status) == Severity::kOk && bit != 16) << bit;
  }
}

}  // namespace
}  // namespace clearway::core::livox
