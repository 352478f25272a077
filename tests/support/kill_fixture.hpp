// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "common/core/guard/base_gate.hpp"
#include "tests/support/graph_listener.hpp"
#include "tests/support/live_buses.hpp"
#include "tests/support/running_graph.hpp"
#include "tests/support/test_data.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::test {

/// A graph of real programs that plays a free room for ever, and an observer.
class RunningGraphTest : public testing::Test {
 protected:
  static constexpr double kTop_mps = 1.0;       // Of the vehicle in config/lab_standing.xml.
  static constexpr double kDegraded_mps = 0.3;  // StopGuardConfig's default.
  static constexpr std::int64_t kSecond = 1'000'000;
  // The stated limit, and what a loaded machine may add on the way from the guard's clock to ours.
  static constexpr std::int64_t kLimit_us = 100'000;
  static constexpr std::int64_t kTransport_us = kIsSanitized ? 150'000 : 50'000;

  RunningGraphTest()
      : url_(TestUrl(NextPort())),
        listener_(url_),
        graph_(url_,
               {"--config", SourceFolder() / "config" / "lab_standing.xml", "--lcm-url", url_},
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

/// What is asked of a graph whose processes are killed or frozen.
class KillTest : public RunningGraphTest {
 protected:
  // From the last slice's arrival to the last permit to move that followed it.
  [[nodiscard]] std::int64_t MovedOnAfterTheLastSlice() const {
    const std::int64_t slice_us = listener_.slices.back().arrival_us;
    std::int64_t longest_us = 0;
    for (const auto& permit : listener_.permits) {
      if (!IsStop(permit.message)) longest_us = std::max(longest_us, permit.arrival_us - slice_us);
    }
    return longest_us;
  }

  // What the base may do at `time_us`, by all permits that had come by then.
  [[nodiscard]] bool MayTheBaseMove(std::int64_t time_us) const {
    core::BaseGate gate;
    for (const auto& permit : listener_.permits) {
      if (permit.arrival_us > time_us) break;
      const drive_permit_t& message = permit.message;
      gate.OnPermit({message.session,
                     message.sequence,
                     message.utime,
                     message.valid_us,
                     message.forward_mps,
                     message.backward_mps,
                     message.turn_left_radps,
                     message.turn_right_radps},
                    permit.arrival_us);
    }
    return gate.PermitState(time_us) == core::GateState::kValid;
  }

  // Of the permits that came in [from, to]: no one lets the vehicle go faster than `limit_mps`.
  void ExpectCapped(std::int64_t from_us, std::int64_t to_us, double limit_mps) const {
    for (const auto& permit : listener_.permits) {
      if (permit.arrival_us < from_us || permit.arrival_us > to_us) continue;
      EXPECT_LE(permit.message.forward_mps, limit_mps) << permit.message.text;
    }
  }

  // A permit to move rests on a slice that is not older than its limits allow: lateness and
  // silence each have one.
  void ExpectEveryPermitRestsOnAFreshSlice() const {
    std::map<std::pair<std::int64_t, std::int32_t>, std::int64_t> slice_us;
    std::size_t next = 0;
    for (const auto& permit : listener_.permits) {
      for (;
           next < listener_.slices.size() && listener_.slices[next].arrival_us <= permit.arrival_us;
           ++next) {
        const lidar_points_t& slice = listener_.slices[next].message;
        slice_us[{slice.scan_id, slice.slice_index}] = listener_.slices[next].arrival_us;
      }
      if (IsStop(permit.message)) continue;
      EXPECT_LE(permit.message.input_age_us, kLimit_us);
      const auto slice = slice_us.find({permit.message.slice_scan_id, permit.message.slice_index});
      if (slice == slice_us.end()) continue;  // Came before this test listened.
      EXPECT_LE(permit.arrival_us - slice->second, 2 * kLimit_us + kTransport_us);
    }
  }

  // The graph is whole again, with one session for the process that was started anew.
  void ExpectWholeAgainWithANewSession(const std::string& process, std::int64_t old_session) {
    const std::int64_t from_us = GraphListener::NowUs();
    graph_.Start(process);
    ASSERT_TRUE(AwaitWhole()) << Describe();
    Report("restart_to_whole_ms", GraphListener::NowUs() - from_us);
    ASSERT_TRUE(listener_.Await([&] { return SessionOf(process) != old_session; }));
    ExpectEveryPermitRestsOnAFreshSlice();
  }
};

}  // namespace clearway::test
