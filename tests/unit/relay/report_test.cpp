// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/report.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/unit/relay/frame_maker.hpp"

namespace clearway::relay {
namespace {

TEST(ReportTest, ItIsOneLineWithRatesOverTheInterval) {
  Hub hub({"robot", "laptop"}, {}, [](std::size_t, auto) { return true; });
  hub.Follow(ParseCommand("delay-ms 1.5 laptop:robot"));
  const Bytes frame = OneFrame(SmallMessage("A", 100));
  for (int i = 0; i < 4; ++i) hub.OnPacket(0, frame, 0);
  hub.OnPacket(1, Bytes(60), 0);

  const std::string text = FormatStatistics(hub, {0, 9}, 2.0);

  EXPECT_EQ(text.find('\n'), std::string::npos);
  const auto report = nlohmann::json::parse(text);
  const auto& channel = report["channels"][0];
  EXPECT_EQ(report["channels"].size(), 1U);
  EXPECT_EQ(channel["from"], "robot");
  EXPECT_EQ(channel["channel"], "A");
  EXPECT_EQ(channel["udp_port"], 7667);
  EXPECT_EQ(channel["messages"], 4);
  EXPECT_EQ(channel["bytes"], 4 * frame.size());
  EXPECT_EQ(channel["largest_message_bytes"], 100);
  EXPECT_EQ(channel["messages_per_s"], 2.0);
  const double expected_mbit_per_s = static_cast<double>(4 * frame.size()) * 8.0 / 1e6 / 2.0;
  EXPECT_NEAR(channel["mbit_per_s"].get<double>(), expected_mbit_per_s, 1e-9);
  EXPECT_NEAR(report["ports"][0]["in_mbit_per_s"].get<double>(), expected_mbit_per_s, 1e-9);
  EXPECT_EQ(report["ports"][1]["in_other_frames"], 1);
  EXPECT_EQ(report["ports"][1]["kernel_dropped_frames"], 9);
  EXPECT_EQ(report["directions"][0]["delivered_frames"], 4);
  EXPECT_EQ(report["directions"][1]["delay_ms"], 1.5);
  EXPECT_EQ(report["delayed_frames"], 1);
  EXPECT_EQ(report["delayed_bytes"], 60);
}

TEST(ReportTest, AnyChannelNameGivesSoundJson) {
  Hub hub({"a", "b"}, {}, [](std::size_t, auto) { return true; });
  hub.OnPacket(0, OneFrame(SmallMessage("\xff\"\n\x01", 1)), 0);

  const std::string text = FormatStatistics(hub, {0, 0}, 0.0);

  EXPECT_TRUE(nlohmann::json::accept(text)) << text;
  EXPECT_EQ(text.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace clearway::relay
