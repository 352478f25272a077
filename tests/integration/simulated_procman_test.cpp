// SPDX-License-Identifier: BSD-3-Clause
// Our sheriff over our deputies in simulated time, with a bad wire between them.
#include <csignal>
#include <deque>
#include <map>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "common/messages/encoding.hpp"
#include "common/process/simulated_runtime.hpp"
#include "processes/procman_deputy/deputy_process.hpp"
#include "processes/procman_sheriff/sheriff_process.hpp"
#include "tests/support/relay_runtime.hpp"

namespace clearway {
namespace {

using core::procman::Sheriff;
using core::procman::Status;
using core::procman::Target;

constexpr std::int64_t kSecond = 1'000'000;
const Target kEverything{};

// Processes that are numbers and end 5 ms after any signal.
class NumberMachine final : public Machine {
 public:
  explicit NumberMachine(process::Runtime& runtime) : runtime_(runtime) {}

  void SetListener(Listener* listener) override { listener_ = listener; }
  core::procman::StartOutcome Start(const core::procman::CommandSpec& spec) override {
    core::procman::StartOutcome outcome;
    outcome.pid = ++last_pid_;
    running[outcome.pid] = spec.id;
    ++starts[spec.id];
    return outcome;
  }
  void Signal(std::int32_t pid, int signal) override {
    runtime_.After(5000, [this, pid, signal] {
      if (running.erase(pid) != 0 && listener_ != nullptr) listener_->OnExit(pid, signal);
    });
  }
  [[nodiscard]] std::int32_t CommandPidOf(std::int32_t pid) const override { return pid; }
  HostUse Sample() override { return {}; }
  [[nodiscard]] Use UseOf(std::int32_t /*pid*/) const override { return {}; }

  std::map<std::int32_t, std::string> running;
  std::map<std::string, int> starts;

 private:
  process::Runtime& runtime_;
  Listener* listener_ = nullptr;
  std::int32_t last_pid_ = 1000;
};

struct Host {
  Host(process::Runtime& runtime, const std::string& id) : machine(runtime) {
    DeputySettings settings;
    settings.id = id;
    settings.version = "test";
    settings.logs.folder = "/dev/null/nowhere";  // No log can be written: no command minds.
    deputy = std::make_unique<DeputyProcess>(
        runtime, settings, machine, [this](int status) { end_status = status; });
  }
  NumberMachine machine;
  std::unique_ptr<DeputyProcess> deputy;
  int end_status = -1;
};

class SimulatedProcmanTest : public testing::Test {
 protected:
  static core::procman::Deployment TwoHosts(int commands) {
    core::procman::Deployment deployment;
    deployment.file = "test.pmd";
    for (int i = 0; i < commands; ++i) {
      core::procman::CommandSpec spec;
      spec.id = "c" + std::to_string(i);
      spec.exec = "run";
      spec.group = "g";
      spec.auto_respawn = true;
      deployment.commands.push_back({.spec = spec, .deputy = i % 2 == 0 ? "a" : "b", .line = 1});
    }
    return deployment;
  }

  void RunFor(std::int64_t duration_us) { runtime_.RunUntil(runtime_.MonotonicUs() + duration_us); }

  [[nodiscard]] bool AllAre(SheriffProcess& sheriff, Status status) {
    for (const auto& command : sheriff.sheriff().Look(runtime_.MonotonicUs()).commands) {
      if (command.status != status) return false;
    }
    return true;
  }

  [[nodiscard]] std::size_t Running() const {
    return a_.machine.running.size() + b_.machine.running.size();
  }

