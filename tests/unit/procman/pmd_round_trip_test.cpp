// SPDX-License-Identifier: BSD-3-Clause
// Random deployments, written as text in all the ways that the grammar knows and read again.
#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/procman/pmd_example.hpp"

namespace clearway::io {
namespace {

using core::procman::CommandSpec;
using core::procman::DeployedCommand;
using core::procman::Deployment;
using core::procman::Script;
using core::procman::ScriptAction;
using core::procman::Target;
using Kind = ScriptAction::Kind;
using Status = ScriptAction::Status;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}

  int UpTo(int most) { return static_cast<int>(engine_() % static_cast<unsigned>(most + 1)); }
  bool Maybe() { return UpTo(1) == 0; }

  std::string Text(const std::string& letters, int max_length) {
    std::string text;
    for (int i = UpTo(max_length); i > 0; --i) {
      text += letters[static_cast<std::size_t>(UpTo(static_cast<int>(letters.size()) - 1))];
    }
    return text;
  }

 private:
  std::mt19937 engine_;
};

const std::string kNameLetters = "aB_9- #{};=\"\\\n\r\t.\xc3\xbc";

class DeploymentMaker {
 public:
  explicit DeploymentMaker(Random& random) : random_(random) {}

  Deployment Make() {
    Deployment made;
    made.file = "d.pmd";
    const int num_commands = random_.UpTo(5);
    for (int i = 0; i < num_commands; ++i) made.commands.push_back(Command(i));
    const int num_scripts = random_.UpTo(3);
    for (int i = 0; i < num_scripts; ++i) made.scripts.push_back(MakeScript(made, i));
    return made;
  }

 private:
  // Unique by its number.
  std::string Name(int number) { return std::to_string(number) + random_.Text(kNameLetters, 5); }

  DeployedCommand Command(int number) {
    DeployedCommand command;
    CommandSpec& spec = command.spec;
    spec.id = Name(number);
    spec.exec = "p " + random_.Text("a \t\n$={}*#;/", 12);
    command.deputy = Name(0) + "/x";
    for (int depth = random_.UpTo(3); depth > 0; --depth) {
      spec.group += (spec.group.empty() ? "g" : "/g") + random_.Text("ab ", 1);
    }
    spec.auto_respawn = random_.Maybe();
    if (random_.Maybe()) spec.stop_signal = 1 + random_.UpTo(63);
    if (random_.Maybe()) spec.stop_time_allowed_s = static_cast<float>(1 + random_.UpTo(3599));
    return command;
  }

  Script MakeScript(const Deployment& made, int number) {
    Script script;
    script.name = Name(number) + "/y";
    for (int i = random_.UpTo(6); i > 0; --i) script.actions.push_back(Action(made));
    return script;
  }

  ScriptAction Action(const Deployment& made) {
    ScriptAction action;
    action.kind = static_cast<Kind>(random_.UpTo(5));
    if (action.kind == Kind::kRunScript && made.scripts.empty()) action.kind = Kind::kWaitTime;
    if (action.kind == Kind::kWaitStatus && made.commands.empty()) action.kind = Kind::kStart;
    if (action.kind == Kind::kWaitTime) {
      action.duration_ms = random_.UpTo(kMaxScriptWait_ms);
    } else if (action.kind == Kind::kRunScript) {
      // Of those before it, so that none runs itself.
      action.script = made.scripts[Index(made.scripts.size())].name;
    } else {
      const bool must = action.kind == Kind::kWaitStatus;
      action.target = MakeTarget(made, must);
      if (must || random_.Maybe()) {
        action.wait = random_.Maybe() ? Status::kRunning : Status::kStopped;
      }
    }
    return action;
  }

  Target MakeTarget(const Deployment& made, bool is_wait) {
    if (made.commands.empty() || (!is_wait && random_.UpTo(3) == 0)) return {};
    const CommandSpec& spec = made.commands[Index(made.commands.size())].spec;
    if (spec.group.empty() || random_.Maybe()) return {Target::Kind::kCommand, spec.id};
    return {Target::Kind::kGroup, spec.group.substr(0, spec.group.find('/'))};
  }

  std::size_t Index(std::size_t size) {
    return static_cast<std::size_t>(random_.UpTo(static_cast<int>(size) - 1));
  }

  Random& random_;
};

// Writes text and keeps count of its lines, so that the items know theirs.
class Writer {
 public:
  explicit Writer(Random& random) : random_(random) {}

  std::string Write(Deployment& deployment) {
    for (DeployedCommand& command : deployment.commands) WriteCommand(command);
    for (Script& script : deployment.scripts) WriteScript(script);
    return text_;
  }

 private:
  void Put(const std::string& token) {
    text_ += random_.Text(" \t\r\n\v\f", 2);
    if (random_.UpTo(5) == 0) text_ += "#" + random_.Text("x\"{};#\\", 6) + "\n";
    if (text_.empty() || std::string("{};=\"\n").find(token[0]) == std::string::npos) text_ += " ";
    text_ += token;
  }

  int PutWord(const std::string& word) {
    Put(word);
    return 1 + static_cast<int>(std::count(text_.begin(), text_.end(), '\n'));
  }

