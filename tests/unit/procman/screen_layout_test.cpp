// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "processes/procman_sheriff/text_cells.hpp"
#include "tests/unit/procman/screen_bed.hpp"

namespace clearway::screen {
namespace {

using core::procman::ScriptRunner;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kSmallRobotAt80x24 =
    R"( robot.pmd  2/5 ready  1 IN TROUBLE  1 HOST SILENT         in command  12:34:56
   HOST STATE        CPU%        MEMORY CMDS NOTE
 ! arm  SILENT 12 s     -             -    3
   rig  heard 0.4 s    23    2.9/7.6 GB    3
   COMMAND          STATE         STARTS     PID CPU%  MEMORY WHY
 ! everything       2/5 ready     1 IN TROUBLE  1 running, not ready  1 unknown
 ! sense/           2/3 ready     1 IN TROUBLE
     lidar-driver   Running            1    4711  3.1   46 MB
 !   perceive/      1/2 ready     1 IN TROUBLE
       preprocessor Running            1    4711  3.1   46 MB
>!     clusterer    Gave up            5 ended 5 times within 3 s of its start..
 ~ stop-guard       Getting ready      1    4711 has not said yet that it is r..
 ? hand/            0/1 ready     1 unknown
 ?   gripper        Unknown            1 deputy arm is silent
OUTPUT of clusterer on rig: clusterer --config lab.xml
ended 5 times within 3 s of its start; last exit status 1
clusterer: cannot read lab.xml: no such file






