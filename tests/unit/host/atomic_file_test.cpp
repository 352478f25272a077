// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/atomic_file.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_folder.hpp"

namespace clearway::host {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string ContentOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::size_t NumFilesIn(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

class ReplaceFileTest : public testing::Test {
 protected:
  std::string ReasonOf(const fs::path& path) {
    try {
      ReplaceFile(path, "new");
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return {};
  }

  test::TestFolder folder_;
  fs::path file_ = folder_.path() / "file";
};

TEST_F(ReplaceFileTest, WritesBytesAsTheyAre) {
  const std::string bytes("a\0b\r\n\xff", 6);

  ReplaceFile(file_, bytes);
  EXPECT_EQ(ContentOf(file_), bytes);
  ReplaceFile(file_, "");
  EXPECT_EQ(ContentOf(file_), "");
  ReplaceFile(file_, std::string(3'000'000, 'x'));
  EXPECT_EQ(fs::file_size(file_), 3'000'000U);

  EXPECT_EQ(NumFilesIn(folder_.path()), 1U);
}

TEST_F(ReplaceFileTest, ReplacesAndDoesNotOverwrite) {
  ReplaceFile(file_, "old");
  std::ifstream reader(file_);

  ReplaceFile(file_, "new");

  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(reader), {}), "old");
  EXPECT_EQ(ContentOf(file_), "new");
}

TEST_F(ReplaceFileTest, KeepsPermissions) {
  ReplaceFile(file_, "old");
  const auto secret = fs::perms::owner_read | fs::perms::owner_write;
  fs::permissions(file_, secret);

  ReplaceFile(file_, "new");

  EXPECT_EQ(fs::status(file_).permissions(), secret);
}

TEST_F(ReplaceFileTest, AFailureLeavesWhatWasThere) {
  fs::create_directories(folder_.path() / "folder" / "inside");

  EXPECT_THAT(ReasonOf(folder_.path() / "folder"), HasSubstr("folder: cannot be put in place: "));
  EXPECT_THAT(ReasonOf(folder_.path() / "none" / "file"),
              HasSubstr("file: cannot be written: No such file or directory"));
  EXPECT_NE(ReasonOf(folder_.path() / std::string(300, 'x')), "");

  EXPECT_EQ(NumFilesIn(folder_.path()), 1U);
  EXPECT_EQ(NumFilesIn(folder_.path() / "folder"), 1U);
}

TEST_F(ReplaceFileTest, WorksInTheWorkingFolder) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path());

  ReplaceFile("file", "here");

  fs::current_path(before);
  EXPECT_EQ(ContentOf(file_), "here");
}

}  // namespace
}  // namespace clearway::host
