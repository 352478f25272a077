// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/procman/pmd_script.hpp"

#include <optional>
#include <string_view>
#include <utility>

#include "common/io/procman/pmd_reader.hpp"

namespace clearway::io::internal {
namespace {

using core::procman::Script;
using core::procman::ScriptAction;
using core::procman::Target;
using Kind = PmdToken::Kind;

// "a//b/" is the path "a/b".
std::string WithoutSurplusSlashes(std::string_view path) {
  std::string squeezed;
  for (const char character : path) {
    if (character == '/' && (squeezed.empty() || squeezed.back() == '/')) continue;
    squeezed += character;
  }
  if (!squeezed.empty() && squeezed.back() == '/') squeezed.pop_back();
  return squeezed;
}

class ScriptParser {
 public:
  ScriptParser(PmdCursor& cursor, PmdContent& content) : cursor_(cursor), content_(content) {}

  void Parse() {
    const PmdPlace begin = cursor_.Take().place;
    script_.line = static_cast<int>(begin.line);
    const std::optional<PmdToken> name = cursor_.ExpectName("the script's name");
    if (!name) return cursor_.SkipStatement();
    NoteName(*name);
    // Where only the '{' is missing, reading goes on as if it was there.
    if (!cursor_.ExpectSymbol('{') && cursor_.token().kind != Kind::kWord) {
      return cursor_.SkipStatement();
    }
    ParseBody(begin);
    content_.deployment.scripts.push_back(std::move(script_));
  }

 private:
  void NoteName(const PmdToken& name) {
    script_.name = name.text;
    const auto [first, is_new] = content_.script_lines.emplace(name.text, name.place.line);
    if (is_new) return;
    cursor_.problems().Add(name.place,
                           "script " + Quoted(name.text) + " is there already in line " +
                               std::to_string(first->second) + ": expected another name");
  }

  void ParseBody(PmdPlace begin) {
    while (!cursor_.IsSymbol('}')) {
      if (cursor_.IsAtEnd()) return cursor_.FailUnclosed("script", begin.line);
      // The '}' before the next block is missing.
      if (cursor_.IsBlock("cmd") || cursor_.IsBlock("group") || cursor_.IsBlock("script")) {
        return cursor_.Fail(kActions);
      }
      ScriptAction action;
      action.line = static_cast<int>(cursor_.token().place.line);
      if (ParseAction(action) && cursor_.ExpectEndOfStatement()) {
        script_.actions.push_back(std::move(action));
      } else {
        cursor_.SkipStatement();
      }
    }
    cursor_.Take();
  }

  // These say false where the rest of the action cannot be read.
  bool ParseAction(ScriptAction& action) {
    if (cursor_.TakeWord("start")) return ParseChange(ScriptAction::Kind::kStart, action);
    if (cursor_.TakeWord("stop")) return ParseChange(ScriptAction::Kind::kStop, action);
    if (cursor_.TakeWord("restart")) return ParseChange(ScriptAction::Kind::kRestart, action);
    if (cursor_.TakeWord("wait")) return ParseWait(action);
    if (cursor_.TakeWord("run_script")) return ParseRunScript(action);
    cursor_.Fail(kActions);
    return false;
  }

  bool ParseChange(ScriptAction::Kind kind, ScriptAction& action) {
    action.kind = kind;
    if (!cursor_.TakeWord("everything") && !ParseTarget("everything, cmd or group", action)) {
      return false;
    }
    if (cursor_.TakeWord("wait")) return ParseStatus(action);
    if (cursor_.IsSymbol(';')) return true;
    cursor_.Fail("wait or ';'");
    return cursor_.IsSymbol('}');
  }

  bool ParseWait(ScriptAction& action) {
    if (cursor_.TakeWord("ms")) {
      action.kind = ScriptAction::Kind::kWaitTime;
      const auto duration =
          cursor_.ExpectInteger("whole milliseconds from 0 to " + std::to_string(kMaxScriptWait_ms),
                                0,
                                kMaxScriptWait_ms);
      action.duration_ms = duration.value_or(0);
      return duration.has_value();
    }
    action.kind = ScriptAction::Kind::kWaitStatus;
    if (!ParseTarget("ms, cmd or group", action)) return false;
    if (cursor_.TakeWord("status")) return ParseStatus(action);
    cursor_.Fail("status");
    return false;
  }

  bool ParseRunScript(ScriptAction& action) {
    action.kind = ScriptAction::Kind::kRunScript;
    const std::optional<PmdToken> name = cursor_.ExpectString("the name of a script");
    if (!name) return false;
    action.script = name->text;
    NoteReference(PmdReference::Kind::kScript, action.script, name->place);
    return true;
  }

  bool ParseTarget(const std::string& expected, ScriptAction& action) {
    if (!cursor_.IsWord("cmd") && !cursor_.IsWord("group")) {
      cursor_.Fail(expected);
      return false;
    }
    const bool is_command = cursor_.Take().text == "cmd";
    const std::optional<PmdToken> name =
        cursor_.ExpectString(is_command ? "the id of a command" : "the path of a group");
    if (!name) return false;
    if (is_command) {
      action.target = {Target::Kind::kCommand, name->text};
      NoteReference(PmdReference::Kind::kCommand, name->text, name->place);
    } else {
      action.target = {Target::Kind::kGroup, WithoutSurplusSlashes(name->text)};
      NoteReference(PmdReference::Kind::kGroup, action.target.name, name->place);
    }
    return true;
  }

  bool ParseStatus(ScriptAction& action) {
    const PmdToken& status = cursor_.token();
    const bool is_running = status.text == "running";
    if (status.kind != Kind::kString || (!is_running && status.text != "stopped")) {
      cursor_.Fail("\"running\" or \"stopped\", in double quotes");
      return false;
    }
    action.wait = is_running ? ScriptAction::Status::kRunning : ScriptAction::Status::kStopped;
    cursor_.Take();
    return true;
  }

  void NoteReference(PmdReference::Kind kind, const std::string& name, PmdPlace place) {
    content_.references.push_back({kind, name, place, content_.deployment.scripts.size()});
  }

  static constexpr const char* kActions = "start, stop, restart, wait, run_script or '}'";

  PmdCursor& cursor_;
  PmdContent& content_;
  Script script_;
};

}  // namespace

void ParsePmdScript(PmdCursor& cursor, PmdContent& content) {
  ScriptParser(cursor, content).Parse();
}

}  // namespace clearway::io::internal