 s start  t stop  r restart  Enter output  x scripts  ? help  q quit  ! trouble
)";

TEST(ScreenLayout, IsThisAt80x24) {
  ScreenBed bed;
  bed.Select("clusterer");
  bed.output.Of("clusterer").Add("clusterer: cannot read lab.xml: no such file\r\n");

  EXPECT_EQ(bed.Text(), kSmallRobotAt80x24);
}

// Many hosts and commands with long names and texts, in every status.
ScreenContent LargeRobot(const std::string& letter) {
  ScreenContent content = SmallRobot();
  Snapshot& snapshot = content.snapshot;
  const auto many = [&letter](int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += letter;
    return text;
  };
  snapshot.file = "/etc/" + many(70) + "/robot.pmd";
  for (int i = 0; i < 30; ++i) {
    snapshot.deputies.push_back(Host(many(i) + std::to_string(i)));
    snapshot.deputies.back().text = i % 7 == 0 ? many(100) : "";
    snapshot.deputies.back().version = i % 5 == 0 ? "2.0.0" : "1.0.0";
  }
  for (int i = 0; i < 70; ++i) {
    const auto status = static_cast<Status>(i % core::procman::kStatusCount);
    CommandView command = Command(many(i % 40) + std::to_string(i), many(i % 9) + "/b", status);
    command.text = i % 3 == 0 ? many(200) + "\n\x1b[31m" : "";
    command.differs = i % 4 == 0 ? many(50) : "";
    command.mem_rss_bytes = std::int64_t{1} << (i % 63);
    command.pid = i % 2 == 0 ? 4194304 : command.pid;
    command.cpu_usage = i % 5 == 0 ? 1e30F : 0.5F;
    command.starts = i * 1000;
    snapshot.commands.push_back(command);
  }
  CountGroups(snapshot);
  content.progress = {.state = ScriptRunner::State::kFailed, .script = many(40), .text = many(300)};
  for (int i = 0; i < 60; ++i) content.scripts.push_back({.name = many(i), .actions = {{}, {}}});
  return content;
}

class ScreenLayoutSizeTest : public testing::TestWithParam<const char*> {};

TEST_P(ScreenLayoutSizeTest, FitsEverySize) {
  ScreenBed bed(LargeRobot(GetParam()));
  for (int i = 0; i < 300; ++i) bed.messages.Add(GetParam() + std::string("\n"));
  // Each mode, and each way of the last line.
  const std::vector<std::vector<KeyPress>> doings = {
      {},
      {{KeyPress::Kind::kEnd}},
      {{KeyPress::Kind::kHome}, {KeyPress::Kind::kCharacter, 't'}},
      {{KeyPress::Kind::kEscape}, {KeyPress::Kind::kEnter}, {KeyPress::Kind::kPageUp}},
      {{KeyPress::Kind::kEscape}, {KeyPress::Kind::kCharacter, 'x'}, {KeyPress::Kind::kEnd}},
      {{KeyPress::Kind::kEscape}, {KeyPress::Kind::kCharacter, '?'}},
  };
  for (const auto& keys : doings) {
    for (const KeyPress& key : keys) bed.Press(key);
    for (int rows = 10; rows <= 60; ++rows) {
      for (int columns = 40; columns <= 200; columns += rows == 24 ? 1 : 13) {
        bed.size = {columns, rows};
        bed.model.Fit(RowsOf(bed.model, bed.size));

        const std::vector<Line> lines = bed.Lines();

        ASSERT_EQ(lines.size(), static_cast<std::size_t>(rows));
        for (const Line& line : lines) {
          const std::string text = TextOf(line);
          ASSERT_LE(CellsOf(std::string_view(text)), columns) << text;
          ASSERT_EQ(Printable(text), text);
        }
        if (bed.model.mode() != ScreenModel::Mode::kTable) continue;
        ASSERT_EQ(
            std::count_if(lines.begin(), lines.end(), [](const Line& l) { return l.is_selected; }),
            1)
            << columns << " x " << rows;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(NarrowAndWide, ScreenLayoutSizeTest, testing::Values("m", "\u4e2d"));

TEST(ScreenLayout, EveryStatusIsNamedAtEveryWidth) {
  ScreenContent content;
  for (int i = 0; i < core::procman::kStatusCount; ++i) {
    const auto status = static_cast<Status>(i);
    content.snapshot.commands.push_back(Command("c" + std::to_string(i), "", status));
  }
  CountGroups(content.snapshot);
  for (int columns = 40; columns <= 200; ++columns) {
    ScreenBed bed(content, {columns, 40});

    const std::string text = bed.Text();

    for (const CommandView& command : content.snapshot.commands) {
      const std::string word(WordsFor(command.status));
      const std::size_t at = text.find(" " + command.id + " ");
      ASSERT_NE(at, std::string::npos);
      const std::string line = text.substr(at, text.find('\n', at) - at);
      ASSERT_THAT(line, HasSubstr(word)) << columns;
      const bool is_marked = text[at - 1] == '!';
      ASSERT_EQ(is_marked, IsTrouble(command.status)) << line;
    }
  }
}

TEST(ScreenLayout, TroubleThatIsNotInSightIsTold) {
  ScreenContent content;
  for (int i = 0; i < 60; ++i) {
    const Status status = i == 59 ? Status::kFailed : Status::kRunning;
    content.snapshot.commands.push_back(Command("c" + std::to_string(i), "", status));
  }
  CountGroups(content.snapshot);
  ScreenBed bed(content);

  EXPECT_THAT(bed.Text(), HasSubstr("1 IN TROUBLE"));
  EXPECT_THAT(bed.Text(), HasSubstr("  1-13 of 61, 1 more in trouble: !"));
  bed.Press('!');
  EXPECT_EQ(bed.Selected(), "c59");
  EXPECT_THAT(bed.Text(), Not(HasSubstr("more in trouble")));
}

TEST(ScreenLayout, HostsInTroubleHaveALineEvenWhenNotAllHave) {
  ScreenContent content;
  for (int i = 0; i < 20; ++i) content.snapshot.deputies.push_back(Host("h" + std::to_string(i)));
  content.snapshot.deputies[17].is_heard = false;
  content.snapshot.deputies[17].age_us = -1;
  content.snapshot.deputies[18].config_digest = "bbbbbbbbbbbb";
  CountGroups(content.snapshot);
  ScreenBed bed(content);

  EXPECT_THAT(bed.Text(), HasSubstr(" ! h17  NEVER HEARD"));
  EXPECT_THAT(bed.Text(), HasSubstr("is one running, with this id and"));
  EXPECT_THAT(bed.Text(), HasSubstr("config differs: bbbbbbbb"));
  EXPECT_THAT(bed.Text(), HasSubstr("and 17 more: all well"));
  bed.size = {80, 12};
  EXPECT_THAT(bed.Text(), HasSubstr("hosts: 18 of 20 well  ! h17 NEVER HEARD  ! h18 config"));
}

TEST(ScreenLayout, OneOfTwoHostsDiffersFromTheOther) {
  ScreenContent content = SmallRobot();
  content.snapshot.deputies[0].is_heard = true;
  content.snapshot.deputies[0].version = "1.1.0";
  ScreenBed bed(content);

  EXPECT_THAT(bed.Text(), HasSubstr("version differs: 1.0.0"));
  EXPECT_THAT(bed.Text(), HasSubstr("version differs: 1.1.0"));
}

TEST(ScreenLayout, WarnsOfAnotherSheriffAndOfBeingAnObserver) {
  ScreenContent content = SmallRobot();
  content.snapshot.other =
      core::procman::OtherSheriff{.id = "cart:77:1700000000000000", .age_us = 600'000};
  {
    ScreenBed bed(content);
    EXPECT_THAT(bed.Text(), HasSubstr("ANOTHER SHERIFF IS ACTIVE: cart:77, 0.6 s ago"));
  }
  content.snapshot.is_observer = true;
  {
    ScreenBed bed(content);
    EXPECT_THAT(bed.Text(), HasSubstr("OBSERVER: no orders from here; sheriff cart:77"));
    EXPECT_THAT(bed.Text(), HasSubstr("c take command"));
    EXPECT_THAT(bed.Text(), Not(HasSubstr("t stop")));
  }
}

TEST(ScreenLayout, AQuestionKeepsItsAnswersInSight) {
  ScreenContent content = SmallRobot();
  content.snapshot.commands[0].status = Status::kMoving;
  content.snapshot.commands[0].text = std::string(300, 'w');
  ScreenBed bed(content);
  bed.Select("lidar-driver");

  bed.Press('s');

  EXPECT_THAT(bed.Text(), HasSubstr(".. y/n"));
}

TEST(ScreenLayout, MoreRoomShowsHostAndAge) {
  ScreenBed bed(SmallRobot(), {120, 40});

  EXPECT_THAT(bed.Text(), HasSubstr("UP FOR"));
  EXPECT_THAT(bed.Text(), HasSubstr("13 min"));
  EXPECT_THAT(bed.Text(), HasSubstr("preprocessor Running       rig"));
}

TEST(ScreenLayout, TheOutputIsNamedByItsProgramWithoutSettings) {
  ScreenContent content = SmallRobot();
  content.snapshot.commands[2].exec = "LEVEL=3 URL=udpm://1?ttl=0 clusterer --set a=b";
  ScreenBed bed(content);
  bed.Select("clusterer");

  EXPECT_THAT(bed.Text(), HasSubstr("OUTPUT of clusterer on rig: clusterer --set a=b\n"));
}

TEST(ScreenLayout, LongOutputGoesOnInTheNextRow) {
  ScreenBed bed;
  bed.output.Of("clusterer").Add("begin " + std::string(100, 'x') + " end\n");
  bed.Select("clusterer");
  bed.Press(KeyPress::Kind::kEnter);

  EXPECT_THAT(bed.Text(), HasSubstr("\nbegin xxxx"));
  EXPECT_THAT(bed.Text(), HasSubstr("x end\n"));
}

TEST(ScreenLayout, ScriptsShowTheirStepsAndHowTheyGo) {
  ScreenContent content = SmallRobot();
  content.progress = {.state = ScriptRunner::State::kRunning,
                      .script = "bring-up",
                      .text = "waits until everything is running",
                      .awaited = {"clusterer"},
                      .elapsed_us = 3'000'000};
  ScreenBed bed(content);
  EXPECT_THAT(bed.Text(), HasSubstr("script bring-up is running, 3.0 s: waits until everything"));

  bed.Press('x');

  const std::string text = bed.Text();
  EXPECT_THAT(text, HasSubstr(" > bring-up"));
  EXPECT_THAT(text, HasSubstr("SCRIPT bring-up is running, 3.0 s"));
  EXPECT_THAT(text, HasSubstr(" ! clusterer: Gave up  ended 5 times"));
  EXPECT_THAT(text, HasSubstr("start everything, wait until running"));
  EXPECT_THAT(text, HasSubstr("Esc abort the script"));
}

TEST(ScreenLayout, NumbersAreShort) {
  EXPECT_EQ(BytesInWords(0), "0 B");
  EXPECT_EQ(BytesInWords(1023), "1.0 kB");
  EXPECT_EQ(BytesInWords(50'000'000), "48 MB");
  EXPECT_EQ(BytesInWords(-1), "-1 B");
  EXPECT_EQ(TimeInWords(400'000), "0.4 s");
  EXPECT_EQ(TimeInWords(90'000'000), "90 s");
  EXPECT_EQ(TimeInWords(3'600'000'000), "60 min");
  EXPECT_EQ(TimeInWords(300'000'000'000), "3.5 d");
  EXPECT_EQ(Percent(0.031F), "3.1");
  EXPECT_EQ(Percent(1.0F), "100");
  EXPECT_EQ(Percent(-1.0F), "-");
}

}  // namespace
}  // namespace clearway::screen
