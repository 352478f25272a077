// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/procman/managed_command.hpp"
#include "common/core/procman/order_ledger.hpp"

namespace clearway::core::procman {

/// What came of an orders message.
enum class OrdersOutcome {
  kTaken,
  kForOther,  ///< For another deputy.
  kRepeated,  ///< The newest once more.
  kStale,     ///< Older than what this sheriff already said.
  kInvalid,   ///< An id is empty, doubled or too long, or there are more commands than a host runs.
  kShuttingDown,
};

/// All commands of one deputy: carries out orders, remembers them, ends in order. Knows no process,
/// no bus and no clock: CommandHost starts and signals, time is an argument [us, monotonic].
/// Not for several threads.
class Deputy {
 public:
  static constexpr std::size_t kMaxCommands = 1000;
  static constexpr std::size_t kMaxIdBytes = 1000;  ///< Of a command's or a sheriff's id.

  Deputy(std::string id,
         const RespawnConfig& respawn,
         const HealthConfig& health,
         CommandHost& host);

  /// Orders are the whole desired state: commands that they lack are stopped and forgotten.
  OrdersOutcome Take(const Orders& orders, std::int64_t now_us);

  /// Carries on with what an earlier life was told; these orders are nobody's.
  void Resume(const std::vector<DesiredCommand>& kept, std::int64_t now_us);

  void OnExit(std::int32_t pid, int wait_status, std::int64_t now_us);

  /// A status of the process `pid` on `channel`; others than that of a command are ignored.
  void OnStatus(const std::string& channel,
                std::int32_t pid,
                const StatusWord& word,
                std::int64_t now_us);

  void Tick(std::int64_t now_us);
  [[nodiscard]] std::optional<std::int64_t> NextDue() const;

  /// Stops everything, one command after the other, last started first, each within its stop time.
  void ShutDown(std::int64_t now_us);
  /// SIGKILL to whatever is left.
  void KillAll();
  [[nodiscard]] bool IsDone() const;

  [[nodiscard]] const std::string& id() const { return id_; }
  [[nodiscard]] const OrderLedger& ledger() const { return ledger_; }
  [[nodiscard]] bool has_orders() const { return has_orders_; }

  /// The command that this process belongs to; null when there is none.
  [[nodiscard]] const ManagedCommand* CommandOf(std::int32_t pid) const;

  [[nodiscard]] bool Knows(const std::string& command_id) const {
    return commands_.contains(command_id);
  }

  /// In the order of their ids. `Reports` are without what the machine knows.
  [[nodiscard]] std::vector<CommandReport> Reports() const;
  [[nodiscard]] std::vector<CommandHealthReport> Health(std::int64_t now_us) const;
  /// What a later life is to carry on with. @pre not shutting down.
  [[nodiscard]] std::vector<DesiredCommand> ToKeep() const;

 private:
  void Apply(const std::vector<DesiredCommand>& commands, std::int64_t now_us);
  void StopNext(std::int64_t now_us);

  std::string id_;
  RespawnConfig respawn_;
  HealthConfig health_;
  CommandHost& host_;
  OrderLedger ledger_;
  std::map<std::string, std::unique_ptr<ManagedCommand>> commands_;
  bool has_orders_ = false;
  bool is_shutting_down_ = false;
};

}  // namespace clearway::core::procman
