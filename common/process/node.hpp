// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/core/scan/sequence_tracker.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "common/process/processing_times.hpp"
#include "common/process/runtime.hpp"

namespace clearway::process {

/// Who a process is, as its status tells.
struct Identity {
  std::string process;        ///< Name, e.g. "preprocessor".
  std::string version;        ///< Of the program.
  std::string config_digest;  ///< Of the effective configuration.
};

/// What a process is doing, as its status tells.
struct State {
  std::int8_t code = status_t::STATE_STARTING;  ///< status_t::STATE_*.
  bool ready = false;                           ///< Others may rely on it.
  std::string text;                             ///< In words.
  friend bool operator==(const State&, const State&) = default;
};

/// A process's end of the graph: typed channels with session, sequence numbers and their gaps,
/// paced bursts, counts, and the status message at 1 Hz and on change.
class Node {
 public:
  /// Publishes the first status at once.
  Node(Runtime& runtime, Identity identity, messages::Channel<status_t> status_channel);
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  [[nodiscard]] Runtime& runtime() { return runtime_; }
  [[nodiscard]] std::int64_t session() const { return session_; }

  /// Calls `handler` with each message of the channel that can be decoded; others are counted as
  /// invalid. Where the type has session and sequence, gaps, duplicates and second publishers are
  /// counted (by sensor, where it has one).
  template <typename Message>
  void Subscribe(const messages::Channel<Message>& channel,
                 std::function<void(const Message&)> handler) {
    runtime_.Subscribe(channel.bus,
                       channel.name,
                       [this, name = std::string(channel.name), handler = std::move(handler)](
                           std::span<const std::byte> bytes) {
                         const std::optional<Message> message = messages::Decode<Message>(bytes);
                         if (!message) {
                           ++invalid_;
                           return;
                         }
                         NoteReceived();
                         if constexpr (requires { message->session; }) {
                           Track(StreamOf(name, *message), message->session, message->sequence);
                         }
                         handler(*message);
                       });
  }

  /// Sends a message now. Fills session and sequence where the type has them.
  template <typename Message>
  void Publish(const messages::Channel<Message>& channel, Message message) {
    Number(channel.name, message);
    Send({channel.bus, channel.name, messages::Encode(message), 0});
  }

  /// Sends the slices of one burst in order, each the bus's burst interval after the one before.
  /// The first goes at once when nothing is under way. When more than a few bursts of this
  /// channel wait, the oldest is given up and counted as dropped: old scans do not queue up.
  template <typename Message>
  void PublishBurst(const messages::Channel<Message>& channel, std::vector<Message> burst) {
    DropOldBursts(channel.name);
    ++burst_id_;
    for (Message& message : burst) {
      Number(channel.name, message);
      queue_.push_back({channel.bus, channel.name, messages::Encode(message), burst_id_});
    }
    if (!pump_running_) SendNextOfQueue();
  }

  /// Says what the process is doing; a change is published at once.
  void SetState(const State& state);

  /// Publishes the status now; also the last word of a process that stops.
  void RefreshAndPublishStatus();

  /// Called before each periodic status, so that the state is current.
  void BeforeStatus(std::function<void()> refresh) { refresh_ = std::move(refresh); }

  /// One unit of work took this long.
  void AddProcessingTime(std::int64_t duration_us) { times_.Add(duration_us); }

  void CountInvalid() { ++invalid_; }
  void CountDropped(std::int64_t count) { dropped_ += count; }

  /// Sets a counter of the status; names are lower_snake.
  void SetCounter(const std::string& name, std::int64_t value) { counters_[name] = value; }

  /// Time since the newest input [us]; -1 when there was none yet.
  [[nodiscard]] std::int64_t InputAgeUs() const;

 private:
  struct Outgoing {
    messages::BusId bus;
    std::string channel;
    std::vector<std::byte> bytes;
    std::int64_t burst;  // 0: alone.
  };

  // What is numbered together: a channel or, where the type names a sensor or a client, that one
  // on it.
  template <typename Message>
  static std::string StreamOf(const std::string& channel, const Message& message) {
    if constexpr (requires { message.sensor; }) {
      return channel + '/' + message.sensor;
    } else if constexpr (requires { message.client; }) {
      return channel + '/' + message.client;
    } else {
      return channel;
    }
  }

  template <typename Message>
  void Number(const std::string& channel, Message& message) {
    if constexpr (requires { message.session; }) {
      message.session = session_;
      message.sequence = next_sequence_[StreamOf(channel, message)]++;
    }
  }

  void NoteReceived();
  void Track(const std::string& stream, std::int64_t session, std::int64_t sequence);
  void Send(const Outgoing& outgoing);
  void DropOldBursts(const std::string& channel);
  void SendNextOfQueue();
  void PublishStatus();

  Runtime& runtime_;
  Identity identity_;
  messages::Channel<status_t> status_channel_;
  std::int64_t session_;
  State state_;
  std::function<void()> refresh_;
  std::map<std::string, std::int64_t> next_sequence_;
  std::map<std::string, core::SequenceTracker> trackers_;
  std::map<std::string, std::int64_t> counters_;
  std::deque<Outgoing> queue_;
  std::int64_t burst_id_ = 0;
  std::int64_t burst_under_way_ = 0;
  bool pump_running_ = false;
  ProcessingTimes times_;
  std::int64_t received_ = 0;
  std::int64_t published_ = 0;
  std::int64_t dropped_ = 0;
  std::int64_t invalid_ = 0;
  std::int64_t last_input_us_ = -1;
};

}  // namespace clearway::process
