// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/rotating_log.hpp"

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_folder.hpp"

namespace clearway::host {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

// 2026-11-25 08:36:12.345678 UTC
constexpr std::int64_t kUtime = 1'795'595'772'345'678;
constexpr std::int64_t kLarge = 1'000'000'000;

std::string ContentOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void SetZone(const char* zone) {
  setenv("TZ", zone, 1);
  tzset();
}

class RotatingLogTest : public testing::Test {
 protected:
  RotatingLogTest() { SetZone("UTC0"); }
  ~RotatingLogTest() override { SetZone("UTC0"); }

  // All files, the oldest first.
  [[nodiscard]] std::string All() const {
    std::string all;
    for (int number = 99; number > 0; --number) all += ContentOf(Numbered(number));
    return all + ContentOf(path_);
  }
  [[nodiscard]] fs::path Numbered(int number) const {
    return path_.string() + "." + std::to_string(number);
  }

  test::TestFolder folder_;
  fs::path path_ = folder_.path() / "logs" / "command.log";
};

TEST_F(RotatingLogTest, EachLineHasTheTimeAtWhichItBegan) {
  RotatingLog log(path_, kLarge, 2);

  log.Write("one\ntwo\nthr", kUtime);
  log.Write("ee", kUtime + 1'000'000);
  log.Write("\n\nfive", kUtime + 2'000'000);

  EXPECT_EQ(ContentOf(path_),
            "2026-11-25T08:36:12.345+0000 one\n"
            "2026-11-25T08:36:12.345+0000 two\n"
            "2026-11-25T08:36:12.345+0000 three\n"
            "2026-11-25T08:36:14.345+0000 \n"
            "2026-11-25T08:36:14.345+0000 five");
  EXPECT_EQ(log.problem(), "");
  EXPECT_EQ(log.lost_bytes(), 0);
}

TEST_F(RotatingLogTest, TimeIsLocalAndNamesItsZone) {
  RotatingLog log(path_, kLarge, 2);
  SetZone("CET-1");
  log.Write("a\n", kUtime);
  SetZone("<+0545>-5:45");
  log.Write("b\n", kUtime + 1'000'000);
  SetZone("EST5");
  log.Write("c\n", 0);
  log.Write("d\n", -1);
  log.Write("e\n", 59'999'999);

  EXPECT_EQ(ContentOf(path_),
            "2026-11-25T09:36:12.345+0100 a\n"
            "2026-11-25T14:21:13.345+0545 b\n"
            "1969-12-31T19:00:00.000-0500 c\n"
            "1969-12-31T18:59:59.999-0500 d\n"
            "1969-12-31T19:00:59.999-0500 e\n");
}

TEST_F(RotatingLogTest, AnyTimeCanBeWritten) {
  RotatingLog log(path_, kLarge, 2);
  log.Write("a\n", INT64_MIN);
  log.Write("b\n", INT64_MAX);

  EXPECT_THAT(All(), HasSubstr(" a\n"));
  EXPECT_THAT(All(), HasSubstr(" b\n"));
}

TEST_F(RotatingLogTest, BytesStayAsTheyAre) {
  std::string bytes;
  for (int i = 0; i < 256; ++i) {
    if (i != '\n') bytes += static_cast<char>(i);
  }
  RotatingLog log(path_, kLarge, 2);

  log.Write(bytes + '\n', kUtime);

  EXPECT_EQ(ContentOf(path_), "2026-11-25T08:36:12.345+0000 " + bytes + '\n');
}

TEST_F(RotatingLogTest, ANoteStandsOnALineOfItsOwn) {
  RotatingLog log(path_, kLarge, 2);

  log.WriteNote("started, pid 123", kUtime);
  log.Write("half", kUtime);
  log.WriteNote("ended\nby itself", kUtime);
  log.Write(" of a line\n", kUtime);

  EXPECT_EQ(ContentOf(path_),
            "2026-11-25T08:36:12.345+0000 --- started, pid 123\n"
            "2026-11-25T08:36:12.345+0000 half\n"
            "2026-11-25T08:36:12.345+0000 --- ended by itself\n"
            "2026-11-25T08:36:12.345+0000  of a line\n");
}

TEST_F(RotatingLogTest, GoesOnWithWhatIsThere) {
  RotatingLog(path_, kLarge, 2).Write("first\nbroken off", kUtime);

  RotatingLog(path_, kLarge, 2).Write("second\n", kUtime);

  EXPECT_EQ(ContentOf(path_),
            "2026-11-25T08:36:12.345+0000 first\n"
            "2026-11-25T08:36:12.345+0000 broken off\n"
            "2026-11-25T08:36:12.345+0000 second\n");
}

TEST_F(RotatingLogTest, RotatesBetweenLines) {
  RotatingLog log(path_, 300, 3);
  const std::string line(90, 'x');  // 120 bytes with stamp and end: two in a file.

  for (int i = 0; i < 8; ++i) log.Write(line + '\n', kUtime);

  const std::string stamped = "2026-11-25T08:36:12.345+0000 " + line + '\n';
  EXPECT_EQ(ContentOf(path_), stamped + stamped);
  EXPECT_EQ(ContentOf(Numbered(1)), stamped + stamped);
  EXPECT_EQ(ContentOf(Numbered(2)), stamped + stamped);
  EXPECT_FALSE(fs::exists(Numbered(3)));
}

TEST_F(RotatingLogTest, ALineWithoutEndStaysWithinTheLimit) {
  RotatingLog log(path_, 1000, 3);

  for (int i = 0; i < 100; ++i) log.Write(std::string(70, 'x'), kUtime);

  EXPECT_LE(fs::file_size(path_), 1000U);
  EXPECT_EQ(ContentOf(Numbered(1)), std::string(1000, 'x'));
  EXPECT_EQ(ContentOf(Numbered(2)), std::string(1000, 'x'));
  log.Write("end\nnext\n", kUtime);
  EXPECT_THAT(ContentOf(path_), HasSubstr("xend\n2026-11-25T08:36:12.345+0000 next\n"));
}

TEST_F(RotatingLogTest, OneFileBeginsAnew) {
  RotatingLog log(path_, 300, 1);

  for (int i = 0; i < 10; ++i)
    log.Write(std::string(90, static_cast<char>('a' + i)) + '\n', kUtime);

  EXPECT_LE(fs::file_size(path_), 300U);
  EXPECT_THAT(ContentOf(path_), HasSubstr("jjj"));
  EXPECT_FALSE(fs::exists(Numbered(1)));
}

// Lines of all lengths and bytes, cut anywhere. Sometimes longer than a file.
std::vector<std::string> RandomChunks(std::mt19937& random, int count) {
  std::vector<std::string> chunks;
  for (int i = 0; i < count; ++i) {
    std::string chunk(random() % (random() % 50 == 0 ? 3000 : 120), ' ');
    for (char& c : chunk) c = static_cast<char>(random() % 40 == 0 ? '\n' : random() % 256);
    chunks.push_back(chunk);
  }
  return chunks;
}

class RotatingLogPropertyTest : public RotatingLogTest,
                                public testing::WithParamInterface<unsigned> {};

TEST_P(RotatingLogPropertyTest, NothingIsLostWithinTheLimits) {
  std::mt19937 random(GetParam());
  const std::vector<std::string> chunks = RandomChunks(random, 300);
  RotatingLog log(path_, 4000 + static_cast<std::int64_t>(random() % 3000), 60);
  std::string text;
  for (const std::string& chunk : chunks) {
    log.Write(chunk, kUtime);
    text += chunk;
  }

  ASSERT_TRUE(fs::exists(Numbered(3)));
  const std::string all = All();
  const std::string stamp = "2026-11-25T08:36:12.345+0000 ";
  std::string without_stamps;
  for (std::size_t begin = 0; begin < all.size();) {
    const std::size_t end = std::min(all.find('\n', begin), all.size() - 1) + 1;
    ASSERT_EQ(all.compare(begin, stamp.size(), stamp), 0) << begin;
    without_stamps += all.substr(begin + stamp.size(), end - begin - stamp.size());
    begin = end;
  }
  EXPECT_TRUE(without_stamps == text);
  EXPECT_EQ(log.lost_bytes(), 0);
}

TEST_P(RotatingLogPropertyTest, IsBoundedAndKeepsTheEnd) {
  std::mt19937 random(GetParam());
  const std::int64_t max_bytes =
      RotatingLog::kMinBytes + static_cast<std::int64_t>(random() % 2000);
  const int num_files = 1 + static_cast<int>(random() % 5);
  const fs::path unlimited_path = folder_.path() / "unlimited";
  RotatingLog unlimited(unlimited_path, kLarge, 1);
  RotatingLog log(path_, max_bytes, num_files);
  for (const std::string& chunk : RandomChunks(random, 400)) {
    const std::int64_t utime = kUtime + static_cast<std::int64_t>(random() % 1'000'000'000);
    if (random() % 30 == 0) {
      log.WriteNote("a note", utime);
      unlimited.WriteNote("a note", utime);
    }
    log.Write(chunk, utime);
    unlimited.Write(chunk, utime);
    for (int number = 0; number < num_files; ++number) {
      const fs::path file = number == 0 ? path_ : Numbered(number);
      if (!fs::exists(file)) continue;
      ASSERT_LE(fs::file_size(file), static_cast<std::uintmax_t>(max_bytes));
    }
  }

  EXPECT_FALSE(fs::exists(Numbered(num_files)));
  EXPECT_TRUE(ContentOf(unlimited_path).ends_with(All()));
  EXPECT_FALSE(All().empty());
}

INSTANTIATE_TEST_SUITE_P(Seeds, RotatingLogPropertyTest, testing::Range(1U, 25U));

TEST_F(RotatingLogTest, RefusesWhatCannotBe) {
  EXPECT_THROW(RotatingLog(path_, RotatingLog::kMinBytes - 1, 2), std::invalid_argument);
  EXPECT_THROW(RotatingLog(path_, kLarge, 0), std::invalid_argument);
  EXPECT_THROW(RotatingLog(folder_.Write("file", "") / "log", kLarge, 2), std::runtime_error);
  EXPECT_THROW(RotatingLog(folder_.path(), kLarge, 2), std::runtime_error);
}

}  // namespace
}  // namespace clearway::host
