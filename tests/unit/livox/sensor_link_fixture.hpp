// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "common/core/livox/sensor_link.hpp"
#include "common/core/simulation/emulated_mid70.hpp"

namespace clearway::core::livox {

/// A link and an emulated MID-70 on one cable, in simulated time. The link is advanced only when it
/// says that something is due. Whatever a test does, handshakes keep their distance and commands
/// go to the sensor's port.
class SensorLinkFixture : public testing::Test {
 protected:
  static constexpr Ipv4 kHost = 0xC0A80132;    // 192.168.1.50
  static constexpr Ipv4 kSensor = 0xC0A80165;  // 192.168.1.101
  static constexpr std::int64_t kTick_us = 5'000;
  static constexpr std::int64_t kSecond_us = 1'000'000;

  struct Frame {
    std::int64_t at_us = 0;
    bool to_sensor = false;
    Endpoint to;
    FrameType type = FrameType::kCommand;
    CommandCode code = CommandCode::kBroadcast;
    std::uint16_t sequence = 0;
    Bytes body;
  };
  /// What becomes of a frame: false, it is lost. May change its body.
  using Cable = std::function<bool(Frame&)>;

  void RunFor(std::int64_t duration_us) {
    for (const std::int64_t end_us = now_us_ + duration_us; now_us_ < end_us;) Step();
  }

  /// Runs until it holds or `limit_us` is over; how long that took.
  std::int64_t RunUntil(const std::function<bool()>& holds, std::int64_t limit_us) {
    const std::int64_t begin_us = now_us_;
    while (!holds() && now_us_ - begin_us < limit_us) Step();
    return now_us_ - begin_us;
  }

  void Step() {
    now_us_ += kTick_us;
    for (const auto& out : sensor_->Advance(now_us_)) Carry(FrameOf(out.bytes, out.to, false));
    while (!under_way_.empty() && under_way_.front().at_us <= now_us_) {
      const Frame frame = std::move(under_way_.front());
      under_way_.pop_front();
      Arrive(frame);
    }
    if (has_points_ && sensor_->sampling(now_us_) && sensor_->host()->ip == kHost) {
      link_->OnData(sensor_->status_code(), now_us_);
      last_data_us_ = now_us_;
    }
    if (link_->NextDue() && now_us_ >= *link_->NextDue()) link_->Advance(now_us_);
    TakeFromLink();
  }

  void TakeFromLink() {
    for (const OutgoingFrame& out : link_->TakeOutgoing()) {
      EXPECT_EQ(out.to.port, kDevicePort);
      const Frame frame = FrameOf(out.bytes, out.to, true);
      EXPECT_NE(frame.sequence, 0);
      if (frame.code == CommandCode::kHandshake) {
        if (!handshakes_.empty()) {
          EXPECT_GE(now_us_ - handshakes_.back().at_us, SensorLink::kHandshakeGap_us);
        }
        handshakes_.push_back(frame);
      }
      sent_.push_back(frame);
      Carry(frame);
    }
    for (LinkEvent& event : link_->TakeEvents()) events_.push_back(std::move(event));
  }

  void Connect() {
    RunFor(3 * kSecond_us);
    ASSERT_EQ(link_->state(), LinkState::kSampling);
    ASSERT_EQ(Text(), "samples");
  }

  void MakeLink(const LinkConfig& config) {
    link_.emplace(config);
    handshakes_.clear();
  }
  void MakeSensor(const EmulatedMid70Config& config, const EmulatedMid70Memory& memory) {
    sensor_.emplace(config, memory, now_us_);
  }

  [[nodiscard]] LinkReport Report() const { return link_->Report(now_us_); }
  [[nodiscard]] std::string Text() const { return Report().text; }
  [[nodiscard]] int CountSent(CommandCode code) const {
    return static_cast<int>(std::count_if(
        sent_.begin(), sent_.end(), [&](const Frame& frame) { return frame.code == code; }));
  }
  [[nodiscard]] bool HasEvent(const std::string& part) const {
    return std::any_of(events_.begin(), events_.end(), [&](const LinkEvent& event) {
      return event.text.find(part) != std::string::npos;
    });
  }
  /// A frame of the host to the sensor that the link knows nothing of.
  void SendAside(CommandCode code, const Bytes& body, Ipv4 from = kHost) {
    (void)sensor_->Receive(
        {from, 55501}, PackCommand(FrameType::kCommand, 9999, code, body), now_us_);
  }

  std::int64_t now_us_ = 0;
  Cable cable_;
  std::int64_t delay_us_ = 0;  // Each way.
  bool has_points_ = true;
  Ipv4 announces_from_ = kSensor;
  std::optional<EmulatedMid70> sensor_{std::in_place,
                                       EmulatedMid70Config{},
                                       EmulatedMid70Memory{.ip = kSensor},
                                       0};
  std::optional<SensorLink> link_{std::in_place, LinkConfig{}};
  std::vector<Frame> sent_;  // By the link.
  std::vector<Frame> handshakes_;
  std::vector<LinkEvent> events_;
  std::optional<std::int64_t> last_data_us_;

 private:
  static Frame FrameOf(ByteView bytes, const Endpoint& to, bool to_sensor) {
    const ParsedFrame parsed = ParseFrame(bytes);
    EXPECT_TRUE(parsed.frame.has_value()) << DefectText(parsed.defect);
    return {.at_us = 0,
            .to_sensor = to_sensor,
            .to = to,
            .type = parsed.frame->type,
            .code = CodeOf(*parsed.frame),
            .sequence = parsed.frame->sequence,
            .body = {parsed.frame->data.begin(), parsed.frame->data.end()}};
  }

  void Carry(Frame frame) {
    frame.at_us = now_us_;
    if (frame.to_sensor) {
      sent_.back().at_us = now_us_;
      if (frame.code == CommandCode::kHandshake) handshakes_.back().at_us = now_us_;
    }
    if (cable_ && !cable_(frame)) return;
    if (delay_us_ == 0) {
      Arrive(frame);
      return;
    }
    frame.at_us += delay_us_;
    under_way_.push_back(std::move(frame));
  }

  void Arrive(const Frame& frame) {
    if (frame.to_sensor) {
      const Bytes bytes = PackCommand(frame.type, frame.sequence, frame.code, frame.body);
      for (const auto& out : sensor_->Receive({kHost, 55501}, bytes, now_us_)) {
        if (out.to.ip == kHost) Carry(FrameOf(out.bytes, out.to, false));
      }
    } else if (frame.code == CommandCode::kBroadcast) {
      link_->OnBroadcast({announces_from_, kDevicePort}, kHost, now_us_);
    } else {
      link_->OnFrame({frame.type, frame.sequence, SetOf(frame.code), IdOf(frame.code), frame.body},
                     now_us_);
    }
    if (!is_taking_) {
      is_taking_ = true;
      TakeFromLink();
      is_taking_ = false;
    }
  }

  std::deque<Frame> under_way_;
  bool is_taking_ = false;
};

}  // namespace clearway::core::livox
