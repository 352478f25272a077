// SPDX-License-Identifier: BSD-3-Clause
// LiveRuntime over real LCM: exceptions, signals, timers.
#include "common/process/live_runtime.hpp"

#include <atomic>
#include <chrono>
#include <csignal>
#include <set>
#include <stdexcept>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include "tests/support/live_buses.hpp"
#include "tests/support/pump.hpp"

// After the others: <sched.h> needs _GNU_SOURCE, which libstdc++ sets.
#include <sched.h>

namespace clearway::process {
namespace {

using messages::BusId;
using test::TestBuses;

constexpr std::int64_t kSecond = 1'000'000;
constexpr std::int64_t kDeadline_us = 20 * kSecond;

const std::byte kByte{42};
const std::span<const std::byte> kMessage(&kByte, 1);

// Runs until `done`, publishing on A again and again: the first messages may come before the
// receiver listens. False when nothing has come of it by the deadline.
bool RunUntil(LiveRuntime& runtime, const bool& done) {
  const test::Pump pump(runtime, [&] {
    if (done) {
      runtime.Stop();
    } else {
      runtime.Publish(BusId::kLocal, "A", kMessage);
    }
  });
  runtime.RunFor(kDeadline_us);
  return done;
}

TEST(LiveRuntimeTest, AnExceptionOfAHandlerLeavesRunAndTheNextRunGoesOn) {
  LiveRuntime runtime(TestBuses(17101), "");
  bool handled = false;
  int calls = 0;
  runtime.Subscribe(BusId::kLocal, "A", [&](auto) {
    if (++calls <= 3) throw std::runtime_error("broken handler");
    handled = true;
  });

  for (int i = 0; i < 3; ++i) {
    EXPECT_THROW(
        {
          bool never = false;
          RunUntil(runtime, never);
        },
        std::runtime_error);
  }

  EXPECT_TRUE(RunUntil(runtime, handled));
}

TEST(LiveRuntimeTest, AnExceptionOfATimerLeavesRunAndTheNextRunGoesOn) {
  LiveRuntime runtime(TestBuses(17102), "");
  runtime.After(1000, [] { throw std::logic_error("broken timer"); });
  bool ran = false;

  EXPECT_THROW(runtime.RunFor(kDeadline_us), std::logic_error);
  runtime.After(1000, [&] {
    ran = true;
    runtime.Stop();
  });
  runtime.RunFor(kDeadline_us);

  EXPECT_TRUE(ran);
}

TEST(LiveRuntimeTest, ARunForThatAnExceptionEndedDoesNotEndALaterRun) {
  LiveRuntime runtime(TestBuses(17110), "");
  runtime.After(1000, [] { throw std::logic_error("broken timer"); });
  EXPECT_THROW(runtime.RunFor(100'000), std::logic_error);
  bool ran = false;
  runtime.After(300'000, [&] {
    ran = true;
    runtime.Stop();
  });

  runtime.Run();

  EXPECT_TRUE(ran);
}

// From the signal to the end of Run(), while it waits and while it is busy.
class SignalTest : public testing::TestWithParam<int> {};

TEST_P(SignalTest, EndsAWaitingRunWithinOneSecond) {
  LiveRuntime runtime(TestBuses(17103), "");
  runtime.Subscribe(BusId::kLocal, "A", [](auto) {});
  std::int64_t signalled_us = 0;
  runtime.After(50'000, [&] {
    signalled_us = runtime.MonotonicUs();
    kill(getpid(), GetParam());
  });

  runtime.Run();

  EXPECT_LT(runtime.MonotonicUs() - signalled_us, kSecond);
}

TEST_P(SignalTest, EndsARunThatDrownsInMessagesWithinOneSecond) {
  LiveRuntime runtime(TestBuses(17104), "");
  runtime.Subscribe(BusId::kLocal, "A", [&](auto) {
    runtime.Publish(BusId::kLocal, "A", kMessage);  // For ever, and two for one.
    runtime.Publish(BusId::kLocal, "A", kMessage);
  });
  std::int64_t signalled_us = 0;
  runtime.Every(20'000, [&] { runtime.Publish(BusId::kLocal, "A", kMessage); });
  runtime.After(200'000, [&] {
    signalled_us = runtime.MonotonicUs();
    kill(getpid(), GetParam());
  });

  runtime.Run();

  EXPECT_LT(runtime.MonotonicUs() - signalled_us, kSecond);
}

TEST_P(SignalTest, RunForGoesItsFullTimeAfterTheSignal) {
  constexpr std::int64_t kDuration_us = 100'000;
  LiveRuntime runtime(TestBuses(17105), "");
  runtime.After(1000, [] { kill(getpid(), GetParam()); });
  runtime.Run();
  const std::int64_t begin_us = runtime.MonotonicUs();

  runtime.RunFor(kDuration_us);

  EXPECT_GE(runtime.MonotonicUs() - begin_us, kDuration_us);
}

INSTANTIATE_TEST_SUITE_P(Signals,
                         SignalTest,
                         testing::Values(SIGINT, SIGTERM),
                         [](const auto& test) { return test.param == SIGINT ? "Int" : "Term"; });

TEST(LiveRuntimeTest, ASignalThatHasAHandlerOfItsOwnInterruptsNothing) {
  static std::atomic<int> interruptions = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { ++interruptions; };  // Without SA_RESTART: EINTR.
  sigaction(SIGUSR1, &action, nullptr);
  LiveRuntime runtime(TestBuses(17106), "");
  int received = 0;
  bool enough = false;
  runtime.Subscribe(BusId::kLocal, "A", [&](auto) { enough = ++received >= 50; });
  std::atomic<bool> stop = false;
  std::thread disturber([&stop, victim = pthread_self()] {
    while (!stop) {
      pthread_kill(victim, SIGUSR1);
      std::this_thread::yield();
    }
  });

  const bool done = RunUntil(runtime, enough);
  stop = true;
  disturber.join();

  EXPECT_TRUE(done);
  EXPECT_GT(interruptions, 0);
}

void Spin(std::int64_t us) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::microseconds(us);
  while (std::chrono::steady_clock::now() < until) {
  }
}

TEST(LiveRuntimeTest, TimersRunInTheMiddleOfAFloodOfMessages) {
  constexpr std::int64_t kHandler_us = 1000;
  constexpr std::int64_t kPeriod_us = 10'000;
  constexpr std::int64_t kWait_us = 10'000;  // Messages in a row come before timers for this long.
  LiveRuntime runtime(TestBuses(17107), "");
  bool listens = false;
  int since_timer = 0;
  int most = 0;
  int total = 0;
  runtime.Subscribe(BusId::kLocal, "A", [&](auto) { listens = true; });
  runtime.Subscribe(BusId::kLocal, "FLOOD", [&](auto) {
    Spin(kHandler_us);
    most = std::max(most, ++since_timer);
    if (++total == 300) runtime.Stop();
  });
  ASSERT_TRUE(RunUntil(runtime, listens));
  const auto timer = runtime.Every(kPeriod_us, [&] { since_timer = 0; });

  for (int i = 0; i < 1500; ++i) runtime.Publish(BusId::kLocal, "FLOOD", kMessage);
  runtime.RunFor(kDeadline_us);
  runtime.Cancel(timer);

  EXPECT_EQ(total, 300);
  // Each handler takes its millisecond, so more of them fit in only if the timer waits for longer.
  EXPECT_LE(most, (kPeriod_us + kWait_us) / kHandler_us + 1);
}

TEST(LiveRuntimeTest, SessionsDiffer) {
  LiveRuntime runtime(TestBuses(17108), "");
  std::set<std::int64_t> sessions;
  for (int i = 0; i < 1000; ++i) sessions.insert(runtime.NewSession());

  EXPECT_EQ(sessions.size(), 1000U);
  EXPECT_GT(*sessions.begin(), 0);
}

// In a child without any network: the error is what the child says.
std::string ErrorWithoutARoute() {
  int ends[2];
  if (pipe(ends) != 0) return "pipe failed";
  const pid_t child = fork();
  if (child == 0) {
    std::string error = "no error";
    if (unshare(CLONE_NEWNET) != 0) error = "unshare failed";
    try {
      LiveRuntime runtime(TestBuses(17109), "");
      runtime.Subscribe(BusId::kLocal, "A", [](auto) {});
      runtime.Publish(BusId::kLocal, "A", kMessage);
    } catch (const std::exception& exception) {
      error = exception.what();
    }
    [[maybe_unused]] const ssize_t written = write(ends[1], error.data(), error.size());
    _exit(0);
  }
  close(ends[1]);
  std::string error;
  for (char c = 0; read(ends[0], &c, 1) == 1;) error += c;
  close(ends[0]);
  waitpid(child, nullptr, 0);
  return error;
}

TEST(LiveRuntimeTest, WithoutAMulticastRouteTheErrorSaysWhatToDo) {
  const std::string error = ErrorWithoutARoute();

  EXPECT_THAT(error, testing::HasSubstr("udpm://239.255.76.67:17109"));
  EXPECT_THAT(error, testing::HasSubstr("ip route add 224.0.0.0/4 dev lo"));
}

TEST(LiveRuntimeTest, AWatchedDescriptorIsHandledUntilItIsUnwatched) {
  LiveRuntime runtime(TestBuses(17112), "");
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  int calls = 0;
  runtime.WatchDescriptor(ends[0], [&] {
    char byte = 0;
    EXPECT_EQ(read(ends[0], &byte, 1), 1);
    if (++calls == 2) {
      runtime.UnwatchDescriptor(ends[0]);
      runtime.After(20'000, [&] { runtime.Stop(); });
    }
  });

  ASSERT_EQ(write(ends[1], "abc", 3), 3);
  runtime.RunFor(kDeadline_us);

  EXPECT_EQ(calls, 2) << "the third byte was nobody's any more";
  close(ends[0]);
  close(ends[1]);
}

TEST(LiveRuntimeTest, AHungUpDescriptorIsHandled) {
  LiveRuntime runtime(TestBuses(17113), "");
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  bool ended = false;
  runtime.WatchDescriptor(ends[0], [&] {
    ended = true;
    runtime.UnwatchDescriptor(ends[0]);
    runtime.Stop();
  });

  close(ends[1]);
  runtime.RunFor(kDeadline_us);

  EXPECT_TRUE(ended);
  close(ends[0]);
}

TEST(LiveRuntimeTest, SignalsGoToWhoAskedForThemAndDoNotEndTheRun) {
  LiveRuntime runtime(TestBuses(17114), "");
  std::vector<int> signals;
  runtime.OnSignal([&](int signal) {
    signals.push_back(signal);
    if (signals.size() == 3) runtime.Stop();
  });
  runtime.After(1000, [] { raise(SIGTERM); });
  runtime.After(20'000, [] { raise(SIGCHLD); });
  runtime.After(40'000, [] { raise(SIGHUP); });

  runtime.RunFor(kDeadline_us);

  EXPECT_EQ(signals, (std::vector<int>{SIGTERM, SIGCHLD, SIGHUP}));
}

TEST(LiveRuntimeTest, AnEndedChildOrANewWindowSizeEndsNoRun) {
  LiveRuntime runtime(TestBuses(17115), "");
  bool is_over = false;
  runtime.After(1000, [] {
    raise(SIGCHLD);
    raise(SIGWINCH);
  });
  runtime.After(50'000, [&] {
    is_over = true;
    runtime.Stop();
  });

  runtime.RunFor(kDeadline_us);

  EXPECT_TRUE(is_over);
}

}  // namespace
}  // namespace clearway::process