  void PutString(const std::string& value) {
    static const std::map<char, char> kControls = {{'\n', 'n'}, {'\r', 'r'}, {'\t', 't'}};
    std::string quoted = "\"";
    for (const char character : value) {
      const auto control = kControls.find(character);
      const bool is_letter = std::string("nrt").find(character) != std::string::npos;
      if (control != kControls.end() && (character == '\n' || random_.Maybe())) {
        quoted += std::string("\\") + control->second;
      } else if (character == '"' || character == '\\' || (!is_letter && random_.UpTo(5) == 0)) {
        quoted += std::string("\\") + character;
      } else {
        quoted += character;
      }
    }
    Put(quoted + "\"");
  }

  void PutAttribute(const std::string& name, const std::string& value) {
    Put(name);
    Put("=");
    PutString(value);
    Put(";");
  }

  void PutAttribute(const std::string& name, int value) {
    Put(name);
    Put("=");
    Put(std::to_string(value));
    Put(";");
  }

  void WriteCommand(DeployedCommand& command) {
    const CommandSpec& spec = command.spec;
    std::size_t at = 0;
    int depth = 0;
    for (; !spec.group.empty() && at != std::string::npos; ++depth) {
      const std::size_t end = spec.group.find('/', at);
      Put("group");
      PutString(spec.group.substr(at, end - at));
      Put("{");
      at = end == std::string::npos ? end : end + 1;
    }
    command.line = PutWord("cmd");
    PutString(spec.id);
    Put("{");
    if (random_.Maybe()) PutAttribute("group", "other");
    PutAttribute(random_.Maybe() ? "deputy" : "host", command.deputy);
    if (spec.auto_respawn || random_.Maybe()) {
      const std::vector<std::string> words = {"no", "False", "YES", "true"};
      const int word = (spec.auto_respawn ? 2 : 0) + random_.UpTo(1);
      PutAttribute("auto_respawn", words[static_cast<std::size_t>(word)]);
    }
    if (spec.stop_signal != 2) PutAttribute("stop_signal", spec.stop_signal);
    PutAttribute("exec", spec.exec);
    PutAttribute("stop_time_allowed", static_cast<int>(spec.stop_time_allowed_s));
    for (; depth >= 0; --depth) Put("}");
  }

  void WriteScript(Script& script) {
    script.line = PutWord("script");
    PutString(script.name);
    Put("{");
    for (ScriptAction& action : script.actions) {
      static const std::vector<std::string> kWords = {
          "start", "stop", "restart", "wait", "wait", "run_script"};
      action.line = PutWord(kWords[static_cast<std::size_t>(action.kind)]);
      WriteOperands(action);
      Put(";");
    }
    Put("}");
  }

  void WriteOperands(const ScriptAction& action) {
    if (action.kind == Kind::kRunScript) return PutString(action.script);
    if (action.kind == Kind::kWaitTime) {
      Put("ms");
      return Put(std::to_string(action.duration_ms));
    }
    if (action.target.kind == Target::Kind::kEverything) {
      Put("everything");
    } else {
      const bool is_group = action.target.kind == Target::Kind::kGroup;
      Put(is_group ? "group" : "cmd");
      PutString(is_group && random_.Maybe() ? "//" + action.target.name + "/" : action.target.name);
    }
    if (action.wait == Status::kNone) return;
    Put(action.kind == Kind::kWaitStatus ? "status" : "wait");
    PutString(action.wait == Status::kRunning ? "running" : "stopped");
  }

  Random& random_;
  std::string text_;
};

void ExpectEqual(const Deployment& actual, const Deployment& expected) {
  EXPECT_EQ(actual.file, expected.file);
  ASSERT_EQ(actual.commands.size(), expected.commands.size());
  for (std::size_t i = 0; i < expected.commands.size(); ++i) {
    EXPECT_EQ(actual.commands[i].spec, expected.commands[i].spec);
    EXPECT_EQ(actual.commands[i].deputy, expected.commands[i].deputy);
    EXPECT_EQ(actual.commands[i].line, expected.commands[i].line);
  }
  ASSERT_EQ(actual.scripts.size(), expected.scripts.size());
  for (std::size_t i = 0; i < expected.scripts.size(); ++i) {
    EXPECT_EQ(actual.scripts[i].name, expected.scripts[i].name);
    EXPECT_EQ(actual.scripts[i].line, expected.scripts[i].line);
    ASSERT_EQ(actual.scripts[i].actions.size(), expected.scripts[i].actions.size());
    for (std::size_t j = 0; j < expected.scripts[i].actions.size(); ++j) {
      const ScriptAction& read = actual.scripts[i].actions[j];
      const ScriptAction& meant = expected.scripts[i].actions[j];
      EXPECT_EQ(read.kind, meant.kind);
      EXPECT_EQ(read.target, meant.target);
      EXPECT_EQ(read.wait, meant.wait);
      EXPECT_EQ(read.duration_ms, meant.duration_ms);
      EXPECT_EQ(read.script, meant.script);
      EXPECT_EQ(read.line, meant.line);
    }
  }
}

TEST(PmdRoundTrip, WhatIsWrittenIsReadAgain) {
  Random random(6);
  for (int round = 0; round < 2000; ++round) {
    Deployment deployment = DeploymentMaker(random).Make();
    const std::string text = Writer(random).Write(deployment);

    ASSERT_EQ(test::PmdRefusal(text), "") << text;
    ExpectEqual(ParsePmd(text, "d.pmd"), deployment);
    if (HasFailure()) FAIL() << text;
  }
}

}  // namespace
}  // namespace clearway::io
