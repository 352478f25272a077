// SPDX-License-Identifier: BSD-3-Clause
// A link to a sensor that says anything at any time. Each step is one byte that says what happens
// and how much later, then what it needs; answers carry the sequence of what the link has sent, so
// that all its states are reached.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <vector>

#include "common/core/livox/sensor_link.hpp"

namespace {

using namespace clearway::core::livox;
using clearway::core::Endpoint;
using clearway::core::Ipv4;

void Require(bool holds) {
  if (!holds) std::abort();
}

class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : bytes_(data, size) {}
  [[nodiscard]] bool empty() const { return bytes_.empty(); }
  std::uint8_t Byte() {
    if (bytes_.empty()) return 0;
    const std::uint8_t value = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return value;
  }
  Bytes Take(std::size_t most) {
    const std::size_t count = std::min(most, bytes_.size());
    Bytes taken(count);
    std::transform(bytes_.begin(),
                   bytes_.begin() + static_cast<std::ptrdiff_t>(count),
                   taken.begin(),
                   [](std::uint8_t value) { return std::byte{value}; });
    bytes_ = bytes_.subspan(count);
    return taken;
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

class Conversation {
 public:
  explicit Conversation(const LinkConfig& config) : link_(config) {}

  void Step(Input& input) {
    constexpr std::int64_t kDelays_us[] = {
        0, 1, 20'000, 90'000, 250'000, 600'000, 3'500'000, 11'000'000};
    const std::uint8_t what = input.Byte();
    now_us_ += kDelays_us[what >> 5U];
    link_.Advance(now_us_);
    Check();
    const Endpoint sensor{Ipv4{0xC0A80165} + (input.Byte() & 1U), kDevicePort};
    switch (what & 7U) {
      case 0:
        link_.OnBroadcast(sensor, 0xC0A80132, now_us_);
        break;
      case 1:
        link_.Offer(sensor, 0xC0A80133, now_us_);
        break;
      case 2:
        link_.OnData(input.Byte(), now_us_);
        break;
      case 3:
        Frame(input, FrameType::kMessage);
        break;
      case 4:
        Frame(input, static_cast<FrameType>(input.Byte() % 3));
        break;
      case 5:
        Answer(input, input.Take(32));
        break;
      default:
        Answer(input, WellMade(input));
        break;
    }
    Check();
  }

  void Close() {
    link_.Close();
    Check();
    Require(link_.state() == LinkState::kClosed && !link_.NextDue() && !link_.accepts_data());
  }

 private:
  void Frame(Input& input, FrameType type) {
    const std::uint16_t sequence = input.Byte();
    const std::uint8_t set = input.Byte() & 1U;
    const std::uint8_t id = input.Byte();
    const Bytes body = input.Take(40);
    link_.OnFrame({type, sequence, set, id, body}, now_us_);
  }
  // Answers one of the newest commands, as real sensors do.
  void Answer(Input& input, const Bytes& body) {
    if (sent_.empty()) return;
    ControlFrame frame =
        sent_[sent_.size() - 1 - input.Byte() % std::min<std::size_t>(4, sent_.size())];
    frame.type = FrameType::kAck;
    frame.data = body;
    link_.OnFrame(frame, now_us_);
  }
  // A body of the length that one of the commands is answered with.
  static Bytes WellMade(Input& input) {
    switch (input.Byte() & 3U) {
      case 0:
        return PackByte(0);
      case 1:
        return PackBody(HeartbeatAck{.result = 0,
                                     .state = static_cast<WorkState>(input.Byte() % 6),
                                     .features = 0,
                                     .progress = input.Byte()});
      case 2:
        return PackBody(DeviceInfoAck{.result = 0, .firmware = {1, 2, 3, 4}});
      default:
        return PackBody(ExtrinsicAck{.result = 0, .extrinsic = {.yaw_deg = 90.0F}});
    }
  }

  void Check() {
    Collect();
    const LinkReport report = link_.Report(now_us_);
    Require(report.state == link_.state());
    Require(report.text.empty() == (report.state == LinkState::kSearching));
    Require(!link_.accepts_data() || link_.address().has_value());
    // What was due has been done: who waits for the next due time does not wait in a circle.
    link_.Advance(now_us_);
    Collect();
    Require(!link_.NextDue() || *link_.NextDue() > now_us_);
  }

  void Collect() {
    for (const OutgoingFrame& frame : link_.TakeOutgoing()) {
      const ParsedFrame parsed = ParseFrame(frame.bytes);
      Require(parsed.frame.has_value() && frame.to.port == kDevicePort);
      if (CodeOf(*parsed.frame) == CommandCode::kHandshake) {
        Require(!last_handshake_us_ ||
                now_us_ - *last_handshake_us_ >= SensorLink::kHandshakeGap_us);
        last_handshake_us_ = now_us_;
      }
      sent_.push_back(*parsed.frame);
      sent_.back().data = {};
    }
    for (const LinkEvent& event : link_.TakeEvents()) Require(!event.text.empty());
  }

  SensorLink link_;
  std::int64_t now_us_ = 1'000'000'000;
  std::vector<ControlFrame> sent_;
  std::optional<std::int64_t> last_handshake_us_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  LinkConfig config;
  config.write_extrinsic = (input.Byte() & 1U) != 0;
  Conversation conversation(config);
  while (!input.empty()) conversation.Step(input);
  conversation.Close();
  return 0;
}
