// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/terminal_child.hpp"

#include <array>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <memory>
#include <stdexcept>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <dirent.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include "common/host/process_table.hpp"
#include "common/host/reaping.hpp"
#include "tests/support/test_folder.hpp"
#include "tests/unit/host/started_child.hpp"

namespace clearway::host {
namespace {

using test::StartedChild;
using test::TestChild;
using test::TestFolder;
using testing::HasSubstr;

std::size_t NumDescriptors() {
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(opendir("/proc/self/fd"), closedir);
  std::size_t count = 0;
  while (readdir(folder.get()) != nullptr) ++count;
  return count;
}

TEST(TerminalChildTest, LeadsASessionAndGroupOfItsOwnOnATerminal) {
  StartedChild child(TestChild({"terminal"}));

  EXPECT_EQ(child.ReadToEnd(), "terminals 1 session 1 group 1 foreground 1\n");
  EXPECT_EQ(child.Reap(), 0);
}

TEST(TerminalChildTest, HandsOutputOnByteByByte) {
  const std::string text = "one\ntwo\r\n\ttab \x01\x04\x7f\xff end";

  EXPECT_EQ(StartedChild(TestChild({"say", text})).ReadToEnd(), text);
  EXPECT_EQ(StartedChild(TestChild({"complain", text})).ReadToEnd(), text);
}

TEST(TerminalChildTest, TenMegabytesComeWholeAndUnchanged) {
  constexpr std::size_t kBytes = 10'000'000;
  StartedChild child(TestChild({"flood", std::to_string(kBytes)}));

  const std::string output = child.ReadToEnd();

  ASSERT_EQ(output.size(), kBytes);
  std::size_t num_wrong = 0;
  for (std::size_t i = 0; i < kBytes; ++i) {
    num_wrong += output[i] == static_cast<char>(i % 257 % 256) ? 0U : 1U;
  }
  EXPECT_EQ(num_wrong, 0U);
  EXPECT_EQ(child.Reap(), 0);
}

TEST(TerminalChildTest, LastWordsAreNotLostWithAQuickEnd) {
  for (int i = 0; i < 100; ++i) {
    StartedChild child(TestChild({"say", "last words"}));
    EXPECT_EQ(child.Reap(), 0);  // Before anything is read.
    ASSERT_EQ(child.ReadToEnd(), "last words") << i;
  }
}

TEST(TerminalChildTest, NothingToReadIsNotTheEnd) {
  StartedChild child(TestChild({"wait"}));
  ASSERT_EQ(child.ReadLine(), "ready");
  std::array<char, 16> buffer{};

  const OutputPart part = ReadOutput(child.child().output_fd, buffer);

  EXPECT_EQ(part.size, 0U);
  EXPECT_FALSE(part.is_over);
}

TEST(TerminalChildTest, HasNoDescriptorButTheTerminal) {
  // Some that would be inherited.
  const Descriptor null(open("/dev/null", O_RDONLY));
  const Descriptor high(fcntl(null.get(), F_DUPFD, 500));

  EXPECT_EQ(StartedChild(TestChild({"descriptors"})).ReadToEnd(), "3\n");
}

TEST(TerminalChildTest, HasNoSignalBlockedOrIgnored) {
  sigset_t some;
  sigset_t before;
  sigemptyset(&some);
  for (const int signal : {SIGTERM, SIGINT, SIGCHLD, SIGUSR1}) sigaddset(&some, signal);
  pthread_sigmask(SIG_BLOCK, &some, &before);
  const auto pipe_before = std::signal(SIGPIPE, SIG_IGN);
  const auto hangup_before = std::signal(SIGHUP, SIG_IGN);

  const std::string signals = StartedChild(TestChild({"signals"})).ReadToEnd();

  sigset_t after;
  pthread_sigmask(SIG_SETMASK, &before, &after);
  std::signal(SIGPIPE, pipe_before);
  std::signal(SIGHUP, hangup_before);
  EXPECT_EQ(signals, "SigBlk:\t0000000000000000\nSigIgn:\t0000000000000000\n");
  EXPECT_EQ(sigismember(&after, SIGTERM), 1);
  EXPECT_EQ(sigismember(&after, SIGUSR2), 0);
}

TEST(TerminalChildTest, GetsArgumentsAndEnvironmentAsTheyAre) {
  ChildSettings settings = TestChild({"environment"});
  settings.environment = {"A=1", "B=two words", "EMPTY=", "A=again"};

  EXPECT_EQ(StartedChild(settings).ReadToEnd(), "A=1\nB=two words\nEMPTY=\nA=again\n");
  EXPECT_EQ(StartedChild(TestChild({"say", ""})).ReadToEnd(), "");
  EXPECT_EQ(StartedChild(TestChild({"say", "$HOME *"})).ReadToEnd(), "$HOME *");
}

TEST(TerminalChildTest, RunsInItsFolder) {
  const TestFolder folder;
  ChildSettings settings = TestChild({"folder"});
  settings.working_folder = folder.path();

  EXPECT_EQ(StartedChild(settings).ReadToEnd(), folder.path().string() + "\n");
}

TEST(TerminalChildTest, ARelativeProgramIsSoughtHereNotInItsFolder) {
  ChildSettings settings = TestChild({"say", "here"});
  settings.program = std::filesystem::relative(TEST_CHILD);
  settings.working_folder = "/";

  EXPECT_EQ(StartedChild(settings).ReadToEnd(), "here");
}

TEST(TerminalChildTest, SaysWhyItCannotRun) {
  const TestFolder folder;
  const std::string text = folder.Write("text", "no program");
  const auto says = [](const ChildSettings& settings) {
    StartedChild child(settings);
    std::string output = child.ReadToEnd();
    EXPECT_EQ(child.Reap(), 255 << 8);
    return output;
  };
  ChildSettings settings = TestChild({});

  settings.program = "/no/such/program";
  EXPECT_EQ(says(settings), "cannot run /no/such/program: No such file or directory\n");

  settings.program = text;
  EXPECT_EQ(says(settings), "cannot run " + text + ": Permission denied\n");

  std::filesystem::permissions(text, std::filesystem::perms::owner_all);
  EXPECT_EQ(says(settings), "cannot run " + text + ": Exec format error\n");

  settings = TestChild({});
  settings.working_folder = "/no/such/folder";
  EXPECT_EQ(says(settings),
            std::string("cannot run ") + TEST_CHILD +
                ": cannot enter /no/such/folder: No such file or directory\n");
}

TEST(TerminalChildTest, RefusesWhatCannotReachAProgram) {
  ChildSettings settings = TestChild({std::string("a\0b", 3)});
  EXPECT_THROW((void)StartOnTerminal(settings), std::invalid_argument);

  settings = TestChild({});
  settings.environment = {std::string("A=\0", 3)};
  EXPECT_THROW((void)StartOnTerminal(settings), std::invalid_argument);

  settings = TestChild({});
  settings.working_folder = std::string("/\0tmp", 5);
  EXPECT_THROW((void)StartOnTerminal(settings), std::invalid_argument);

  settings = TestChild({});
  settings.arguments.clear();
  EXPECT_THROW((void)StartOnTerminal(settings), std::invalid_argument);
}

TEST(TerminalChildTest, ThrowsWhenNoDescriptorIsLeftAndKeepsNone) {
  const std::size_t before = NumDescriptors();
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &limit), 0);
  int num_failed = 0;
  for (rlim_t room = 0; room < 6; ++room) {
    const int next = dup(STDIN_FILENO);  // The lowest that is free.
    close(next);
    const rlimit tight{static_cast<rlim_t>(next) + room, limit.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &tight), 0);
    try {
      const TerminalChild child = StartOnTerminal(TestChild({"exit", "0"}));
      setrlimit(RLIMIT_NOFILE, &limit);
      close(child.output_fd);
      waitpid(child.pid, nullptr, 0);
    } catch (const std::runtime_error& error) {
      setrlimit(RLIMIT_NOFILE, &limit);
      EXPECT_THAT(error.what(), HasSubstr("terminal"));
      EXPECT_THAT(error.what(), HasSubstr("Too many open files"));
      ++num_failed;
    }
  }

  EXPECT_GE(num_failed, 2);
  EXPECT_TRUE(ReapAll().empty());
  EXPECT_EQ(NumDescriptors(), before);
}

TEST(TerminalChildTest, KnowsWhoItIsWhenItStarts) {
  StartedChild child(TestChild({"wait"}));

  const auto entry = ReadProcess(child.pid());

  ASSERT_TRUE(entry.has_value());
  EXPECT_EQ(entry->start_ticks, child.child().start_ticks);
  EXPECT_EQ(entry->ppid, getpid());
}

// As a deputy that was started without standard descriptors.
TEST(TerminalChildTest, CanBeStartedByAProcessWithoutStandardDescriptors) {
  std::array<Descriptor, 3> saved;
  for (int fd = 0; fd < 3; ++fd) saved.at(std::size_t(fd)) = Descriptor(fcntl(fd, F_DUPFD, 10));
  for (int fd = 0; fd < 3; ++fd) close(fd);

  std::string output;
  {
    StartedChild child(TestChild({"terminal"}));
    output = child.ReadToEnd();
  }

  for (int fd = 0; fd < 3; ++fd) dup2(saved.at(std::size_t(fd)).get(), fd);
  EXPECT_EQ(output, "terminals 1 session 1 group 1 foreground 1\n");
}

}  // namespace
}  // namespace clearway::host
