// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/procman/pmd_parser.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "common/io/procman/pmd_command.hpp"
#include "common/io/procman/pmd_cursor.hpp"
#include "common/io/procman/pmd_reader.hpp"
#include "common/io/procman/pmd_script.hpp"

namespace clearway::io::internal {
namespace {

class FileParser {
 public:
  FileParser(std::string_view text, PmdProblems& problems) : cursor_(text, problems) {}

  PmdContent Parse() {
    while (!cursor_.IsAtEnd()) {
      if (cursor_.IsWord("script")) {
        ParsePmdScript(cursor_, content_);
      } else if (cursor_.IsSymbol('}')) {
        TakeSurplusBrace();
      } else {
        ParseItem("", 0, "cmd, group or script");
      }
    }
    return std::move(content_);
  }

 private:
  // A command or a group in `depth` groups. Recursion ends at kMaxPmdGroupDepth.
  void ParseItem(const std::string& path, std::size_t depth, const char* expected) {
    if (cursor_.IsWord("cmd")) return ParsePmdCommand(cursor_, path, content_);
    if (cursor_.IsWord("group")) return ParseGroup(path, depth);
    cursor_.Fail(expected);
    cursor_.SkipStatement();
  }

  void ParseGroup(const std::string& outer, std::size_t depth) {
    const PmdPlace begin = cursor_.Take().place;
    const std::optional<PmdToken> name = cursor_.ExpectNameWithoutSlash("the group's name");
    if (!name) return cursor_.SkipStatement();
    if (depth == kMaxPmdGroupDepth) {
      cursor_.problems().AddSyntax(begin,
                                   "group " + Quoted(name->text) + " in " + std::to_string(depth) +
                                       " others: expected fewer");
      return cursor_.SkipStatement();
    }
    const std::string path = outer.empty() ? name->text : outer + "/" + name->text;
    content_.groups.insert(path);
    // Where only the '{' is missing, reading goes on as if it was there.
    if (!cursor_.ExpectSymbol('{') && cursor_.token().kind != PmdToken::Kind::kWord) {
      return cursor_.SkipStatement();
    }
    while (!cursor_.IsSymbol('}')) {
      if (cursor_.IsAtEnd()) return cursor_.FailUnclosed("group", begin.line);
      // The '}' before it is missing, or it stands in a group where it should not.
      if (cursor_.IsBlock("script")) return cursor_.Fail("cmd, group or '}'");
      ParseItem(path, depth + 1, "cmd, group or '}'");
    }
    cursor_.Take();
  }

  // A '}' that an earlier problem made surplus is no problem of its own.
  void TakeSurplusBrace() {
    if (!cursor_.problems().has_syntax_problem()) cursor_.Fail("cmd, group or script");
    cursor_.Take();
  }

  PmdCursor cursor_;
  PmdContent content_;
};

}  // namespace

PmdContent ParsePmdContent(std::string_view text, PmdProblems& problems) {
  return FileParser(text, problems).Parse();
}

}  // namespace clearway::io::internal
