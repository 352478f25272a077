// SPDX-License-Identifier: BSD-3-Clause
// A log on a disk that does not take everything.
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <sys/mount.h>
#include <sys/resource.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

#include "common/host/rotating_log.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::host {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kUtime = 1'795'595'772'345'678;
constexpr std::int64_t kLarge = 1'000'000'000;

std::string ContentOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Files of this process end there, as they would on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    Set(bytes);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

  void Set(rlim_t bytes) {
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }

 private:
  void (*handler_)(int);
  rlimit before_{};
};

TEST(FullDiskTest, WhatIsLostIsCountedAndNotedWhereItIsMissing) {
  const test::TestFolder folder;
  const fs::path path = folder.path() / "log";
  RotatingLog log(path, kLarge, 3);
  {
    FileSizeLimit limit(1000);
    for (int i = 0; i < 100; ++i) log.Write(std::string(50, 'x') + '\n', kUtime);
    EXPECT_THAT(log.problem(), HasSubstr("log: cannot be written: File too large"));
    EXPECT_THAT(log.problem(), HasSubstr(" bytes lost so far"));
    EXPECT_EQ(fs::file_size(path), 1000U);
    limit.Set(100'000);

    log.Write("there is room again\n", kUtime);
  }

  EXPECT_EQ(log.problem(), "");
  // Of 80 bytes each, 12 and a half were written; lines that were not begun count without a stamp.
  EXPECT_EQ(log.lost_bytes(), 40 + 87 * 51);
  EXPECT_THAT(ContentOf(path),
              HasSubstr("xxx\n2026-11-25T08:36:12.345+0000 --- 4477 bytes are missing here: " +
                        path.string() +
                        ": cannot be written: File too large\n"
                        "2026-11-25T08:36:12.345+0000 there is room again\n"));
}

TEST(FullDiskTest, ADeviceThatIsFullIsNoReasonToThrow) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const test::TestFolder folder;
  fs::create_symlink("/dev/full", folder.path() / "log");
  RotatingLog log(folder.path() / "log", kLarge, 3);

  for (int i = 0; i < 3; ++i) log.Write("x\n", kUtime);
  log.WriteNote("note", kUtime);

  EXPECT_THAT(log.problem(), HasSubstr("No space left on device"));
  EXPECT_GT(log.lost_bytes(), 0);
}

TEST(FullDiskTest, ALogRecoversWhenADiskHasRoomAgain) {
  const test::TestFolder folder;
  if (unshare(CLONE_NEWNS) != 0 || mount("", "/", "", MS_REC | MS_PRIVATE, "") != 0 ||
      mount("test", folder.path().c_str(), "tmpfs", 0, "size=64k") != 0) {
    GTEST_SKIP() << "cannot mount a small disk: " << std::strerror(errno);
  }
  {
    RotatingLog log(folder.path() / "log", kLarge, 3);
    for (int i = 0; i < 2000; ++i) log.Write(std::string(50, 'x') + '\n', kUtime);
    EXPECT_THAT(log.problem(), HasSubstr("No space left on device"));
    EXPECT_GT(log.lost_bytes(), 10'000);

    mount("test", folder.path().c_str(), "tmpfs", MS_REMOUNT, "size=512k");
    log.Write("there is room again\n", kUtime);

    EXPECT_EQ(log.problem(), "");
    const std::string content = ContentOf(folder.path() / "log");
    EXPECT_THAT(content, HasSubstr("bytes are missing here"));
    EXPECT_TRUE(content.ends_with(" there is room again\n"));
  }
  umount2(folder.path().c_str(), MNT_DETACH);
}

// The disk is smaller than the limits: the log takes what there is, and renames.
TEST(FullDiskTest, ALogThatMayBeLargerThanTheDiskGoesOnWithItsRotation) {
  const test::TestFolder folder;
  if (unshare(CLONE_NEWNS) != 0 || mount("", "/", "", MS_REC | MS_PRIVATE, "") != 0 ||
      mount("test", folder.path().c_str(), "tmpfs", 0, "size=64k") != 0) {
    GTEST_SKIP() << "cannot mount a small disk: " << std::strerror(errno);
  }
  {
    RotatingLog log(folder.path() / "log", 12'000, 3);
    for (int i = 0; i < 2000; ++i) log.Write(std::string(50, 'x') + '\n', kUtime);
    EXPECT_EQ(log.problem(), "");
    EXPECT_EQ(log.lost_bytes(), 0);
  }
  umount2(folder.path().c_str(), MNT_DETACH);
}

TEST(TakenAwayTest, AFileThatIsRemovedIsMadeAnew) {
  const test::TestFolder folder;
  const fs::path path = folder.path() / "logs" / "log";
  RotatingLog log(path, kLarge, 3);
  log.Write("first, ", kUtime);
  fs::remove(path);
  log.Write("second\n", kUtime);
  EXPECT_EQ(ContentOf(path), "2026-11-25T08:36:12.345+0000 second\n");

  fs::remove_all(path.parent_path());
  log.Write("third\n", kUtime);
  EXPECT_EQ(ContentOf(path), "2026-11-25T08:36:12.345+0000 third\n");

  fs::resize_file(path, 0);
  log.Write("fourth\n", kUtime);
  EXPECT_EQ(ContentOf(path), "2026-11-25T08:36:12.345+0000 fourth\n");
  EXPECT_EQ(log.lost_bytes(), 0);
}

TEST(TakenAwayTest, AFolderThatBecameAFileIsAProblemUntilItIsGone) {
  const test::TestFolder folder;
  const fs::path path = folder.path() / "logs" / "log";
  RotatingLog log(path, kLarge, 3);
  fs::remove_all(path.parent_path());
  folder.Write("logs", "");

  log.Write("12345\n", kUtime);
  log.Write("67\n", kUtime);
  EXPECT_THAT(log.problem(), HasSubstr("log: cannot be written: Not a directory; 9 bytes lost"));

  fs::remove(path.parent_path());
  log.Write("89\n", kUtime);
  EXPECT_EQ(log.problem(), "");
  EXPECT_THAT(ContentOf(path), HasSubstr("--- 9 bytes are missing here: "));
  EXPECT_THAT(ContentOf(path), Not(HasSubstr("67")));
}

TEST(TakenAwayTest, APlaceThatCannotBeRotatedIntoCostsOutputButNotTheLimit) {
  const test::TestFolder folder;
  const fs::path path = folder.path() / "log";
  RotatingLog log(path, 300, 2);
  fs::create_directories(folder.path() / "log.1" / "inside");

  for (int i = 0; i < 10; ++i) log.Write(std::string(90, 'x') + '\n', kUtime);
  EXPECT_LE(fs::file_size(path), 300U);
  EXPECT_THAT(log.problem(), HasSubstr("cannot be renamed"));
  EXPECT_EQ(log.lost_bytes(), 8 * 91);

  fs::remove_all(folder.path() / "log.1");
  log.Write("again\n", kUtime);
  EXPECT_EQ(log.problem(), "");
  EXPECT_THAT(ContentOf(path), HasSubstr("--- 728 bytes are missing here"));
}

}  // namespace
}  // namespace clearway::host
