// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/graph_listener.hpp"
#include "tests/support/live_buses.hpp"
#include "tests/support/running_graph.hpp"
#include "tests/support/test_data.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::test {

/// A graph of real programs that plays a free room for ever, and an observer.
class RunningGraphTest : public testing::Test {
 protected:
  static constexpr double kTop_mps = 1.0;       // Of the vehicle in config/lab.xml.
  static constexpr double kDegraded_mps = 0.3;  // StopGuardConfig's default.
  static constexpr std::int64_t kSecond = 1'000'000;
  // The stated limit, and what a loaded machine may add on the way from the guard's clock to ours.
  static constexpr std::int64_t kLimit_us = 100'000;
  static constexpr std::int64_t kTransport_us = kIsSanitized ? 150'000 : 50'000;

  RunningGraphTest()
      : url_(TestUrl(NextPort())),
        listener_(url_),
        graph_({"--config", SourceFolder() / "config" / "lab.xml", "--lcm-url", url_},
               {"--input",
                SourceFolder() / "tests" / "support" / "free_room_scene.xml",
                "--scene-seconds",
                "2",
                "--loop"},
               folder_.path()) {}

  void StartWholeGraph() {
    graph_.StartAll();
    ASSERT_TRUE(AwaitWhole()) << Describe();
  }

  /// The graph as it should be: detections flow, top speed ahead is permitted. Waits for it.
  bool AwaitWhole() {
    const std::int64_t from_us = GraphListener::NowUs();
    return listener_.Await([&] {
      if (listener_.permits.empty() || listener_.detections.empty()) return false;
      const Arrived<drive_permit_t>& permit = listener_.permits.back();
      return permit.arrival_us > from_us && permit.message.reason == drive_permit_t::REASON_FREE &&
             permit.message.forward_mps == kTop_mps &&
             listener_.detections.back().arrival_us > from_us;
    });
  }

  bool AwaitReason(std::int8_t reason) {
    const std::size_t seen = listener_.permits.size();
    return listener_.Await([&] {
      return std::any_of(listener_.permits.begin() + static_cast<std::ptrdiff_t>(seen),
                         listener_.permits.end(),
                         [&](const auto& permit) { return permit.message.reason == reason; });
    });
  }

  static bool IsStop(const drive_permit_t& permit) {
    return permit.forward_mps == 0.0 && permit.backward_mps == 0.0 &&
           permit.turn_left_radps == 0.0 && permit.turn_right_radps == 0.0;
  }

  [[nodiscard]] std::int64_t SessionOf(const std::string& process) const {
    return listener_.statuses.at(process).message.session;
  }

  /// How the last permit and the states look, for a failure.
  [[nodiscard]] std::string Describe() const {
    std::string text = std::to_string(listener_.permits.size()) + " permits, " +
                       std::to_string(listener_.detections.size()) + " detections";
    if (!listener_.permits.empty()) text += ", " + listener_.permits.back().message.text;
    for (const auto& [process, status] : listener_.statuses) {
      text += "; " + process + ": " + status.message.text;
    }
    return text;
  }

  /// In the report of this test, and on its output.
  static void Report(const std::string& name, std::int64_t us) {
    const double ms = std::round(static_cast<double>(us) / 100.0) / 10.0;
    RecordProperty(name, std::to_string(ms));
    std::printf("    %s: %.1f\n", name.c_str(), ms);
  }

  TestFolder folder_;
  std::string url_;
  GraphListener listener_;
  RunningGraph graph_;

 private:
  static int NextPort() {
    static int port = 17200;
    return port++;
  }
};

}  // namespace clearway::test
