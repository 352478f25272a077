// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a rule of a host (its first three lines: program, arguments, environment) and a
// command (the rest): a command within its bounds or one problem; and rules allow what is theirs.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/procman/allow_list.hpp"

namespace {

using namespace clearway::core::procman;

void Require(bool holds) {
  if (!holds) std::abort();
}

std::string TakeLine(std::string_view& text) {
  const std::string line(text.substr(0, text.find('\n')));
  text.remove_prefix(std::min(line.size() + 1, text.size()));
  return line;
}

std::optional<std::string> Lookup(const std::string& name) {
  if (name.size() > 3) return std::nullopt;
  return name == "L" ? std::string(5000, 'l') : "$A \"" + name;
}

// Nothing in it means anything but itself.
std::string Quoted(const std::string& word) {
  if (word.empty()) return "'' ";
  std::string quoted;
  for (const char character : word) quoted += {'\\', character};
  return quoted + " ";
}

void RequireReadable(const std::string& text) {
  for (const char letter : text) Require(letter >= ' ' && letter <= '~');
}

void CheckLine(const ExecLine& line) {
  Require(!line.arguments.empty() && !line.arguments[0].empty());
  AllowRule own{.program = line.arguments[0], .arguments = "", .environment = ""};
  std::size_t bytes = 0;
  for (const std::string& argument : line.arguments) bytes += argument.size();
  Require(bytes <= kMaxExpandedExecBytes);
  for (std::size_t i = 1; i < line.arguments.size(); ++i)
    own.arguments += Quoted(line.arguments[i]);
  for (const auto& [name, value] : line.environment) own.environment += Quoted(name + "=" + value);
  Require(own.Validate().empty());
  Require(AllowList({own}).WhyRefused(line).empty());
  AllowRule any{.program = own.program, .arguments = "...", .environment = "*"};
  Require(AllowList({own, any}).WhyRefused(line).empty());
  any.program += "x";
  Require(!AllowList({any}).WhyRefused(line).empty());

  const std::string text = own.environment + Quoted(line.arguments[0]) + own.arguments;
  const bool is_setting = line.arguments[0].find('=') != std::string::npos;
  if (text.size() > kMaxExecBytes || is_setting) return;
  const ParsedExecLine again = ParseExecLine(text, Lookup);
  Require(again.line && again.line->arguments == line.arguments);
  Require(again.line->environment == line.environment);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text(reinterpret_cast<const char*>(data), size);
  AllowRule rule;
  rule.program = TakeLine(text);
  rule.arguments = TakeLine(text);
  rule.environment = TakeLine(text);
  const std::vector<std::string> problems = rule.Validate();
  for (const std::string& problem : problems) RequireReadable(problem);

  const ParsedExecLine parsed = ParseExecLine(text, Lookup);
  RequireReadable(parsed.problem);
  Require(parsed.line.has_value() == parsed.problem.empty());
  if (!parsed.line) return 0;
  CheckLine(*parsed.line);
  if (problems.empty()) RequireReadable(AllowList({rule}).WhyRefused(*parsed.line));
  return 0;
}
