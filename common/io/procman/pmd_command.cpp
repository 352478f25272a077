// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/procman/pmd_command.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "common/core/procman/exec_string.hpp"
#include "common/io/procman/pmd_reader.hpp"

namespace clearway::io::internal {
namespace {

using Kind = PmdToken::Kind;

constexpr int kHighestSignal = 64;

class CommandParser {
 public:
  CommandParser(PmdCursor& cursor, const std::string& group, PmdContent& content)
      : cursor_(cursor), content_(content) {
    command_.spec.group = group;
  }

  void Parse() {
    begin_ = cursor_.Take().place;
    command_.line = static_cast<int>(begin_.line);
    if (!ParseId()) return cursor_.SkipStatement();
    // Where only the '{' is missing, reading goes on as if it was there.
    const bool has_body = cursor_.ExpectSymbol('{');
    if (!has_body && cursor_.token().kind != Kind::kWord) return cursor_.SkipStatement();
    ParseBody();
    if (is_whole_ && has_body) CheckRequired();
    content_.deployment.commands.push_back(std::move(command_));
  }

 private:
  bool ParseId() {
    if (cursor_.IsSymbol('{')) {
      cursor_.problems().Add(begin_, "cmd without an id: expected cmd \"ID\" { ... }");
      return true;
    }
    const std::optional<PmdToken> id = cursor_.ExpectNameWithoutSlash("the command's id");
    if (!id) return false;
    command_.spec.id = id->text;
    const auto [first, is_new] = content_.command_lines.emplace(id->text, id->place.line);
    if (!is_new) {
      cursor_.problems().Add(id->place,
                             "cmd " + Quoted(id->text) + " is there already in line " +
                                 std::to_string(first->second) + ": expected another id");
    }
    return true;
  }

  void ParseBody() {
    while (!cursor_.IsSymbol('}')) {
      if (cursor_.IsAtEnd()) {
        is_whole_ = false;
        return cursor_.FailUnclosed("cmd", begin_.line);
      }
      // The '}' before the next block is missing.
      if (cursor_.IsBlock("cmd") || cursor_.IsBlock("group") || cursor_.IsBlock("script")) {
        is_whole_ = false;
        return cursor_.Fail(kAttributes);
      }
      if (ParseAttribute()) continue;
      is_whole_ = false;
      cursor_.SkipStatement();
    }
    cursor_.Take();
  }

  // False where the rest of the statement cannot be read.
  bool ParseAttribute() {
    const PmdToken& next = cursor_.token();
    const auto* const known = std::find(kNames.begin(), kNames.end(), next.text);
    if (next.kind != Kind::kWord || known == kNames.end()) {
      cursor_.Fail(kAttributes);
      return false;
    }
    const PmdToken name = cursor_.Take();
    NoteGiven(name);
    return cursor_.ExpectSymbol('=') && ParseValue(name.text) && cursor_.ExpectEndOfStatement();
  }

  void NoteGiven(const PmdToken& name) {
    // Two names of one attribute.
    const std::string key = name.text == "host" ? "deputy" : name.text;
    const auto [first, is_new] = given_.emplace(key, name);
    if (is_new) return;
    cursor_.problems().Add(name.place,
                           Quoted(name.text) + " after " + Quoted(first->second.text) +
                               " in line " + std::to_string(first->second.place.line) +
                               ": expected it once in a cmd");
  }

  bool ParseValue(const std::string& name) {
    if (name == "stop_signal") {
      const auto signal = cursor_.ExpectInteger(
          "a signal's number, a whole number from 1 to 64", 1, kHighestSignal);
      command_.spec.stop_signal = signal.value_or(1);
      return signal.has_value();
    }
    if (name == "stop_time_allowed") {
      const auto seconds = cursor_.ExpectInteger(
          "whole seconds from 1 to " + std::to_string(kMaxStopTime_s), 1, kMaxStopTime_s);
      command_.spec.stop_time_allowed_s = static_cast<float>(seconds.value_or(1));
      return seconds.has_value();
    }
    return ParseText(name);
  }

  bool ParseText(const std::string& name) {
    const std::optional<PmdToken> text = name == "deputy" || name == "host"
                                             ? cursor_.ExpectName("the deputy's name")
                                             : cursor_.ExpectString("the value of " + name);
    if (!text) return false;
    if (text->kind == Kind::kOpenString) {
      is_whole_ = false;
    } else if (name == "exec") {
      TakeExec(*text);
    } else if (name == "auto_respawn") {
      TakeAutoRespawn(*text);
    } else if (name != "group") {
      command_.deputy = text->text;
    }
    return true;
  }

  void TakeExec(const PmdToken& text) {
    command_.spec.exec = text.text;
    // Only the deputy knows its variables.
    const auto parsed = core::procman::ParseExecLine(
        text.text, [](const std::string&) { return std::optional<std::string>(); });
    if (parsed.line) return;
    cursor_.problems().Add(text.place,
                           "exec " + Quoted(text.text) + ": " + parsed.problem +
                               ": expected a program and its arguments");
  }

  void TakeAutoRespawn(const PmdToken& text) {
    std::string word = text.text;
    std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) {
      return static_cast<char>(std::tolower(c));
    });
    command_.spec.auto_respawn = word == "true" || word == "yes";
    if (command_.spec.auto_respawn || word == "false" || word == "no") return;
    cursor_.problems().Add(
        text.place,
        "auto_respawn " + Quoted(text.text) + ": expected \"true\", \"yes\", \"false\" or \"no\"");
  }

  void CheckRequired() {
    const std::string command = "cmd " + Quoted(command_.spec.id);
    if (!given_.contains("exec")) {
      cursor_.problems().Add(begin_, command + " without exec: expected exec = \"PROGRAM ...\";");
    }
    if (!given_.contains("deputy")) {
      cursor_.problems().Add(begin_, command + " without deputy: expected deputy = \"NAME\";");
    }
  }

  static constexpr std::array<std::string_view, 7> kNames =
      {"exec", "deputy", "host", "auto_respawn", "group", "stop_signal", "stop_time_allowed"};
  static constexpr const char* kAttributes =
      "exec, deputy, auto_respawn, stop_signal, stop_time_allowed or '}'";

  PmdCursor& cursor_;
  PmdContent& content_;
  PmdPlace begin_;
  core::procman::DeployedCommand command_;
  std::map<std::string, PmdToken> given_;
  bool is_whole_ = true;  // False once something of it could not be read.
};

}  // namespace

void ParsePmdCommand(PmdCursor& cursor, const std::string& group, PmdContent& content) {
  CommandParser(cursor, group, content).Parse();
}

}  // namespace clearway::io::internal
