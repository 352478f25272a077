// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/screen_tree.hpp"

#include <gmock/gmock.h>

#include "tests/unit/procman/screen_bed.hpp"

namespace clearway::screen {
namespace {

using testing::ElementsAre;

std::vector<std::string> NamesOf(const std::vector<TreeLine>& lines) {
  std::vector<std::string> names;
  for (const TreeLine& line : lines) {
    names.push_back(std::string(2 * static_cast<std::size_t>(line.depth), ' ') + line.name +
                    (line.kind == TreeLine::Kind::kGroup ? "/" : ""));
  }
  return names;
}

TEST(ScreenTree, ListsGroupsAndCommandsAsTheyComeInTheFile) {
  const Snapshot snapshot = SmallRobot().snapshot;

  EXPECT_THAT(NamesOf(TreeOf(snapshot, {})),
              ElementsAre("everything",
                          "sense/",
                          "  lidar-driver",
                          "  perceive/",
                          "    preprocessor",
                          "    clusterer",
                          "stop-guard",
                          "hand/",
                          "  gripper"));
}

TEST(ScreenTree, GathersAGroupThatTheFileNamesTwice) {
  Snapshot snapshot;
  snapshot.commands = {Command("a", "one", Status::kRunning),
                       Command("b", "two", Status::kRunning),
                       Command("c", "one", Status::kRunning)};
  CountGroups(snapshot);

  EXPECT_THAT(NamesOf(TreeOf(snapshot, {})),
              ElementsAre("everything", "one/", "  a", "  c", "two/", "  b"));
}

TEST(ScreenTree, LeavesOutWhatIsBelowAFoldedGroup) {
  const Snapshot snapshot = SmallRobot().snapshot;

  const std::vector<TreeLine> lines = TreeOf(snapshot, {"sense", "gone"});

  EXPECT_THAT(NamesOf(lines),
              ElementsAre("everything", "sense/", "stop-guard", "hand/", "  gripper"));
  EXPECT_TRUE(lines[1].is_folded);
}

TEST(ScreenTree, LinesNameTheTargetOfOrders) {
  const std::vector<TreeLine> lines = TreeOf(SmallRobot().snapshot, {});

  EXPECT_EQ(lines[0].target().kind, Target::Kind::kEverything);
  EXPECT_EQ(lines[3].target(), (Target{Target::Kind::kGroup, "sense/perceive"}));
  EXPECT_EQ(lines[4].target(), (Target{Target::Kind::kCommand, "preprocessor"}));
}

TEST(ScreenTree, StandsUpToPathsThatNobodyWouldWrite) {
  Snapshot snapshot;
  snapshot.commands = {Command("slashes", "//", Status::kRunning),
                       Command("deep", std::string(5000, '/'), Status::kRunning)};
  CountGroups(snapshot);

  const std::vector<TreeLine> lines = TreeOf(snapshot, {});

  EXPECT_GT(lines.size(), 5000U);
  for (const TreeLine& line : lines) {
    if (line.kind != TreeLine::Kind::kGroup) continue;
    EXPECT_EQ(snapshot.groups[line.index].path, line.path);
  }
}

TEST(ScreenTree, NothingKnownIsOneLine) {
  EXPECT_THAT(NamesOf(TreeOf({}, {})), ElementsAre("everything"));
}

}  // namespace
}  // namespace clearway::screen
