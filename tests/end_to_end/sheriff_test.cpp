// SPDX-License-Identifier: BSD-3-Clause
// clearway-sheriff as users start it, with real deputies.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "tests/support/deputy_fixture.hpp"

namespace clearway::test {
namespace {

using testing::HasSubstr;

constexpr char kFile[] = R"(
group "sense" {
  cmd "lidar" { exec = "sh -c 'while true; do echo tick; sleep 0.2; done'"; deputy = "d1"; auto_respawn = "true"; }
  cmd "once" { exec = "sh -c 'exit 0'"; deputy = "d1"; }
}
cmd "broken" { exec = "sh -c 'exit 3'"; deputy = "d2"; }
cmd "stubborn" { exec = "sh -c 'trap true INT; while true; do sleep 0.1; done'"; deputy = "d2"; stop_time_allowed = 1; }
script "up" { start group "sense" wait "running"; wait ms 100; start cmd "stubborn" wait "running"; }
)";

class SheriffProgramTest : public DeputyProgramTest {
 protected:
  std::string Write(const std::string& name, const std::string& text) const {
    const std::filesystem::path path = folder_.path() / name;
    std::ofstream(path) << text;
    return path.string();
  }

  ProgramResult Sheriff(std::vector<std::string> words) const {
    words.insert(words.begin(), {Program("sheriff"), "--lcm-url", url_ + "?ttl=0"});
    return RunProgram(words, folder_.path());
  }
};

TEST_F(SheriffProgramTest, OneShotVerbsDoWhatTheySayAndTellByTheirExitStatus) {
  StartDeputyAndAwait("d1");
  StartDeputyAndAwait("d2");
  const std::string file = Write("test.pmd", kFile);

  const ProgramResult up = Sheriff({file, "run", "up"});
  EXPECT_EQ(up.exit_status, 0) << up.err;
  EXPECT_THAT(up.out, HasSubstr("lidar: Running\nonce: Stopped, exited with 0\n"));
  const ProgramResult broken = Sheriff({file, "start", "broken"});
  EXPECT_EQ(broken.exit_status, 70);
  EXPECT_THAT(broken.err, HasSubstr("broken: Failed, exited with 3"));
  const ProgramResult status = Sheriff({"--json"});
  EXPECT_EQ(status.exit_status, 0) << status.err;
  EXPECT_EQ(nlohmann::json::parse(status.out).at("commands").size(), 4U);
  const ProgramResult restart = Sheriff({"restart", "stubborn"});
  EXPECT_EQ(restart.exit_status, 0) << restart.err;
  EXPECT_EQ(Sheriff({file, "stop", "everything", "--timeout", "0.2"}).exit_status, 75);
  const ProgramResult stop = Sheriff({"stop", "everything"});
  EXPECT_EQ(stop.exit_status, 0) << stop.err;
  EXPECT_EQ(PidWith("echo tick"), 0);
}

TEST_F(SheriffProgramTest, AMistypedWordIsToldWithThoseThatThereAre) {
  const std::string file = Write("test.pmd", kFile);

  EXPECT_THAT(Sheriff({file, "run", "upp"}).err, HasSubstr("has no script \"upp\"; known: up"));
  EXPECT_THAT(Sheriff({file, "sart", "lidar"}).err,
              HasSubstr("\"sart\" is no verb; verbs: status,"));
  const ProgramResult word = Sheriff({"staus"});
  EXPECT_EQ(word.exit_status, 64);
  EXPECT_THAT(word.err, HasSubstr("\"staus\" is no file and no verb; verbs: status, start"));
  const ProgramResult path = Sheriff({"tset.pmd", "status"});
  EXPECT_EQ(path.exit_status, 78);
  EXPECT_THAT(path.err, HasSubstr("tset.pmd: no such file"));
}

TEST_F(SheriffProgramTest, ACommandMovesByOneWord) {
  StartDeputyAndAwait("d1");
  StartDeputyAndAwait("d2");
  const std::string text = "cmd \"a\" { exec = \"sleep 7301\"; deputy = \"DEPUTY\"; }";
  const auto for_deputy = [&](const std::string& deputy) {
    std::string copy = text;
    copy.replace(copy.find("DEPUTY"), 6, deputy);
    return Write(deputy + ".pmd", copy);
  };
  ASSERT_EQ(Sheriff({for_deputy("d1"), "start", "a"}).exit_status, 0);
  ASSERT_TRUE(peer_.AwaitRunning("d1", "a", 1));

  const ProgramResult moved = Sheriff({for_deputy("d2"), "start", "a"});

  EXPECT_EQ(moved.exit_status, 0) << moved.err;
  EXPECT_TRUE(peer_.AwaitRunning("d2", "a", 1));
  EXPECT_TRUE(peer_.Await([&] { return peer_.Command("d1", "a").spec.id.empty(); }));
}

TEST_F(SheriffProgramTest, WhatCannotBeIsRefusedWithTheReason) {
  const std::string file = Write("test.pmd", kFile);
  const std::string bad =
      Write("bad.pmd", "cmd \"a\" { exec = \"x\"; }\ncmd \"b\" { oops = 1; }\n");

  EXPECT_EQ(Sheriff({file, "check"}).exit_status, 0);
  const ProgramResult wrong = Sheriff({bad, "check"});
  EXPECT_EQ(wrong.exit_status, 78);
  EXPECT_THAT(wrong.err, HasSubstr("bad.pmd:1:"));
  EXPECT_THAT(wrong.err, HasSubstr("bad.pmd:2:"));
  EXPECT_EQ(Sheriff({folder_.path() / "none.pmd", "status"}).exit_status, 78);
  EXPECT_EQ(Sheriff({file, "start"}).exit_status, 64);
  EXPECT_EQ(Sheriff({"start", "everything"}).exit_status, 64);
  EXPECT_EQ(Sheriff({file, "dance"}).exit_status, 64);
  EXPECT_EQ(Sheriff({file, "run", "nothing"}).exit_status, 64);
  EXPECT_EQ(Sheriff({file, "status", "--nonsense"}).exit_status, 64);
  EXPECT_EQ(Sheriff({file, "status", "-u", "tcp://x"}).exit_status, 64);
  EXPECT_EQ(Sheriff({file, "status"}).exit_status, 69);
  EXPECT_EQ(Sheriff({file, "start", "everything"}).exit_status, 69);
  EXPECT_EQ(Sheriff({"status"}).exit_status, 69);
}

TEST_F(SheriffProgramTest, AnotherSheriffKeepsItOut) {
  StartDeputyAndAwait("d1");
  StartDeputyAndAwait("d2");
  const std::string file = Write("test.pmd", kFile);
  // A script that does not end: its sheriff goes on giving orders.
  const std::string endless = Write("endless.pmd",
                                    "cmd \"other\" { exec = \"sleep 70\"; deputy = \"d1\"; }\n"
                                    "script \"long\" { start everything; wait ms 600000; }");
  host::ChildProcess other(
      "other",
      {Program("sheriff"), "--lcm-url", url_ + "?ttl=0", endless, "run", "long"},
      folder_.path() / "other.log");
  ASSERT_TRUE(peer_.AwaitRunning("d1", "other", 1)) << other.LastWords();

  const ProgramResult start = Sheriff({file, "start", "lidar"});

  EXPECT_EQ(start.exit_status, 77) << start.err;
  EXPECT_THAT(start.err, HasSubstr("--force"));
  other.Signal(SIGINT);
  EXPECT_EQ(other.WaitOrKill(5'000), 70);
  EXPECT_EQ(Sheriff({file, "start", "lidar"}).exit_status, 0) << "its process has ended";
}

}  // namespace
}  // namespace clearway::test
