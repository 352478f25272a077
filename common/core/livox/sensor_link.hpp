// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/core/livox/device_status.hpp"
#include "common/core/livox/driver_config.hpp"
#include "common/core/livox/link_report.hpp"

namespace clearway::core::livox {

/// What a link needs to know. Times and ports as in DriverConfig.
struct LinkConfig {
  std::uint16_t command_port = 55501;
  std::uint16_t data_port = 56001;
  std::uint16_t imu_port = 57001;
  std::int64_t heartbeat_us = 800'000;
  std::int64_t answer_timeout_us = 500'000;
  std::int64_t lost_after_us = 3'000'000;
  ReturnMode return_mode = ReturnMode::kFirst;
  Coordinates coordinates = Coordinates::kCartesian;
  Extrinsic extrinsic{};  ///< Where the sensor is mounted, as the sensor would keep it.
  bool write_extrinsic = false;
};

/// The host's side of the conversation with one sensor, from the handshake to the points. Nothing
/// is sent or waited for here: datagrams, times and what becomes due go in, datagrams and events
/// come out. Times are those of one monotonic clock [us].
///
/// The handshake is repeated with a back-off: quickly at first and after each broadcast, never
/// more often than every kHandshakeGap_us, at last every kLongestBackOff_us. Settings are asked for
/// one after the other, each repeated until it is answered; one that stays refused or unanswered is
/// given up for kSettingAgain_us and told in the report, so that a sensor that knows no such
/// setting still gives points. Only answered heartbeats keep a connection, points do not.
/// Time: O(1) each call. Thread safety: none.
class SensorLink {
 public:
  static constexpr std::int64_t kHandshakeGap_us = 200'000;
  static constexpr std::int64_t kLongestBackOff_us = 5'000'000;
  static constexpr std::int64_t kSettingAgain_us = 10'000'000;
  /// Several connections in a row that are shorter: somebody else takes the sensor.
  static constexpr std::int64_t kShortConnection_us = 10'000'000;

  explicit SensorLink(const LinkConfig& config);

  /// A sensor is believed to be at this address; `host_ip` is where it is to answer. Begins with
  /// the handshake when no address was known; else only the newest `host_ip` is kept.
  void Offer(const Endpoint& sensor, Ipv4 host_ip, std::int64_t now_us);

  /// The sensor announces itself from there. Connects, or, where a connection was believed in,
  /// finds out whether the sensor was restarted, and connects anew. Another address than the known
  /// one is followed unless the known one is alive.
  void OnBroadcast(const Endpoint& from, Ipv4 host_ip, std::int64_t now_us);

  /// A control frame from the sensor's address.
  void OnFrame(const ControlFrame& frame, std::int64_t now_us);

  /// A data packet from the sensor's address, with this status code.
  void OnData(std::uint32_t status_code, std::int64_t now_us) {
    last_data_us_ = now_us;
    status_code_ = status_code;
  }

  /// Does what is due.
  void Advance(std::int64_t now_us);
  /// When Advance() should be called at the latest; nothing while there is nothing to wait for.
  [[nodiscard]] std::optional<std::int64_t> NextDue() const;

  /// Says goodbye to the sensor, as far as it is spoken to; nothing more will happen.
  void Close();

  /// Datagrams to send, in order.
  [[nodiscard]] std::vector<OutgoingFrame> TakeOutgoing() { return std::exchange(outgoing_, {}); }
  [[nodiscard]] std::vector<LinkEvent> TakeEvents() { return std::exchange(events_, {}); }

  [[nodiscard]] LinkState state() const;
  /// Whether the sensor at this link's address has been connected to: its points are welcome.
  [[nodiscard]] bool accepts_data() const { return is_proven_; }
  /// The known address; nothing while searching.
  [[nodiscard]] std::optional<Endpoint> address() const { return address_; }
  [[nodiscard]] const LinkCounts& counts() const { return counts_; }
  /// Of the present or last connection; nothing until it is told.
  [[nodiscard]] std::optional<std::array<std::uint8_t, 4>> firmware() const { return firmware_; }
  /// The newest status code of heartbeats, status messages and data packets.
  [[nodiscard]] DeviceStatus status() const { return DecodeStatus(status_code_); }
  /// Where the sensor itself believes to be mounted; nothing until it is told.
  [[nodiscard]] std::optional<Extrinsic> stored_extrinsic() const { return stored_extrinsic_; }

  /// In the user's words. While searching the text is empty: who looks for sensors knows more.
  [[nodiscard]] LinkReport Report(std::int64_t now_us) const;

 private:
  enum class Phase : std::uint8_t { kSearching, kHandshaking, kConnected, kClosed };
  enum class Outcome : std::uint8_t { kPending, kDone, kGivenUp };

