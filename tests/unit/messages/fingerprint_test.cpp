// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <string>

#include <gtest/gtest.h>
#include <procman_lcm/cmd_desired_t.hpp>
#include <procman_lcm/cmd_status_t.hpp>
#include <procman_lcm/cmd_t.hpp>

#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"

namespace clearway::messages {
namespace {

// The reference procman's fingerprints: equal ones mean that the types are equal on the wire.
TEST(FingerprintTest, ProcmanTypesAreThoseOfTheReference) {
  EXPECT_EQ(static_cast<std::uint64_t>(procman_lcm::cmd_t::getHash()), 0x2277f449a855d330U);
  EXPECT_EQ(static_cast<std::uint64_t>(procman_lcm::cmd_desired_t::getHash()), 0xb2a6c7a09ba54539U);
  EXPECT_EQ(static_cast<std::uint64_t>(procman_lcm::cmd_status_t::getHash()), 0xa8e0208786cf86e3U);
  EXPECT_EQ(static_cast<std::uint64_t>(procman_lcm::deputy_info_t::getHash()), 0x8876aeb040efd01fU);
  EXPECT_EQ(static_cast<std::uint64_t>(procman_lcm::orders_t::getHash()), 0xd343f45b171ab855U);
  EXPECT_EQ(static_cast<std::uint64_t>(procman_lcm::output_t::getHash()), 0x8efa5caf5da01eb3U);
  EXPECT_EQ(static_cast<std::uint64_t>(procman_lcm::discovery_t::getHash()), 0xb1c83182bed74b95U);
}

TEST(FingerprintTest, AnOrderEncodesToTheGoldenVector) {
  procman_lcm::orders_t orders;
  orders.utime = 1;
  orders.deputy_id = "d";
  orders.sheriff_id = "s";
  orders.ncmds = 1;
  orders.cmds.resize(1);
  orders.cmds[0].cmd = {"a", "x y", "g", 1, 2, 7.0F};
  orders.cmds[0].desired_runid = 3;
  orders.cmds[0].force_quit = 0;

  std::string hex;
  for (const std::byte b : Encode(orders)) {
    constexpr char kDigits[] = "0123456789abcdef";
    hex += kDigits[std::to_integer<unsigned>(b) >> 4];
    hex += kDigits[std::to_integer<unsigned>(b) & 15U];
  }

  EXPECT_EQ(hex,
            "d343f45b171ab855"
            "0000000000000001"
            "000000026400"
            "000000027300"
            "00000001"
            "000000026100"
            "0000000478207900"
            "000000026700"
            "01"
            "02"
            "40e00000"
            "00000003"
            "00");
}

// utime, pos[3], vel[3], orientation[4], rotation_rate[3], accel[3] behind the fingerprint.
TEST(FingerprintTest, PoseHasTheMembersOfLibbotsPose) {
  EXPECT_EQ(pose_t{}.getEncodedSize(), 8 + 8 + (3 + 3 + 4 + 3 + 3) * 8);
}

}  // namespace
}  // namespace clearway::messages
