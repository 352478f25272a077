// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/signalling.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>
#include <linux/sched.h>

#include "common/host/process_table.hpp"
#include "tests/unit/host/started_child.hpp"

namespace clearway::host {
namespace {

using test::HasEnded;
using test::StartedChild;
using test::TestChild;

// A child that waits for a signal and has just this pid; -1 and errno when it cannot be had.
pid_t StartWithPid(pid_t pid) {
  clone_args arguments{};
  arguments.exit_signal = SIGCHLD;
  arguments.set_tid = reinterpret_cast<std::uint64_t>(&pid);
  arguments.set_tid_size = 1;
  const auto child = static_cast<pid_t>(syscall(SYS_clone3, &arguments, sizeof(arguments)));
  while (child == 0) pause();
  return child;
}

TEST(SendSignalTest, AnotherStartTimeIsAnotherProcess) {
  StartedChild child(TestChild({"wait"}));
  ASSERT_EQ(child.ReadLine(), "ready");
  const std::uint64_t ticks = child.child().start_ticks;

  EXPECT_FALSE(SendSignal(child.pid(), ticks + 1, SIGKILL));
  EXPECT_FALSE(SendSignal(child.pid(), ticks - 1, SIGKILL));
  EXPECT_FALSE(SendSignalToGroup(child.pid(), ticks + 1, SIGKILL));
  EXPECT_TRUE(SendSignal(child.pid(), ticks, 0));
  EXPECT_TRUE(SendSignal(child.pid(), ticks, SIGTERM));

  EXPECT_EQ(child.Reap(), SIGTERM);
}

TEST(SendSignalTest, APidThatIsUsedAgainIsSpared) {
  StartedChild child(TestChild({"exit", "0"}));
  const std::uint64_t ticks = child.child().start_ticks;
  child.Reap();
  // A start time of its own: another tick must have begun.
  const timespec ten_ticks{.tv_sec = 0, .tv_nsec = 100'000'000};
  nanosleep(&ten_ticks, nullptr);
  const pid_t again = StartWithPid(child.pid());
  if (again < 0) GTEST_SKIP() << "cannot choose a pid: " << std::strerror(errno);
  ASSERT_EQ(again, child.pid());

  EXPECT_FALSE(SendSignal(again, ticks, SIGKILL));
  EXPECT_FALSE(SendSignalToGroup(again, ticks, SIGKILL));

  EXPECT_NE(ReadProcess(again)->state, 'Z');
  EXPECT_TRUE(SendSignal(again, ReadProcess(again)->start_ticks, SIGKILL));
  int status = 0;
  EXPECT_EQ(waitpid(again, &status, 0), again);
  EXPECT_EQ(status, SIGKILL);
}

TEST(SendSignalTest, NobodyGetsWhatIsForNobody) {
  StartedChild child(TestChild({"exit", "0"}));
  child.Reap();

  EXPECT_FALSE(SendSignal(child.pid(), child.child().start_ticks, SIGKILL));
  EXPECT_FALSE(SendSignalToGroup(child.pid(), child.child().start_ticks, SIGKILL));
  // These would be groups, or everybody, to kill().
  for (const pid_t pid : {0, -1, -getpid()}) {
    EXPECT_FALSE(SendSignal(pid, 0, 0));
    EXPECT_FALSE(SendSignalToGroup(pid, 0, 0));
  }
}

TEST(SendSignalTest, OneThatEndedIsThereUntilItIsReaped) {
  StartedChild child(TestChild({"exit", "7"}));
  ASSERT_TRUE(HasEnded(child.pid()));

  EXPECT_TRUE(SendSignal(child.pid(), child.child().start_ticks, SIGKILL));
  EXPECT_EQ(child.Reap(), 7 << 8);
}

// Whatever a child has got to by then: its group is not there yet, or it is.
TEST(SendSignalTest, AGroupCanBeSignalledFromTheVeryStart) {
  for (int i = 0; i < 50; ++i) {
    StartedChild child(TestChild({"wait"}));
    ASSERT_TRUE(SendSignalToGroup(child.pid(), child.child().start_ticks, SIGTERM)) << i;
    ASSERT_EQ(child.Reap(), SIGTERM) << i;
  }
}

}  // namespace
}  // namespace clearway::host
