// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/user_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_folder.hpp"

namespace clearway::doctor {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Owner 0, group 0, unless said otherwise.
FileFacts FileWith(mode_t folder, mode_t file, uid_t owner = 0, gid_t group = 0) {
  return {.file = "/d/f",
          .parts = {{"/", 0755, 0, 0}, {"/d", folder, 0, 0}, {"/d/f", file, owner, group}},
          .is_there = true};
}

Finding CheckOne(const FileFacts& file) {
  const Findings findings = CheckUser(
      {.is_root = false, .deputy_user = "cw", .user = User{"cw", 500, {500, 20}}, .files = {file}});
  EXPECT_EQ(findings.size(), 1U);
  return findings.front();
}

TEST(DeputyUser, MayReadWhatAllMayRead) {
  EXPECT_EQ(CheckOne(FileWith(0755, 0644)).state, State::kOk);
}

TEST(DeputyUser, NeedsTheFileAndTheWayToIt) {
  const Finding finding = CheckOne(FileWith(0700, 0600));

  EXPECT_EQ(finding.state, State::kProblem);
  EXPECT_THAT(finding.mend, ElementsAre("sudo chmod o+x /d", "sudo chmod o+r /d/f"));
}

TEST(DeputyUser, IsJudgedByTheBitsThatCountForIt) {
  EXPECT_EQ(CheckOne(FileWith(0755, 0640, 0, 20)).state, State::kOk);
  EXPECT_THAT(CheckOne(FileWith(0755, 0604, 0, 20)).mend, ElementsAre("sudo chmod g+r /d/f"));
  EXPECT_EQ(CheckOne(FileWith(0755, 0400, 500, 0)).state, State::kOk);
  EXPECT_THAT(CheckOne(FileWith(0755, 0044, 500, 20)).mend, ElementsAre("sudo chmod u+r /d/f"));
}

TEST(DeputyUser, RootMayReadAnything) {
  const UserFacts facts{.is_root = true,
                        .deputy_user = "root",
                        .user = User{"root", 0, {0}},
                        .files = {FileWith(0700, 0000, 500, 500)}};

  EXPECT_EQ(CheckUser(facts)[0].state, State::kOk);
}

TEST(DeputyUser, AMissingFileIsAProblem) {
  EXPECT_EQ(CheckOne({.file = "/d/f", .parts = {{"/", 0755, 0, 0}}, .is_there = false}).state,
            State::kProblem);
}

TEST(DeputyUser, ThatIsNotThereIsNotCheckedAndRootIsWarned) {
  UserFacts facts{.is_root = false, .deputy_user = "cw", .user = {}, .files = {}};
  EXPECT_EQ(CheckUser(facts)[0].state, State::kNotChecked);
  EXPECT_EQ(CheckUser(facts).size(), 1U);

  facts.is_root = true;
  ASSERT_EQ(CheckUser(facts).size(), 2U);
  EXPECT_EQ(CheckUser(facts)[1].state, State::kWarning);
  EXPECT_THAT(CheckUser(facts)[1].mend, ElementsAre("sudo systemd-sysusers"));
}

TEST(DeputyUser, FileFactsWalkFromTheRoot) {
  const test::TestFolder folder;
  const std::filesystem::path file = folder.Write("f", "x");

  const FileFacts facts = ReadFileFacts(file);

  EXPECT_TRUE(facts.is_there);
  EXPECT_EQ(facts.parts.front().path, "/");
  EXPECT_EQ(facts.parts.back().path.filename(), "f");
  EXPECT_FALSE(ReadFileFacts(folder.path() / "none").is_there);
}

TEST(DeputyUser, IsReadByName) {
  ASSERT_TRUE(ReadUser("root").has_value());
  EXPECT_EQ(ReadUser("root")->uid, 0U);
  EXPECT_FALSE(ReadUser("no-such-user-here").has_value());
}

}  // namespace
}  // namespace clearway::doctor
