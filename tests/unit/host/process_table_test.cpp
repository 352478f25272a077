// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/process_table.hpp"

#include <string>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

namespace clearway::host {
namespace {

const std::string kNumbers =
    " S 100 4711 4711 34816 4711 4194304 1000 2 3 4 150 50 6 7 20 0 1 0 98765 10485760 256 "
    "18446744073709551615 1 1 0 0 0 0 0 0 0 0 0 0 17 1 0 0 0 0 0 0 0 0 0 0 0 0 0\n";

std::string StatOf(const std::string& name) {
  return "4712 (" + name + ")" + kNumbers;
}

class HostileNameTest : public testing::TestWithParam<std::string> {};

TEST_P(HostileNameTest, IsNoPartOfTheNumbers) {
  const auto entry = ParseStat(StatOf(GetParam()));

  ASSERT_TRUE(entry.has_value());
  EXPECT_EQ(entry->pid, 4712);
  EXPECT_EQ(entry->state, 'S');
  EXPECT_EQ(entry->ppid, 100);
  EXPECT_EQ(entry->pgrp, 4711);
  EXPECT_EQ(entry->session, 4711);
  EXPECT_EQ(entry->cpu_ticks, 200U);
  EXPECT_EQ(entry->start_ticks, 98765U);
  EXPECT_EQ(entry->vsize_bytes, 10485760);
  EXPECT_EQ(entry->rss_bytes, 256 * sysconf(_SC_PAGESIZE));
}

INSTANTIATE_TEST_SUITE_P(All,
                         HostileNameTest,
                         testing::Values("sleep",
                                         "",
                                         " ",
                                         "a b",
                                         ")",
                                         "(",
                                         "a) b (c",
                                         "a) R 1 1 1",
                                         ") S 1 2 3 4 5",
                                         "))))(((",
                                         "line\nend",
                                         "1 (2) 3",
                                         "\xff\x01\t"));

TEST(ParseStatTest, ATextThatIsCutGivesNothing) {
  const std::string text = StatOf("a) b (c");
  const std::size_t whole = text.find(" 256 ") + 5;
  for (std::size_t size = 0; size < text.size(); ++size) {
    const std::string cut = text.substr(0, size);  // Of its own, for the address sanitizer.
    EXPECT_EQ(ParseStat(cut).has_value(), size >= whole) << size;
  }
}

TEST(ParseStatTest, RefusesWhatIsNoNumber) {
  for (const char* text : {"x (a) S 1 1 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 \n",
                           "1 (a) S x 1 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 \n",
                           "1 (a) S 1 1 1 0 0 0 0 0 0 0 -1 0 0 0 0 0 0 0 0 0 0 \n",
                           "1 (a) SS 1 1 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 \n",
                           "99999999999 (a) S 1 1 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 \n",
                           ") (",
                           ")",
                           " (",
                           "\n"}) {
    EXPECT_FALSE(ParseStat(text).has_value()) << text;
  }
}

ProcessEntry Entry(pid_t pid, pid_t ppid) {
  ProcessEntry entry;
  entry.pid = pid;
  entry.ppid = ppid;
  return entry;
}

std::vector<pid_t> PidsOf(const std::vector<ProcessEntry>& entries) {
  std::vector<pid_t> pids;
  for (const ProcessEntry& entry : entries) pids.push_back(entry.pid);
  return pids;
}

using Pids = std::vector<pid_t>;

TEST(ProcessTableTest, IsSortedAndFindsByPid) {
  const ProcessTable table({Entry(30, 1), Entry(1, 0), Entry(20, 1)});

  EXPECT_EQ(PidsOf(table.entries()), (Pids{1, 20, 30}));
  ASSERT_NE(table.Find(20), nullptr);
  EXPECT_EQ(table.Find(20)->pid, 20);
  for (const pid_t pid : {-1, 0, 2, 25, 31}) EXPECT_EQ(table.Find(pid), nullptr);
  EXPECT_EQ(ProcessTable().Find(1), nullptr);
}

TEST(ProcessTableTest, DescendantsAreAllGenerationsOfOneProcess) {
  // 10 has 40 and 12; 40 has 5 and 50; 50 has 60.
  const ProcessTable table({Entry(1, 0),
                            Entry(10, 1),
                            Entry(40, 10),
                            Entry(12, 10),
                            Entry(5, 40),
                            Entry(50, 40),
                            Entry(60, 50),
                            Entry(11, 1),
                            Entry(70, 11)});

  EXPECT_EQ(PidsOf(table.Descendants(10)), (Pids{5, 12, 40, 50, 60}));
  EXPECT_EQ(PidsOf(table.Descendants(50)), (Pids{60}));
  EXPECT_TRUE(table.Descendants(60).empty());
  EXPECT_TRUE(table.Descendants(999).empty());
  EXPECT_TRUE(ProcessTable().Descendants(1).empty());
}

TEST(ProcessTableTest, APidIsThereOnce) {
  const ProcessTable table({Entry(10, 1), Entry(10, 11), Entry(11, 10)});

  EXPECT_EQ(PidsOf(table.entries()), (Pids{10, 11}));
  EXPECT_LE(table.Descendants(1).size(), 2U);
}

TEST(ProcessTableTest, ACircleIsNoTrap) {
  const ProcessTable table({Entry(10, 12), Entry(11, 10), Entry(12, 11), Entry(20, 20)});

  EXPECT_EQ(PidsOf(table.Descendants(10)), (Pids{11, 12}));
  EXPECT_TRUE(table.Descendants(20).empty());
}

TEST(ProcessTableTest, HoldsThisProcess) {
  const ProcessTable table = ProcessTable::Read();

  const ProcessEntry* const entry = table.Find(getpid());

  ASSERT_NE(entry, nullptr);
  EXPECT_EQ(entry->ppid, getppid());
  EXPECT_EQ(entry->pgrp, getpgrp());
  EXPECT_EQ(entry->session, getsid(0));
  EXPECT_EQ(entry->state, 'R');
  EXPECT_GT(entry->rss_bytes, 0);
  EXPECT_GE(entry->vsize_bytes, entry->rss_bytes);
  EXPECT_EQ(entry->start_ticks, ReadProcess(getpid())->start_ticks);
}

TEST(ProcessTableTest, NoProcessHasNoEntry) {
  EXPECT_FALSE(ReadProcess(-1).has_value());
  EXPECT_FALSE(ReadProcess(2'000'000'000).has_value());
}

TEST(SecondsOfTest, CountsTheSystemsTicks) {
  EXPECT_DOUBLE_EQ(SecondsOf(static_cast<std::uint64_t>(sysconf(_SC_CLK_TCK)) * 3), 3.0);
}

}  // namespace
}  // namespace clearway::host