  process::SimulatedRuntime runtime_{1'700'000'000 * kSecond, {}};
  Host a_{runtime_, "a"};
  Host b_{runtime_, "b"};
};

TEST_F(SimulatedProcmanTest, WhatIsAskedComesTrueWithHalfOfAllOrdersLost) {
  std::mt19937 random(7);
  test::RelayRuntime wire(runtime_, "PM_ORDERS", [&random](auto) {
    return random() % 2 == 0 ? test::RelayRuntime::Deliveries{} : test::RelayRuntime::Deliveries{0};
  });
  RunFor(2 * kSecond);
  SheriffProcess sheriff(wire, {});
  sheriff.sheriff().Load(TwoHosts(10), runtime_.MonotonicUs());
  RunFor(kSecond);

  for (int round = 1; round <= 10; ++round) {
    sheriff.sheriff().Restart(kEverything, runtime_.MonotonicUs());
    sheriff.Update();
    RunFor(15 * kSecond);
    EXPECT_TRUE(AllAre(sheriff, Status::kRunning)) << round;
    EXPECT_EQ(Running(), 10U);
    for (const auto& [id, count] : a_.machine.starts) EXPECT_EQ(count, 2 * round - 1) << id;

    sheriff.sheriff().Stop(kEverything, runtime_.MonotonicUs());
    sheriff.Update();
    RunFor(15 * kSecond);
    EXPECT_TRUE(AllAre(sheriff, Status::kStopped)) << round;
    EXPECT_EQ(Running(), 0U);

    sheriff.sheriff().Start(kEverything, runtime_.MonotonicUs());
    sheriff.Update();
    RunFor(15 * kSecond);
    EXPECT_EQ(Running(), 10U);
  }
}

TEST_F(SimulatedProcmanTest, OrdersThatAreDoubledAndLateStartNothingTwice) {
  std::mt19937 random(8);
  test::RelayRuntime wire(runtime_, "PM_ORDERS", [&random](auto) {
    return test::RelayRuntime::Deliveries{0, static_cast<std::int64_t>(random() % 3'000'000)};
  });
  RunFor(2 * kSecond);
  SheriffProcess sheriff(wire, {});
  sheriff.sheriff().Load(TwoHosts(4), runtime_.MonotonicUs());
  RunFor(kSecond);

  for (int round = 1; round <= 20; ++round) {
    sheriff.sheriff().Restart(kEverything, runtime_.MonotonicUs());
    sheriff.Update();
    RunFor(static_cast<std::int64_t>(500'000 + random() % 2'000'000));

    EXPECT_EQ(a_.machine.starts["c0"], round);
    EXPECT_EQ(Running(), 4U);
  }
}

TEST_F(SimulatedProcmanTest, ASecondSheriffTakesOverAndRestartsNothing) {
  bool is_gone = false;
  test::RelayRuntime wire(runtime_, "PM_ORDERS", [&is_gone](auto) {
    return is_gone ? test::RelayRuntime::Deliveries{} : test::RelayRuntime::Deliveries{0};
  });
  RunFor(2 * kSecond);
  SheriffProcess first(wire, {});
  first.sheriff().Load(TwoHosts(4), runtime_.MonotonicUs());
  RunFor(kSecond);
  first.sheriff().Start(kEverything, runtime_.MonotonicUs());
  RunFor(3 * kSecond);
  EXPECT_TRUE(AllAre(first, Status::kRunning));
  is_gone = true;
  RunFor(60 * kSecond);
  EXPECT_EQ(Running(), 4U) << "nobody is there";

  SheriffProcess second(runtime_, {});
  second.sheriff().Load(TwoHosts(4), runtime_.MonotonicUs());
  RunFor(5 * kSecond);
  second.sheriff().Start(kEverything, runtime_.MonotonicUs());
  RunFor(5 * kSecond);

  EXPECT_TRUE(AllAre(second, Status::kRunning));
  for (const auto* host : {&a_, &b_}) {
    for (const auto& [id, count] : host->machine.starts) EXPECT_EQ(count, 1) << id;
  }
}

TEST_F(SimulatedProcmanTest, AMovedCommandEndsBeforeItStartsElsewhere) {
  RunFor(2 * kSecond);
  SheriffProcess sheriff(runtime_, {});
  core::procman::Deployment deployment = TwoHosts(2);
  sheriff.sheriff().Load(deployment, runtime_.MonotonicUs());
  RunFor(kSecond);
  sheriff.sheriff().Start(kEverything, runtime_.MonotonicUs());
  RunFor(3 * kSecond);
  ASSERT_EQ(a_.machine.running.size(), 1U);

  deployment.commands[0].deputy = "b";
  sheriff.sheriff().Load(deployment, runtime_.MonotonicUs());
  sheriff.sheriff().Start(kEverything, runtime_.MonotonicUs());
  sheriff.Update();
  bool had_two = false;
  for (int i = 0; i < 5000; ++i) {
    RunFor(1000);
    int copies = 0;
    for (const auto* host : {&a_, &b_}) {
      for (const auto& [pid, id] : host->machine.running) copies += id == "c0" ? 1 : 0;
    }
    had_two = had_two || copies > 1;
  }

  EXPECT_FALSE(had_two);
  EXPECT_EQ(a_.machine.running.size(), 0U);
  EXPECT_EQ(b_.machine.running.size(), 2U);
  EXPECT_EQ(b_.machine.starts["c1"], 1) << "who did not move was left alone";
}

}  // namespace
}  // namespace clearway
