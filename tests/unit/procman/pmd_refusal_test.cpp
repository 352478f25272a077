// SPDX-License-Identifier: BSD-3-Clause
// What a deployment is refused for, each with its place and what is allowed.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/procman/pmd_example.hpp"

namespace clearway::io {
namespace {

using test::PmdRefusal;

struct Case {
  std::string text;
  std::string message;
};

void ExpectRefusals(const std::vector<Case>& cases) {
  for (const Case& bad : cases) EXPECT_EQ(PmdRefusal(bad.text), bad.message) << bad.text;
}

std::string Command(const std::string& attributes) {
  return "cmd \"a\" { " + attributes + " }";
}

// In a command that is whole without it; it begins in column 41.
std::string Attribute(const std::string& attribute) {
  return Command("exec = \"x\"; deputy = \"h\";     " + attribute);
}

std::string InScript(const std::string& action) {
  return Attribute("") + "\nscript \"s\" { " + action + " }";
}

TEST(PmdRefusal, OfWhatIsAtTheTop) {
  const std::string items = ": expected cmd, group or script";
  ExpectRefusals({
      {"x", "d.pmd:1:1: \"x\"" + items},
      {"Cmd \"a\" { exec = \"x\"; }", "d.pmd:1:1: \"Cmd\"" + items},
      {"\n  \"a\";", "d.pmd:2:3: string \"a\"" + items},
      {"12", "d.pmd:1:1: \"12\"" + items},
      {" ;", "d.pmd:1:2: ';'" + items},
      {"}", "d.pmd:1:1: '}'" + items},
      {"\xef\xbb\xbf# BOM", "d.pmd:1:1: \"\\xef\\xbb\\xbf\"" + items},
      {"group \"g\" { script \"s\" {} }", "d.pmd:1:13: \"script\": expected cmd, group or '}'"},
      {"group \"g\" {\n", "d.pmd:2:1: end of the file: expected '}' of the group of line 1"},
      {"group g {}", "d.pmd:1:7: \"g\": expected the group's name, in double quotes"},
      {"group {}", "d.pmd:1:7: '{': expected the group's name, in double quotes"},
      {"group \"g\";", "d.pmd:1:10: ';': expected '{'"},
      {"group \"g/h\" {}", "d.pmd:1:7: string \"g/h\": expected the group's name without '/'"},
      {"group \" \" {}", "d.pmd:1:7: string \" \": expected the group's name, not blank"},
  });
}

TEST(PmdRefusal, OfACommandsIdAndBody) {
  const std::string id = "the command's id";
  const std::string attributes =
      ": expected exec, deputy, auto_respawn, stop_signal, stop_time_allowed or '}'";
  ExpectRefusals({
      {"cmd { exec = \"x\"; deputy = \"h\"; }",
       "d.pmd:1:1: cmd without an id: expected cmd \"ID\" { ... }"},
      {"cmd a {}", "d.pmd:1:5: \"a\": expected " + id + ", in double quotes"},
      {"cmd \"\" { exec = \"x\"; deputy = \"h\"; }",
       "d.pmd:1:5: string \"\": expected " + id + ", not blank"},
      {"cmd \"a/b\" { exec = \"x\"; deputy = \"h\"; }",
       "d.pmd:1:5: string \"a/b\": expected " + id + " without '/'"},
      {"cmd \"" + std::string(256, 'i') + "\" { exec = \"x\"; deputy = \"h\"; }",
       "d.pmd:1:5: string \"" + std::string(40, 'i') + "...\": expected " + id +
           " of at most 255 bytes"},
      {Command(""),
       "d.pmd:1:1: cmd \"a\" without exec: expected exec = \"PROGRAM ...\";\n"
       "d.pmd:1:1: cmd \"a\" without deputy: expected deputy = \"NAME\";"},
      {"cmd \"a\"", "d.pmd:1:8: end of the file: expected '{'"},
      {"cmd \"a\" {\n", "d.pmd:2:1: end of the file: expected '}' of the cmd of line 1"},
      {Attribute("\"x\";"), "d.pmd:1:41: string \"x\"" + attributes},
      {Attribute("cwd = \"x\";"), "d.pmd:1:41: \"cwd\"" + attributes},
      {Attribute("Exec = \"x\";"), "d.pmd:1:41: \"Exec\"" + attributes},
      {Attribute("stop_signal 2;"), "d.pmd:1:53: \"2\": expected '='"},
      {Attribute("stop_signal = 2"), "d.pmd:1:57: '}': expected ';'"},
      {Attribute("") + Attribute(""),
       "d.pmd:1:47: cmd \"a\" is there already in line 1: expected another id"},
      {"\n" + Attribute("") + "\ngroup \"g\" { " + Attribute("") + " }",
       "d.pmd:3:17: cmd \"a\" is there already in line 2: expected another id"},
  });
}

TEST(PmdRefusal, OfAnAttributesValue) {
  const std::string signal = ": expected a signal's number, a whole number from 1 to 64";
  const std::string time = ": expected whole seconds from 1 to 3600";
  const std::string respawn = ": expected \"true\", \"yes\", \"false\" or \"no\"";
  const std::string exec = ": expected a program and its arguments";
  ExpectRefusals({
      {Attribute("stop_signal = 0;"), "d.pmd:1:55: \"0\"" + signal},
      {Attribute("stop_signal = 65;"), "d.pmd:1:55: \"65\"" + signal},
      {Attribute("stop_signal = -1;"), "d.pmd:1:55: \"-\"" + signal},
      {Attribute("stop_signal = \"2\";"), "d.pmd:1:55: string \"2\"" + signal},
      {Attribute("stop_signal = 2.5;"), "d.pmd:1:56: \".\": expected ';'"},
      {Attribute("stop_signal = 2s;"), "d.pmd:1:56: \"s\": expected ';'"},
      {Attribute("stop_time_allowed = 0;"), "d.pmd:1:61: \"0\"" + time},
      {Attribute("stop_time_allowed = 3601;"), "d.pmd:1:61: \"3601\"" + time},
      {Attribute("stop_time_allowed = 99999999999999999999;"),
       "d.pmd:1:61: \"99999999999999999999\"" + time},
      {Attribute("auto_respawn = \"1\";"), "d.pmd:1:56: auto_respawn \"1\"" + respawn},
      {Attribute("auto_respawn = \"\";"), "d.pmd:1:56: auto_respawn \"\"" + respawn},
      {Attribute("auto_respawn = true;"),
       "d.pmd:1:56: \"true\": expected the value of auto_respawn, in double quotes"},
      {Attribute("group = 1;"), "d.pmd:1:49: \"1\": expected the value of group, in double quotes"},
      {Command("exec = \"\"; deputy = \"h\";"),
       "d.pmd:1:18: exec \"\": it names no program" + exec},
      {Command("exec = \"a 'b\"; deputy = \"h\";"),
       "d.pmd:1:18: exec \"a 'b\": the quote ' at byte 3 is not closed" + exec},
      {Command("exec = \"A=1\"; deputy = \"h\";"),
       "d.pmd:1:18: exec \"A=1\": it names no program" + exec},
      {Command("exec = \"x\"; deputy = \"\\t\";"),
       "d.pmd:1:32: string \"\\x09\": expected the deputy's name, not blank"},
      {Command("exec = \"x\";\nhost = \"y\";\ndeputy = \"h\";"),
       "d.pmd:3:1: \"deputy\" after \"host\" in line 2: expected it once in a cmd"},
      {Attribute("\nexec = \"y\";"),
       "d.pmd:2:1: \"exec\" after \"exec\" in line 1: expected it once in a cmd"},
      {Attribute("group = \"y\"; group = \"z\";"),
       "d.pmd:1:54: \"group\" after \"group\" in line 1: expected it once in a cmd"},
  });
}

TEST(PmdRefusal, OfStringsThatDoNotEndOrHoldNul) {
  const std::string nul("cmd \"a\0b\" { exec = \"x\"; deputy = \"h\"; }", 39);

  EXPECT_EQ(PmdRefusal(nul), "d.pmd:1:5: string \"a\\x00b\": expected a text without NUL");
  ExpectRefusals({
      {"cmd \"a",
       "d.pmd:1:5: string \"a\" without its second quote: expected '\"' in the same line"},
      {"cmd \"a\\\"",
       "d.pmd:1:5: string \"a\"\" without its second quote: expected '\"' in the same "
       "line"},
      {"cmd \"a\\\n\" {}",
       "d.pmd:1:5: string \"a\\\" without its second quote: expected '\"' in the same line\n"
       "d.pmd:2:1: string \"\" without its second quote: expected '{'"},
  });
}

TEST(PmdRefusal, OfAScriptsNameAndActions) {
  const std::string actions = ": expected start, stop, restart, wait, run_script or '}'";
  const std::string status = ": expected \"running\" or \"stopped\", in double quotes";
  const std::string target = ": expected everything, cmd or group";
  ExpectRefusals({
      {"script { }", "d.pmd:1:8: '{': expected the script's name, in double quotes"},
      {"script \" \" { }", "d.pmd:1:8: string \" \": expected the script's name, not blank"},
      {"script \"s\" {}\nscript \"s\" {}",
       "d.pmd:2:8: script \"s\" is there already in line 1: expected another name"},
      {"script \"s\" {\n", "d.pmd:2:1: end of the file: expected '}' of the script of line 1"},
      {InScript("begin;"), "d.pmd:2:14: \"begin\"" + actions},
      {InScript("exec = \"x\";"), "d.pmd:2:14: \"exec\"" + actions},
      {InScript("start;"), "d.pmd:2:19: ';'" + target},
      {InScript("stop \"a\";"), "d.pmd:2:19: string \"a\"" + target},
      {InScript("stop cmd a;"),
       "d.pmd:2:23: \"a\": expected the id of a command, in double quotes"},
      {InScript("stop group 1;"),
       "d.pmd:2:25: \"1\": expected the path of a group, in double quotes"},
      {InScript("start cmd \"a\" wait running;"), "d.pmd:2:33: \"running\"" + status},
      {InScript("start cmd \"a\" wait \"ready\";"), "d.pmd:2:33: string \"ready\"" + status},
      {InScript("start cmd \"a\" status \"running\";"),
       "d.pmd:2:28: \"status\": expected wait or ';'"},
      {InScript("start cmd \"a\""), "d.pmd:2:28: '}': expected wait or ';'"},
      {InScript("wait everything;"), "d.pmd:2:19: \"everything\": expected ms, cmd or group"},
      {InScript("wait cmd \"a\" wait \"running\";"), "d.pmd:2:27: \"wait\": expected status"},
      {InScript("wait ms -5;"),
       "d.pmd:2:22: \"-\": expected whole milliseconds from 0 to 86400000"},
      {InScript("wait ms 86400001;"),
       "d.pmd:2:22: \"86400001\": expected whole milliseconds from 0 to 86400000"},
      {InScript("run_script s;"),
       "d.pmd:2:25: \"s\": expected the name of a script, in double quotes"},
  });
}

TEST(PmdRefusal, OfNamesThatTheFileDoesNotDefine) {
  ExpectRefusals({
      {InScript("start cmd \"b\";"),
       "d.pmd:2:24: cmd \"b\": expected the id of a command of this file"},
      {InScript("wait cmd \"A\" status \"running\";"),
       "d.pmd:2:23: cmd \"A\": expected the id of a command of this file"},
      {InScript("stop group \"a\";"),
       "d.pmd:2:25: group \"a\": expected the path of a group of this file"},
      {InScript("stop group \"//\";"),
       "d.pmd:2:25: group \"\": expected the path of a group of this file"},
      {InScript("run_script \"a\"; start cmd \"\";"),
       "d.pmd:2:25: run_script \"a\": expected a script of this file\n"
       "d.pmd:2:40: cmd \"\": expected the id of a command of this file"},
  });
}

TEST(PmdRefusal, OfScriptsThatRunThemselves) {
  const std::string end = ": expected a script that does not lead back here";
  ExpectRefusals({
      {"script \"a\" { run_script \"a\"; }",
       "d.pmd:1:25: run_script \"a\" where \"a\" runs \"a\"" + end},
      {"script \"x\" { run_script \"a\"; }\nscript \"a\" { run_script \"b\"; }\n"
       "script \"b\" { run_script \"c\"; }\nscript \"c\" { run_script \"a\"; }",
       "d.pmd:4:25: run_script \"a\" where \"a\" runs \"b\" runs \"c\" runs \"a\"" + end},
      {"script \"a\" { run_script \"a\"; run_script \"b\"; }\nscript \"b\" { run_script \"a\"; }",
       "d.pmd:1:25: run_script \"a\" where \"a\" runs \"a\"" + end +
           "\nd.pmd:2:25: run_script \"a\" where \"a\" runs \"b\" runs \"a\"" + end},
  });
}

TEST(PmdRefusal, OfALongCircleOfScriptsWithoutHarm) {
  std::string text;
  int count = 0;
  while (text.size() + 60 < kMaxPmdBytes) {
    text += "script \"" + std::to_string(count) + "\"{run_script \"" + std::to_string(count + 1) +
            "\";}\n";
    ++count;
  }
  text += "script \"" + std::to_string(count) + "\"{run_script \"0\";}";

  EXPECT_EQ(PmdRefusal(text),
            "d.pmd:" + std::to_string(count + 1) +
                ":26: run_script \"0\" where \"0\" runs \"1\" runs \"2\" runs \"3\" runs \"4\" "
                "runs \"5\" runs ... runs \"0\": expected a script that does not lead back here");
}

TEST(PmdRefusal, OfALongFile) {
  EXPECT_EQ(PmdRefusal(std::string(kMaxPmdBytes + 1, '#')),
            "d.pmd: has 262145 bytes: expected a deployment, at most 262144");
}

}  // namespace
}  // namespace clearway::io
