// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <list>
#include <span>
#include <string>

#include "common/process/buses_config.hpp"

// LCM's C structs, so that its headers stay out of ours.
struct _lcm_t;
struct _lcm_recv_buf_t;

namespace clearway::process {

enum class MissingNetwork;

/// The address as LCM takes it, with the buffer that the kernel will grant.
[[nodiscard]] std::string FullUrl(const BusConfig& config);

/// One LCM object. Handlers may throw: the exception is kept while LCM's C code unwinds and leaves
/// through HandleOne().
class LcmConnection {
 public:
  using BytesHandler = std::function<void(std::span<const std::byte>)>;

  /// Throws std::runtime_error when it cannot be opened and is not to wait.
  LcmConnection(const BusConfig& config, MissingNetwork missing_network);
  ~LcmConnection();
  LcmConnection(const LcmConnection&) = delete;
  LcmConnection& operator=(const LcmConnection&) = delete;

  /// Whether the network took it. Until the first message has gone out a failure is thrown: what
  /// cannot send at all is not set up. Later the network may come and go.
  bool Publish(const std::string& channel, std::span<const std::byte> bytes);

  /// `channel` is taken literally (LCM itself takes a regular expression).
  void Subscribe(const std::string& channel, BytesHandler handler);

  /// Handles one waiting message, if there is one; tells whether there was.
  bool HandleOne();

  [[nodiscard]] bool is_open() const { return lcm_ != nullptr; }
  [[nodiscard]] const std::string& url() const { return full_url_; }

  /// Why it is not open; empty: it is.
  [[nodiscard]] const std::string& problem() const { return problem_; }

  /// For who waits for the network, now and then: opens what is not open yet, and opens anew when
  /// multicast now leaves by another address than it did when memberships were taken. True when it
  /// was opened. Not from within a handler.
  bool KeepOpen();

  /// Readable while messages wait; -1 before the first Subscribe().
  [[nodiscard]] int file_descriptor() const { return file_descriptor_; }

  /// Receive buffer that the kernel granted to this connection's socket; -1 before Subscribe().
  [[nodiscard]] std::int64_t ReceiveBufferBytes() const;

 private:
  struct Subscription {
    LcmConnection* connection;
    std::string channel;
    BytesHandler handler;
  };
  bool Open();
  void Close();
  bool SubscribeInLcm(Subscription& subscription);
  static void OnMessage(const ::_lcm_recv_buf_t* buffer, const char* channel, void* user);

  BusConfig config_;
  std::string full_url_;
  bool may_wait_;
  std::string problem_;
  std::string source_address_;  // By which multicast leaves; empty: no way.
  ::_lcm_t* lcm_ = nullptr;
  int file_descriptor_ = -1;
  bool has_sent_ = false;
  std::list<Subscription> subscriptions_;  // A list: LCM keeps pointers to its elements.
  std::exception_ptr handler_error_;
  std::chrono::steady_clock::time_point next_try_;
};

}  // namespace clearway::process
