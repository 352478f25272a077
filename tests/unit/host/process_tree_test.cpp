// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <csignal>
#include <string>
#include <sys/wait.h>
#include <vector>

#include <gtest/gtest.h>

#include "common/host/process_table.hpp"
#include "common/host/reaping.hpp"
#include "common/host/signalling.hpp"
#include "tests/unit/host/started_child.hpp"

namespace clearway::host {
namespace {

using test::HasEnded;
using test::StartedChild;
using test::TestChild;

std::vector<pid_t> PidsOf(const std::vector<ProcessEntry>& entries) {
  std::vector<pid_t> pids;
  for (const ProcessEntry& entry : entries) pids.push_back(entry.pid);
  return pids;
}

// The pids that "child N" and "grandchild N" name, in whatever order they come.
std::vector<pid_t> ReadTree(StartedChild& child) {
  std::vector<pid_t> pids;
  for (int num_ready = 0; num_ready < 2;) {
    const std::string line = child.ReadLine();
    if (line == "ready") ++num_ready;
    if (line.find("child ") != std::string::npos)
      pids.push_back(std::stoi(line.substr(line.find(' '))));
  }
  std::sort(pids.begin(), pids.end());
  return pids;
}

TEST(ProcessTreeTest, AProcessWithBracketsInItsNameIsRead) {
  StartedChild child(TestChild({"name", "a) b (c"}));
  ASSERT_EQ(child.ReadLine(), "ready");

  const auto entry = ReadProcess(child.pid());

  ASSERT_TRUE(entry.has_value());
  EXPECT_EQ(entry->pgrp, child.pid());
  EXPECT_EQ(entry->session, child.pid());
  EXPECT_NE(ProcessTable::Read().Find(child.pid()), nullptr);
}

TEST(ProcessTreeTest, GrandchildrenAreDescendantsAndInTheGroup) {
  BecomeSubreaper();
  StartedChild child(TestChild({"tree"}));
  const std::vector<pid_t> tree = ReadTree(child);

  EXPECT_EQ(PidsOf(ProcessTable::Read().Descendants(child.pid())), tree);

  EXPECT_TRUE(SendSignalToGroup(child.pid(), child.child().start_ticks, SIGTERM));
  EXPECT_EQ(child.Reap(), SIGTERM);
  for (const pid_t pid : tree) EXPECT_TRUE(HasEnded(pid));
  EXPECT_EQ(ReapAll().size(), 2U);
}

TEST(ProcessTreeTest, ADaemonIsHandedToTheSubreaper) {
  BecomeSubreaper();
  ChildSettings settings = TestChild({"daemon"});
  settings.environment = {"OTHER=1", "CLEARWAY_DEPUTY_COMMAND=run 7", "LAST="};
  StartedChild child(settings);
  const pid_t daemon = child.ReadPid("daemon ");
  ASSERT_EQ(child.ReadLine(), "ready");
  ASSERT_EQ(child.Reap(), 0);

  const auto entry = ReadProcess(daemon);
  ASSERT_TRUE(entry.has_value());
  EXPECT_EQ(entry->ppid, getpid());
  EXPECT_NE(entry->session, child.pid());
  EXPECT_EQ(PidsOf(ProcessTable::Read().Descendants(getpid())), std::vector<pid_t>{daemon});
  EXPECT_TRUE(HasVariable(daemon, "CLEARWAY_DEPUTY_COMMAND=run 7"));

  EXPECT_TRUE(SendSignal(daemon, entry->start_ticks, SIGKILL));
  ASSERT_TRUE(HasEnded(daemon));
  const std::vector<Exit> exits = ReapAll();
  ASSERT_EQ(exits.size(), 1U);
  EXPECT_EQ(exits[0].pid, daemon);
  EXPECT_EQ(exits[0].status, SIGKILL);
}

TEST(HasVariableTest, KnowsWholeVariablesOnly) {
  ChildSettings settings = TestChild({"wait"});
  const std::string large = "LARGE=" + std::string(50'000, 'x');
  settings.environment = {"A=1", large, "MARK=run 7", "EMPTY="};
  StartedChild child(settings);
  ASSERT_EQ(child.ReadLine(), "ready");

  for (const std::string& variable : settings.environment) {
    EXPECT_TRUE(HasVariable(child.pid(), variable)) << variable.substr(0, 20);
  }
  for (const char* variable : {"", "A", "A=", "A=12", "=1", "ARK=run 7", "MARK=run", "LARGE=x"}) {
    EXPECT_FALSE(HasVariable(child.pid(), variable)) << variable;
  }
  EXPECT_FALSE(HasVariable(-1, "A=1"));
}

TEST(HasVariableTest, AZombieHasNone) {
  StartedChild child(TestChild({"exit", "0"}));
  ASSERT_TRUE(HasEnded(child.pid()));

  EXPECT_FALSE(HasVariable(child.pid(), "PATH=/usr/bin:/bin"));
  EXPECT_EQ(ReadProcess(child.pid())->state, 'Z');
}

}  // namespace
}  // namespace clearway::host
