// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <lcm/lcm-cpp.hpp>

#include "common/core/procman/orders.hpp"
#include "common/messages/procman.hpp"

namespace clearway::test {

/// One end of procman's protocol, by LCM alone: gives orders as it is told, keeps what it hears.
class ProcmanPeer {
 public:
  static constexpr std::int64_t kDeadline_us = 30'000'000;

  explicit ProcmanPeer(const std::string& url, std::string sheriff_id = "test:1:1");
  ProcmanPeer(const ProcmanPeer&) = delete;
  ProcmanPeer& operator=(const ProcmanPeer&) = delete;

  [[nodiscard]] static std::int64_t NowUs();

  /// The whole desired state of a deputy, once. Stamps grow, `clock_off_us` away from this host's.
  void Order(const std::string& deputy, const std::vector<core::procman::DesiredCommand>& commands);
  /// The same message byte by byte, as a network doubles it.
  void Send(const std::string& channel, const std::vector<std::byte>& bytes);
  void Discover(const std::string& transmitter_id, std::int64_t nonce);

  /// Listens until `done`; false when that does not come true within `timeout_us`.
  bool Await(const std::function<bool()>& done, std::int64_t timeout_us = kDeadline_us);
  bool AwaitDeputy(const std::string& deputy);
  /// The command runs (or not) with this run id.
  bool AwaitRunning(const std::string& deputy, const std::string& id, std::int32_t run_id);
  bool AwaitStopped(const std::string& deputy, const std::string& id);
  bool AwaitState(const std::string& deputy,
                  const std::string& id,
                  core::procman::CommandState state);

  /// As last heard; empty ones where nothing was.
  [[nodiscard]] core::procman::CommandReport Command(const std::string& deputy,
                                                     const std::string& id) const;
  [[nodiscard]] core::procman::CommandHealthReport HealthOf(const std::string& deputy,
                                                            const std::string& id) const;

  std::map<std::string, core::procman::DeputyReport> reports;
  std::map<std::string, core::procman::DeputyHealth> health;
  std::map<std::pair<std::string, std::string>, std::string> output;  ///< By deputy and command.
  std::map<std::string, std::vector<std::int64_t>> report_times_us;   ///< Of PM_INFO's arrivals.
  std::vector<procman_lcm::orders_t> orders;                          ///< Of all sheriffs.
  std::int64_t discoveries = 0;
  std::size_t largest_output_bytes = 0;
  std::int64_t clock_off_us = 0;

 private:
  void OnMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel);

  std::string sheriff_id_;
  lcm::LCM lcm_;
  std::int64_t last_utime_ = 0;
  std::map<std::string, messages::HealthAssembler> assemblers_;
};

/// A command that is to run.
[[nodiscard]] core::procman::DesiredCommand Wanted(const std::string& id,
                                                   const std::string& exec,
                                                   std::int32_t run_id = 1);
/// The same, to be stopped.
[[nodiscard]] core::procman::DesiredCommand Unwanted(core::procman::DesiredCommand command);

}  // namespace clearway::test
