// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/program_path.hpp"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/test_folder.hpp"

namespace clearway::host {
namespace {

namespace fs = std::filesystem;

class FindProgramTest : public testing::Test {
 protected:
  FindProgramTest() {
    for (const char* name : {"first", "second"}) fs::create_directory(folder_.path() / name);
    MakeProgram("first/both");
    MakeProgram("second/both");
    MakeProgram("second/last");
    folder_.Write("first/last", "may not be executed");
    fs::create_directory(folder_.path() / "first/only");
    MakeProgram("second/only");
    path_ = folder_.path() / "first";
    path_ += ":" + (folder_.path() / "second").string();
  }

  void MakeProgram(const std::string& name) {
    fs::permissions(folder_.Write(name, "#!/bin/sh\n"), fs::perms::owner_all);
  }

  test::TestFolder folder_;
  std::string path_;
};

TEST_F(FindProgramTest, TakesTheFirstFolderThatHasIt) {
  EXPECT_EQ(FindProgram("both", path_), folder_.path() / "first/both");
}

TEST_F(FindProgramTest, PassesFoldersAndFilesThatAreNoPrograms) {
  EXPECT_EQ(FindProgram("last", path_), folder_.path() / "second/last");
  EXPECT_EQ(FindProgram("only", path_), folder_.path() / "second/only");
}

TEST_F(FindProgramTest, ANameWithASlashIsAPath) {
  const std::string path = folder_.path() / "first/both";

  EXPECT_EQ(FindProgram(path, ""), path);
  EXPECT_FALSE(FindProgram("first/both", path_).has_value());
  EXPECT_FALSE(FindProgram(folder_.path() / "first/last", path_).has_value());
  EXPECT_FALSE(FindProgram(folder_.path() / "first", path_).has_value());
  EXPECT_FALSE(FindProgram("./", path_).has_value());
}

TEST_F(FindProgramTest, AnEmptyFolderIsTheWorkingFolder) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path() / "second");

  EXPECT_EQ(FindProgram("last", ""), "./last");
  EXPECT_EQ(FindProgram("last", "/none:"), "./last");
  EXPECT_EQ(FindProgram("last", ":/none"), "./last");
  EXPECT_EQ(FindProgram("last", "/none::/nothing"), "./last");
  EXPECT_FALSE(FindProgram("last", "/none").has_value());

  fs::current_path(before);
}

TEST_F(FindProgramTest, FindsNothingByNamesThatNameNothing) {
  EXPECT_FALSE(FindProgram("", path_).has_value());
  EXPECT_FALSE(FindProgram("missing", path_).has_value());
  EXPECT_FALSE(FindProgram(".", path_).has_value());
  EXPECT_FALSE(FindProgram(std::string("both\0x", 6), path_).has_value());
  EXPECT_FALSE(FindProgram(std::string(5000, 'a'), path_).has_value());
}

}  // namespace
}  // namespace clearway::host
