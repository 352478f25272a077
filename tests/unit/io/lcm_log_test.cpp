// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/lcm_log.hpp"

#include <fstream>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>

#include "common/io/read_error.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/io/temporary_folder.hpp"

namespace clearway::io {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;
using testing::Not;

// An event in a file: sync word, number, time, two lengths, channel, data.
constexpr std::size_t kEventHeaderBytes = 4 + 8 + 8 + 4 + 4;

std::vector<std::byte> RandomBytes(std::size_t size, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::byte> bytes(size);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() % 256);
  return bytes;
}

// Events of several sizes, none and many bytes among them.
std::vector<LogEvent> SomeEvents() {
  std::vector<LogEvent> events;
  for (const std::size_t size : {5U, 0U, 150U, 64U}) {
    events.push_back({1'700'000'000'000'000 + static_cast<std::int64_t>(size),
                      "CHANNEL_" + std::to_string(size),
                      RandomBytes(size, 1)});
  }
  return events;
}

std::size_t BytesOf(const LogEvent& event) {
  return kEventHeaderBytes + event.channel.size() + event.bytes.size();
}

void Write(const std::filesystem::path& path, const std::vector<LogEvent>& events) {
  LcmLogWriter writer(path);
  for (const LogEvent& event : events) writer.Write(event.utime, event.channel, event.bytes);
}

std::vector<LogEvent> ReadAll(const std::filesystem::path& path) {
  LcmLogReader reader(path);
  std::vector<LogEvent> events;
  while (auto event = reader.Next()) events.push_back(*std::move(event));
  EXPECT_FALSE(reader.Next().has_value()) << "the end stays the end";
  return events;
}

std::string Content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Expects the first `count` of the events.
void ExpectFirst(const std::vector<LogEvent>& actual,
                 const std::vector<LogEvent>& events,
                 std::size_t count) {
  ASSERT_EQ(actual.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(actual[i].utime, events[i].utime);
    EXPECT_EQ(actual[i].channel, events[i].channel);
    EXPECT_EQ(actual[i].bytes, events[i].bytes);
  }
}

TEST(LcmLogTest, WhatWasWrittenIsRead) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.lcm";

  Write(path, SomeEvents());

  ExpectFirst(ReadAll(path), SomeEvents(), SomeEvents().size());
}

TEST(LcmLogTest, ALogWithoutEventsIsEmpty) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "empty.lcm";

  Write(path, {});

  EXPECT_TRUE(ReadAll(path).empty());
}

TEST(LcmLogTest, AnExistingFileIsReplaced) {
  const TemporaryFolder folder;
  const auto path = folder.Write("a.lcm", std::string(100'000, 'x'));

  Write(path, SomeEvents());

  ExpectFirst(ReadAll(path), SomeEvents(), SomeEvents().size());
}

TEST(LcmLogTest, EventsCanBeReadBeforeTheWriterIsGone) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.lcm";
  const LogEvent event = SomeEvents().front();
  LcmLogWriter writer(path);

  writer.Write(event.utime, event.channel, event.bytes);

  ExpectFirst(ReadAll(path), {event}, 1);
}

TEST(LcmLogTest, ALogCutAnywhereEndsAtItsLastWholeEvent) {
  const TemporaryFolder folder;
  const auto whole = folder.path() / "whole.lcm";
  const std::vector<LogEvent> events = SomeEvents();
  Write(whole, events);
  const std::string content = Content(whole);

  std::size_t whole_events = 0;
  std::size_t next_end = BytesOf(events[0]);
  for (std::size_t size = 0; size < content.size(); ++size) {
    if (size == next_end) next_end += BytesOf(events[++whole_events]);
    const auto cut = folder.Write("cut.lcm", content.substr(0, size));

    ExpectFirst(ReadAll(cut), events, whole_events);
    if (HasFailure()) FAIL() << "cut after " << size << " bytes";
  }
}

TEST(LcmLogTest, GarbageBetweenEventsIsPassedOver) {
  const TemporaryFolder folder;
  const std::vector<LogEvent> events = SomeEvents();
  std::string content = "not an event";
  for (const LogEvent& event : events) {
    const auto one = folder.path() / "one.lcm";
    Write(one, {event});
    content += Content(one) + "\xED\xA1\xDAgarbage";
  }

  ExpectFirst(ReadAll(folder.Write("garbage.lcm", content)), events, events.size());
}

TEST(LcmLogTest, AnEventWithLengthsThatCannotBeIsPassedOver) {
  const TemporaryFolder folder;
  const LogEvent event = SomeEvents()[2];
  const auto one = folder.path() / "one.lcm";
  Write(one, {event});
  const std::string good = Content(one);

  for (const std::size_t at : {20U, 24U}) {  // The channel's length, the data's.
    for (const char first : {'\x80', '\xFF', '\x7F'}) {
      std::string bad = good;
      bad[at] = first;

      ExpectFirst(ReadAll(folder.Write("bad.lcm", bad + good)), {event}, 1);
    }
  }
}

TEST(LcmLogTest, NoFileOfAnyBytesIsMoreThanALogThatEnds) {
  const TemporaryFolder folder;
  const auto one = folder.path() / "one.lcm";
  Write(one, SomeEvents());
  const std::string good = Content(one);
  std::mt19937 random(5);

  for (int round = 0; round < 300; ++round) {
    std::string bad = good;
    for (int flips = 0; flips < 4; ++flips) {
      bad[random() % bad.size()] = static_cast<char>(random() % 256);
    }
    EXPECT_LE(ReadAll(folder.Write("bad.lcm", bad)).size(), SomeEvents().size());
  }
}

std::string WhyUnreadable(const std::filesystem::path& path) {
  try {
    const LcmLogReader reader(path);
  } catch (const ReadError& error) {
    return error.what();
  }
  return "readable";
}

TEST(LcmLogTest, AMissingFileIsAReadErrorOfOneLine) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "missing.lcm";

  EXPECT_EQ(WhyUnreadable(path), path.string() + ": cannot open: No such file or directory");
}

