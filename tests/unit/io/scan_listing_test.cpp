// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/scan_listing.hpp"

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/read_error.hpp"
#include "tests/unit/io/temporary_folder.hpp"

namespace clearway::io {
namespace {

using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::vector<std::string> List(const std::filesystem::path& input,
                              const std::filesystem::path& root) {
  std::vector<std::string> names;
  for (const auto& path : ListScanFiles(input)) {
    names.push_back(path.lexically_relative(root).string());
  }
  return names;
}

TEST(ScanListing, SearchesAFolderForScansInNaturalOrder) {
  const TemporaryFolder folder;
  for (const char* name : {"velodyne/10.bin",
                           "velodyne/9.bin",
                           "velodyne/100.BIN",
                           "label_2/9.txt",
                           "a.pcd",
                           "velodyne/deeper/1.pcd",
                           "boxes.json",
                           ".hidden/1.pcd",
                           "velodyne/._9.bin",
                           "readme.md"}) {
    folder.Write(name);
  }

  EXPECT_THAT(List(folder.path(), folder.path()),
              ElementsAre("a.pcd",
                          "velodyne/9.bin",
                          "velodyne/10.bin",
                          "velodyne/100.BIN",
                          "velodyne/deeper/1.pcd"));
}

TEST(ScanListing, ALinkThatLeadsNowhereIsAScanThatCannotBeRead) {
  const TemporaryFolder folder;
  folder.Write("1.bin");
  std::filesystem::create_symlink(folder.path() / "gone.bin", folder.path() / "2.bin");
  std::filesystem::create_symlink("3.bin", folder.path() / "3.bin");

  EXPECT_THAT(List(folder.path(), folder.path()), ElementsAre("1.bin", "2.bin", "3.bin"));
}

TEST(ScanListing, TakesAFileForItself) {
  const TemporaryFolder folder;
  const auto scan = folder.Write("scan.PCD");

  EXPECT_THAT(List(scan, folder.path()), ElementsAre("scan.PCD"));
}

TEST(ScanListing, ReadsAListInItsOwnOrder) {
  const TemporaryFolder folder;
  folder.Write("scans/b.pcd");
  folder.Write("scans/a with blanks.bin");
  const auto list = folder.Write(
      "lists/run.txt", "# the run\r\n../scans/b.pcd\r\n\r\n  ../scans/a with blanks.bin\r\n");

  EXPECT_THAT(List(list, folder.path() / "lists"),
              ElementsAre("../scans/b.pcd", "../scans/a with blanks.bin"));
}

TEST(ScanListing, SaysWhatWasLookedForWhenNothingIsThere) {
  const TemporaryFolder folder;
  folder.Write("notes/readme.txt");

  EXPECT_THAT([&] { (void)ListScanFiles(folder.path()); },
              ThrowsMessage<ReadError>(HasSubstr(
                  "no scan in this folder or below it: looked for *.pcd and *.bin, found 1 other "
                  "files")));
  EXPECT_THAT([] { (void)ListScanFiles("/no/such/folder"); },
              ThrowsMessage<ReadError>(
                  "/no/such/folder: no such file or folder; expected a folder with .pcd or .bin "
                  "files, one such file, or a .txt list of them"));
  EXPECT_THAT([&] { (void)ListScanFiles(folder.Write("log.lcm")); },
              ThrowsMessage<ReadError>(HasSubstr("log.lcm: not a recording; expected a folder")));
}

TEST(ScanListing, RefusesAListWithAWrongLine) {
  const TemporaryFolder folder;
  folder.Write("a.pcd");
  const auto wrong = folder.Write("wrong.txt", "a.pcd\n1.0 2.0 3.0\n");
  const auto missing = folder.Write("missing.txt", "# one\na.pcd\nb.pcd\n");
  const auto empty = folder.Write("empty.txt", "# nothing\n");

  EXPECT_THAT([&] { (void)ListScanFiles(wrong); },
              ThrowsMessage<ReadError>(
                  HasSubstr("wrong.txt:2: \"1.0 2.0 3.0\": expected a .pcd or .bin file")));
  EXPECT_THAT([&] { (void)ListScanFiles(missing); },
              ThrowsMessage<ReadError>(HasSubstr("missing.txt:3: no such file: ")));
  EXPECT_THAT([&] { (void)ListScanFiles(empty); },
              ThrowsMessage<ReadError>(HasSubstr("empty.txt: the list names no .pcd or .bin")));
}

TEST(NaturalOrder, ComparesNumbersAsNumbersAndFractionsAsDecimals) {
  const std::vector<std::string> ordered = {"1.25",
                                            "1.5",
                                            "2",
                                            "10",
                                            "010a",
                                            "1744500470.786466599.bin",
                                            "1744500470.8.bin",
                                            "1744500471.05.bin",
                                            "a-0",
                                            "a-00",
                                            "scan",
                                            "scan2",
                                            "scan9b",
                                            "scan09c",
                                            "scan10",
                                            "scan99999999999999999999998",
                                            "scan99999999999999999999999",
                                            "scan_1"};
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    for (std::size_t j = 0; j < ordered.size(); ++j) {
      EXPECT_EQ(ComesBefore(ordered[i], ordered[j]), i < j) << ordered[i] << " " << ordered[j];
    }
  }
}

TEST(NaturalOrder, IsAStrictOrderOfAnyNames) {
  std::mt19937 random(4);
  const std::string letters = "0019.-a";
  std::vector<std::string> names(60);
  for (std::string& name : names) {
    for (std::size_t i = random() % 6; i > 0; --i) name += letters[random() % letters.size()];
  }
  for (const std::string& a : names) {
    for (const std::string& b : names) {
      ASSERT_EQ(ComesBefore(a, b) || ComesBefore(b, a), a != b) << a << " " << b;
      ASSERT_FALSE(ComesBefore(a, b) && ComesBefore(b, a)) << a << " " << b;
      for (const std::string& c : names) {
        if (ComesBefore(a, b) && ComesBefore(b, c)) {
          ASSERT_TRUE(ComesBefore(a, c)) << a << " " << b << " " << c;
        }
      }
    }
  }
}

}  // namespace
}  // namespace clearway::io