  // A command of a connection, in the order in which they are sent.
  struct Step {
    CommandCode code = CommandCode::kDeviceInfo;
    Bytes body;
    Outcome outcome = Outcome::kPending;
    std::uint16_t sequence = 0;  // The same for all repeats, so that any answer will do.
    int unanswered = 0;          // Sent since the last answer.
    int refusals = 0;
    std::uint8_t result = 0;   // Of the last refusal.
    std::int64_t next_us = 0;  // Not to be sent before.
  };
  // Places in steps_.
  enum StepIndex : std::size_t {
    kInfoStep,
    kCoordinatesStep,
    kReturnModeStep,
    kExtrinsicStep,
    kModeStep,  // Only for a sensor that stands by.
    kSamplingStep,
    kNumSteps
  };
  static constexpr std::size_t kNumSettings = kModeStep;

  void BeginHandshake(std::int64_t now_us);
  void SendHandshake(std::int64_t now_us);
  void OnHandshakeAck(const ControlFrame& frame, std::int64_t now_us);
  void Connected(std::int64_t now_us);
  void BroadcastWhileConnected(const Endpoint& from, std::int64_t now_us);
  [[nodiscard]] bool IsAlive(std::int64_t now_us) const;
  void Reconnect(LinkEvent::Kind why, std::string text, std::int64_t now_us);
  void AdvanceConnection(std::int64_t now_us);
  void JudgeSuspicion(std::int64_t now_us);
  void SendHeartbeat(std::int64_t now_us);
  void OnHeartbeatAck(const ControlFrame& frame, std::int64_t now_us);
  void OnWorkState(WorkState state, std::int64_t now_us);
  void OnStepAck(Step& step, const ControlFrame& frame, std::int64_t now_us);
  void TakeAnswer(const Step& step, const ControlFrame& frame, std::int64_t now_us);
  void TakeExtrinsic(const ControlFrame& frame);
  void RefuseStep(Step& step, std::uint8_t result, std::int64_t now_us);
  void AskAgain(std::int64_t now_us);
  [[nodiscard]] std::optional<std::size_t> CurrentStep() const;
  [[nodiscard]] bool SettingsPending() const;
  void SendStep(Step& step, std::int64_t now_us);
  void Send(FrameType type, std::uint16_t sequence, CommandCode code, ByteView body, Endpoint to);
  void Tell(LinkEvent::Kind kind, std::string text);
  [[nodiscard]] std::uint16_t NextSequence();
  [[nodiscard]] Endpoint CommandAddress() const { return {address_->ip, kDevicePort}; }
  [[nodiscard]] std::int64_t HeartbeatInterval() const;

  [[nodiscard]] LinkReport ReportHandshake(std::int64_t now_us) const;
  [[nodiscard]] LinkReport ReportSetUp(std::int64_t now_us) const;
  [[nodiscard]] LinkReport ReportSampling(std::int64_t now_us) const;
  [[nodiscard]] std::string GivenUpText() const;

  LinkConfig config_;
  Phase phase_ = Phase::kSearching;
  std::optional<Endpoint> address_;
  Ipv4 host_ip_ = kAnyIpv4;
  std::uint16_t last_sequence_ = 0;
  std::vector<OutgoingFrame> outgoing_;
  std::vector<LinkEvent> events_;
  LinkCounts counts_;

  // Handshake.
  std::uint16_t handshake_sequence_ = 0;
  int handshakes_in_row_ = 0;  // Since the last broadcast.
  int unanswered_handshakes_ = 0;
  std::optional<std::uint8_t> handshake_refusal_;
  std::optional<std::int64_t> last_handshake_us_;
  std::int64_t next_handshake_us_ = 0;
  std::int64_t handshaking_since_us_ = 0;
  std::optional<std::int64_t> last_broadcast_us_;

  // Connection.
  bool is_proven_ = false;
  std::array<Step, kNumSteps> steps_{};
  std::int64_t connected_us_ = 0;
  std::deque<std::uint16_t> heartbeats_;  // Sequences that may still be answered.
  std::int64_t next_heartbeat_us_ = 0;
  std::int64_t last_ack_us_ = 0;
  std::optional<std::uint8_t> heartbeat_refusal_;
  WorkState work_state_ = WorkState::kUnknown;
  std::int64_t work_state_since_us_ = 0;
  std::uint32_t init_progress_ = 0;
  std::uint32_t status_code_ = 0;
  bool is_sampling_ = false;
  std::int64_t sampling_since_us_ = 0;
  std::optional<std::int64_t> last_data_us_;
  std::optional<std::int64_t> suspected_us_;  // A broadcast came while points did, too.
  std::int64_t settings_again_us_ = 0;
  std::optional<Ipv4> twin_;  // Announces itself with the same code.
  int short_connections_ = 0;
  std::optional<std::array<std::uint8_t, 4>> firmware_;
  std::optional<Extrinsic> stored_extrinsic_;
};

}  // namespace clearway::core::livox
