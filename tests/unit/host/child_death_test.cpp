// SPDX-License-Identifier: BSD-3-Clause
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

struct ParentDeathCase {
  std::string action;
  int signal;
};

class ParentDeathTest : public testing::TestWithParam<ParentDeathCase> {};

TEST_P(ParentDeathTest, AChildDiesWithItsParent) {
  BecomeSubreaper();  // To see what the child died of.
  StartedChild parent(TestChild({GetParam().action, std::to_string(GetParam().signal)}));
  const pid_t child = parent.ReadPid("");
  ASSERT_EQ(parent.ReadLine(), "ready");

  ASSERT_TRUE(SendSignal(parent.pid(), parent.child().start_ticks, SIGKILL));
  parent.Reap();

  ASSERT_TRUE(HasEnded(child));
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, GetParam().signal);
}

INSTANTIATE_TEST_SUITE_P(BothKindsAndSignals,
                         ParentDeathTest,
                         testing::Values(ParentDeathCase{"start_on_terminal", SIGKILL},
                                         ParentDeathCase{"start_on_terminal", SIGTERM},
                                         ParentDeathCase{"start_child_process", SIGKILL},
                                         ParentDeathCase{"start_child_process", SIGTERM}));

TEST(ChildEndTest, IsReapedWithItsStatus) {
  StartedChild first(TestChild({"exit", "3"}));
  StartedChild second(TestChild({"exit", "0"}));
  StartedChild third(TestChild({"wait"}));
  ASSERT_EQ(third.ReadLine(), "ready");
  ASSERT_TRUE(HasEnded(first.pid()));
  ASSERT_TRUE(HasEnded(second.pid()));

  const std::vector<Exit> exits = ReapAll();

  ASSERT_EQ(exits.size(), 2U);
  for (const Exit& exit : exits) {
    EXPECT_EQ(exit.status, exit.pid == first.pid() ? 3 << 8 : 0);
    EXPECT_TRUE(exit.pid == first.pid() || exit.pid == second.pid());
  }
  EXPECT_TRUE(ReapAll().empty());
}

TEST(ChildEndTest, ASigintProofChildNeedsSigkill) {
  StartedChild child(TestChild({"ignore", std::to_string(SIGINT)}));
  ASSERT_EQ(child.ReadLine(), "ready");
  constexpr int kLongEnoughMs = 200;

  EXPECT_TRUE(SendSignal(child.pid(), child.child().start_ticks, SIGINT));
  EXPECT_FALSE(HasEnded(child.pid(), kLongEnoughMs));
  EXPECT_TRUE(SendSignal(child.pid(), child.child().start_ticks, SIGKILL));

  EXPECT_EQ(child.Reap(), SIGKILL);
}

}  // namespace
}  // namespace clearway::host
