// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/log_file_name.hpp"

#include <fstream>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/test_folder.hpp"

namespace clearway::host {
namespace {

TEST(FileNameOfTest, UsualNamesStayReadable) {
  EXPECT_EQ(FileNameOf("stop_guard-2"), "stop_guard-2.log");
  EXPECT_EQ(FileNameOf("map.server"), "map.server.log");
  EXPECT_EQ(FileNameOf("drivers/front lidar"), "drivers%2Ffront%20lidar.log");
}

TEST(FileNameOfTest, NothingLeavesTheFolderOrHides) {
  EXPECT_EQ(FileNameOf(""), "%.log");
  EXPECT_EQ(FileNameOf("."), "%2E.log");
  EXPECT_EQ(FileNameOf(".."), "%2E..log");
  EXPECT_EQ(FileNameOf("../x"), "%2E.%2Fx.log");
  EXPECT_EQ(FileNameOf("/etc/passwd"), "%2Fetc%2Fpasswd.log");
  EXPECT_EQ(FileNameOf(std::string("a\0\n\x1b", 4)), "a%00%0A%1B.log");
  EXPECT_EQ(FileNameOf("%"), "%25.log");
}

TEST(FileNameOfTest, NoTwoIdsShareAName) {
  std::vector<std::string> ids{"",
                               "%",
                               "%-",
                               "%2E",
                               ".",
                               "..",
                               "a",
                               "A",
                               "a.log",
                               "a.log.1",
                               "a%2F",
                               "a/",
                               "a/b",
                               "a%2Fb",
                               "a_b",
                               "a b"};
  for (std::size_t length = 150; length < 500; ++length) {
    ids.emplace_back(length, 'x');
    ids.push_back(std::string(length, 'x') + 'y');
    ids.emplace_back(length, '/');
  }
  ids.push_back(FileNameOf(std::string(400, 'x')));
  std::mt19937 random(11);
  for (int i = 0; i < 20'000; ++i) {
    std::string id(1 + random() % 4, ' ');
    for (char& c : id) c = "./%2Ea\n"[random() % 7];
    ids.push_back(id);
  }
  const std::set<std::string> different(ids.begin(), ids.end());
  std::set<std::string> names;
  for (const std::string& id : different) {
    const std::string name = FileNameOf(id);
    EXPECT_LE(name.size(), 204U);
    EXPECT_EQ(name.find('/'), std::string::npos);
    EXPECT_NE(name[0], '.');
    names.insert(name);
    // As RotatingLog names its older files.
    for (const char* suffix : {".1", ".2"}) EXPECT_TRUE(names.insert(name + suffix).second) << id;
  }

  EXPECT_EQ(names.size(), 3 * different.size());
}

TEST(FileNameOfTest, EachNameCanBeMade) {
  const test::TestFolder folder;
  for (const std::string& id : {std::string(), std::string("."), std::string(5000, '\0')}) {
    EXPECT_TRUE(std::ofstream(folder.path() / FileNameOf(id)).is_open());
  }
}

}  // namespace
}  // namespace clearway::host