TEST(LcmLogTest, AFolderIsAReadErrorOfOneLine) {
  const TemporaryFolder folder;

  const std::string why = WhyUnreadable(folder.path());

  EXPECT_THAT(why, HasSubstr(folder.path().string() + ": "));
  EXPECT_THAT(why, HasSubstr("Is a directory"));
  EXPECT_THAT(why, Not(HasSubstr("\n")));
}

TEST(LcmLogTest, APathThatCannotBeWrittenIsAnErrorThatNamesIt) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "no_folder" / "a.lcm";

  try {
    const LcmLogWriter writer(path);
    FAIL() << "opened";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()),
              path.string() + ": cannot write: No such file or directory");
  }
}

TEST(LcmLogTest, AFullDiskIsAnErrorAtTheFirstEventThatDoesNotFit) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  LcmLogWriter writer("/dev/full");

  EXPECT_THROW(writer.Write(1, "A", RandomBytes(10, 1)), std::runtime_error);
}

TEST(LcmLogTest, LcmsOwnLibraryReadsWhatWasWritten) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.lcm";
  const std::vector<LogEvent> events = SomeEvents();
  Write(path, events);

  lcm::LogFile log(path.string(), "r");
  for (const LogEvent& expected : events) {
    const lcm::LogEvent* const event = log.readNextEvent();
    ASSERT_NE(event, nullptr);
    EXPECT_EQ(event->timestamp, expected.utime);
    EXPECT_EQ(event->channel, expected.channel);
    const auto* const data = static_cast<const std::byte*>(event->data);
    EXPECT_EQ(std::vector<std::byte>(data, data + event->datalen), expected.bytes);
  }
  EXPECT_EQ(log.readNextEvent(), nullptr);
}

TEST(LcmLogTest, ReadsWhatLcmsOwnLibraryWrote) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.lcm";
  std::vector<LogEvent> events = SomeEvents();
  {
    lcm::LogFile log(path.string(), "w");
    for (LogEvent& expected : events) {
      lcm::LogEvent event{};
      event.timestamp = expected.utime;
      event.channel = expected.channel;
      event.datalen = static_cast<std::int32_t>(expected.bytes.size());
      event.data = expected.bytes.data();
      ASSERT_EQ(log.writeEvent(&event), 0);
    }
  }

  ExpectFirst(ReadAll(path), events, events.size());
}

TEST(RecordedLcmLogTest, AGokartsLogIsReadToItsEnd) {
  const std::string name = "lcm/gokart_vlp16_ray.lcm";
  const auto path = test::TestData(name);
  if (!path) GTEST_SKIP() << test::MissingData(name);

  const auto events = ReadAll(*path);

  std::set<std::string> channels;
  for (const LogEvent& event : events) channels.insert(event.channel);
  EXPECT_EQ(events.size(), 161U);
  EXPECT_EQ(channels.size(), 2U);
}

TEST(RecordedLcmLogTest, LcmsOwnTestLogHasOneEvent) {
  const std::string name = "lcm/lcmlog-test.00";
  const auto path = test::TestData(name);
  if (!path) GTEST_SKIP() << test::MissingData(name);

  EXPECT_EQ(ReadAll(*path).size(), 1U);
}

TEST(RecordedLcmLogTest, ALogWrittenAgainIsTheSameFile) {
  const std::string name = "lcm/procman_ref_session.lcmlog";
  const auto path = test::TestData(name);
  if (!path) GTEST_SKIP() << test::MissingData(name);
  const TemporaryFolder folder;
  const auto copy = folder.path() / "copy.lcm";

  Write(copy, ReadAll(*path));

  EXPECT_EQ(Content(copy), Content(*path));
}

}  // namespace
}  // namespace clearway::io
