// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/core/procman/sheriff.hpp"
#include "tests/support/memory_deputy.hpp"
#include "tests/support/reference_deputy.hpp"

namespace clearway::test {

inline core::procman::DeployedCommand Deployed(const std::string& id,
                                               const std::string& deputy,
                                               const std::string& exec = "run",
                                               const std::string& group = "",
                                               bool auto_respawn = false) {
  core::procman::DeployedCommand command;
  command.spec.id = id;
  command.spec.exec = exec;
  command.spec.group = group;
  command.spec.auto_respawn = auto_respawn;
  command.spec.stop_time_allowed_s = 0.5F;
  command.deputy = deputy;
  return command;
}

inline core::procman::Deployment Deploying(std::vector<core::procman::DeployedCommand> commands) {
  core::procman::Deployment deployment;
  deployment.file = "bed.pmd";
  deployment.commands = std::move(commands);
  return deployment;
}

inline core::procman::Target Everything() {
  return {};
}
inline core::procman::Target TheCommand(const std::string& id) {
  return {core::procman::Target::Kind::kCommand, id};
}
inline core::procman::Target TheGroup(const std::string& path) {
  return {core::procman::Target::Kind::kGroup, path};
}

/// Sheriffs and deputies, the reference's and our own, with a network between them that may lose
/// messages, in steps of 10 ms. Starts at a time that is no host's: only differences matter.
class SheriffBed {
 public:
  using Sheriff = core::procman::Sheriff;
  static constexpr std::int64_t kStepUs = 10'000;
  static constexpr std::int64_t kEpoch = 1'700'000'000'000'000;

  explicit SheriffBed(const std::vector<std::string>& deputies) {
    for (const std::string& id : deputies) deputies_.emplace(id, ReferenceDeputy(id));
  }

  /// Adds one of clearway's own deputies.
  MemoryDeputy& AddOwn(const std::string& id) {
    return *own_.emplace(id, std::make_unique<MemoryDeputy>(id)).first->second;
  }

  /// @return the sheriff, which lives as long as the bed.
  Sheriff& AddSheriff(const std::string& id,
                      Sheriff::Mode mode = Sheriff::Mode::kCommand,
                      Sheriff::Scope scope = Sheriff::Scope::kBus) {
    sheriffs_.push_back(std::make_unique<Sheriff>(id, mode, scope));
    for (auto& [name, deputy] : deputies_) pending_reports_.insert(name);
    for (auto& [name, deputy] : own_) pending_reports_.insert(name);
    return *sheriffs_.back();
  }
  void RemoveSheriff(const Sheriff& sheriff) {
    std::erase_if(sheriffs_, [&](const auto& each) { return each.get() == &sheriff; });
  }

  [[nodiscard]] ReferenceDeputy& deputy(const std::string& id) { return deputies_.at(id); }
  [[nodiscard]] std::int64_t now_us() const { return now_us_; }
  /// Orders that were sent, lost ones too.
  [[nodiscard]] const std::vector<core::procman::Orders>& orders() const { return orders_; }

  /// True loses the message.
  std::function<bool()> loses_orders = [] { return false; };
  std::function<bool()> loses_reports = [] { return false; };
  /// Deputies that nothing reaches and nothing leaves.
  std::set<std::string> cut_off;
  /// Whether our own deputies send PM_HEALTH before PM_INFO.
  bool health_first = false;
  /// Called after each step.
  std::function<void()> check = [] {};

  void Step() {
    now_us_ += kStepUs;
    for (auto& [id, deputy] : deputies_) deputy.Tick(now_us_);
    for (auto& [id, deputy] : own_) deputy->Tick(now_us_);
    SendReports();
    for (auto& sheriff : sheriffs_) SendOrders(*sheriff);
    check();
  }

  void Run(std::int64_t duration_us) {
    for (const std::int64_t end_us = now_us_ + duration_us; now_us_ < end_us;) Step();
  }

  /// Steps until it holds; false when it does not within `limit_us`.
  bool RunUntil(const std::function<bool()>& holds, std::int64_t limit_us = 10'000'000) {
    for (const std::int64_t end_us = now_us_ + limit_us; now_us_ < end_us;) {
      if (holds()) return true;
      Step();
    }
    return holds();
  }

  [[nodiscard]] core::procman::Status StatusOf(const Sheriff& sheriff,
                                               const std::string& id) const {
    const auto view = sheriff.View(id, now_us_);
    return view ? view->status : core::procman::Status::kUnknown;
  }

  /// How many copies run, on all deputies.
  [[nodiscard]] int Copies(const std::string& id) const {
    int copies = 0;
    for (const auto& [name, deputy] : deputies_) copies += deputy.IsUp(id) ? 1 : 0;
    return copies;
  }

 private:
  void SendReports() {
    for (auto& [id, deputy] : deputies_) {
      const bool is_due = deputy.IsReportDue(now_us_) || pending_reports_.erase(id) != 0;
      if (!is_due || cut_off.contains(id)) continue;
      for (auto& sheriff : sheriffs_) {
        if (!loses_reports()) sheriff->OnReport(deputy.Report(kEpoch + now_us_), now_us_);
      }
    }
    for (auto& [id, deputy] : own_) {
      const bool is_due = deputy->IsReportDue(now_us_) || pending_reports_.erase(id) != 0;
      if (!is_due || cut_off.contains(id)) continue;
      const std::int64_t utime = kEpoch + now_us_;
      for (auto& sheriff : sheriffs_) {
        if (health_first && !loses_reports()) {
          sheriff->OnHealth(deputy->Health(now_us_), utime, now_us_);
        }
        if (!loses_reports()) sheriff->OnReport(deputy->Report(utime), now_us_);
        if (!health_first && !loses_reports()) {
          sheriff->OnHealth(deputy->Health(now_us_), utime, now_us_);
        }
      }
    }
  }

  void SendOrders(Sheriff& sheriff) {
    for (const core::procman::Orders& orders : sheriff.OrdersDue(now_us_, kEpoch + now_us_)) {
      orders_.push_back(orders);
      for (auto& other : sheriffs_) other->OnForeignOrders(orders, now_us_);
      if (cut_off.contains(orders.deputy_id) || loses_orders()) continue;
      for (auto& [id, deputy] : deputies_) deputy.TakeOrders(orders, now_us_, kEpoch + now_us_);
      for (auto& [id, deputy] : own_) deputy->TakeOrders(orders, now_us_);
    }
  }

  std::map<std::string, ReferenceDeputy> deputies_;
  std::map<std::string, std::unique_ptr<MemoryDeputy>> own_;
  std::vector<std::unique_ptr<Sheriff>> sheriffs_;
  std::set<std::string> pending_reports_;  // A new sheriff asked for them.
  std::vector<core::procman::Orders> orders_;
  std::int64_t now_us_ = 5'000'000'000;
};

}  // namespace clearway::test
