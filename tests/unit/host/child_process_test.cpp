// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/child_process.hpp"

#include <csignal>
#include <stdexcept>
#include <unistd.h>

#include <gtest/gtest.h>

#include "tests/support/test_folder.hpp"
#include "tests/unit/host/started_child.hpp"

namespace clearway::host {
namespace {

using test::kTimeoutMs;
using test::TestFolder;

TEST(ChildProcessTest, HasAStatusAndLastWords) {
  const TestFolder folder;
  ChildProcess child("child", {TEST_CHILD, "complain", "alas\n"}, folder.path() / "log");

  EXPECT_EQ(child.WaitOrKill(kTimeoutMs), 0);
  EXPECT_EQ(child.ExitStatus(), 0);
  EXPECT_EQ(child.LastWords(), "  alas\n");
  EXPECT_FALSE(child.Use().has_value());
}

TEST(ChildProcessTest, OneThatDoesNotEndIsKilled) {
  const TestFolder folder;
  ChildProcess child("child", {TEST_CHILD, "wait"}, folder.path() / "log");

  EXPECT_FALSE(child.ExitStatus().has_value());
  EXPECT_EQ(child.WaitOrKill(0), 128 + SIGKILL);
}

TEST(ChildProcessTest, WhatIsTypedAtTheTerminalIsNotForIt) {
  const TestFolder folder;
  const ChildProcess child("child", {TEST_CHILD, "wait"}, folder.path() / "log");

  EXPECT_EQ(getpgid(child.pid()), child.pid());
}

TEST(ChildProcessTest, ThrowsWhenThereIsNoProgram) {
  const TestFolder folder;

  EXPECT_THROW(ChildProcess("child", {"/no/such/program"}, folder.path() / "log"),
               std::runtime_error);
  EXPECT_THROW(ChildProcess("child", {TEST_CHILD}, folder.path() / "none" / "log"),
               std::runtime_error);
}

TEST(ResourceUseTest, IsThatOfAnyProcess) {
  const auto use = UseOf(getpid());

  ASSERT_TRUE(use.has_value());
  EXPECT_GE(use->cpu_s, 0.0);
  EXPECT_GT(use->pss_mb, 0.0);
  EXPECT_FALSE(UseOf(-1).has_value());
}

}  // namespace
}  // namespace clearway::host
