// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/allow_list.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <fnmatch.h>

#include "common/core/procman/exec_words.hpp"

namespace clearway::core::procman {
namespace {

using internal::ExecWord;

// The deputy itself reads them, and they change only how it looks after the command.
constexpr std::array<std::string_view, 2> kAlwaysAllowed = {"CLEARWAY_STATUS_CHANNEL",
                                                            "CLEARWAY_RESTART_UNHEALTHY"};

// As fnmatch() takes it, where brackets and backslashes are special too.
std::string PatternOf(const ExecWord& word, std::size_t begin, std::size_t end) {
  std::string pattern;
  for (std::size_t i = begin; i < end; ++i) {
    const char character = word.text[i];
    const bool is_wildcard = !word.is_literal[i] && (character == '*' || character == '?');
    if (!is_wildcard) pattern += '\\';
    pattern += character;
  }
  return pattern;
}

std::string PatternOf(const ExecWord& word) {
  return PatternOf(word, 0, word.text.size());
}

bool IsMatch(const std::string& pattern, const std::string& text) {
  return fnmatch(pattern.c_str(), text.c_str(), 0) == 0;
}

bool MeansMore(const ExecWord& word) {
  return word.text == "..." && !word.is_literal[0];
}

// Of what may come from anywhere, fit for a message of one line.
std::string Quoted(std::string_view text) {
  constexpr std::size_t kMaxShown = 80;
  std::string quoted = "\"" + std::string(text.substr(0, kMaxShown));
  std::replace_if(
      quoted.begin(), quoted.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return quoted + (text.size() > kMaxShown ? "...\"" : "\"");
}

}  // namespace

std::vector<std::string> AllowRule::Validate() const {
  std::vector<std::string> problems;
  if (program.empty()) problems.emplace_back("program must not be empty");
  const internal::SplitExecWords of_arguments = internal::SplitIntoExecWords(arguments);
  if (!of_arguments.problem.empty()) {
    problems.push_back("arguments must be words as in a command, but " + of_arguments.problem);
  }
  for (std::size_t i = 0; i + 1 < of_arguments.words.size(); ++i) {
    if (!MeansMore(of_arguments.words[i])) continue;
    problems.emplace_back("arguments must have ... as the last word only");
    break;
  }
  const internal::SplitExecWords of_environment = internal::SplitIntoExecWords(environment);
  if (!of_environment.problem.empty()) {
    problems.push_back("environment must be words as in a command, but " + of_environment.problem);
  }
  for (const ExecWord& word : of_environment.words) {
    if (!word.text.empty() && word.text[0] != '=') continue;
    problems.push_back("environment must have a variable's name in each pattern, not " +
                       Quoted(word.text));
  }
  return problems;
}

AllowList::AllowList(const std::vector<AllowRule>& rules) {
  for (const AllowRule& rule : rules) rules_.push_back(TakeApart(rule));
}

AllowList::Rule AllowList::TakeApart(const AllowRule& rule) {
  Rule taken;
  taken.program = rule.program;
  std::vector<ExecWord> words = internal::SplitIntoExecWords(rule.arguments).words;
  taken.takes_more_arguments = !words.empty() && MeansMore(words.back());
  if (taken.takes_more_arguments) words.pop_back();
  for (const ExecWord& word : words) taken.arguments.push_back(PatternOf(word));
  for (const ExecWord& word : internal::SplitIntoExecWords(rule.environment).words) {
    const std::size_t equals = word.text.find('=');
    if (equals == std::string::npos) {
      taken.variables.push_back({PatternOf(word), "*"});
    } else {
      taken.variables.push_back(
          {PatternOf(word, 0, equals), PatternOf(word, equals + 1, word.text.size())});
    }
  }
  return taken;
}

bool AllowList::IsVariableAllowed(const Rule& rule,
                                  const std::string& name,
                                  const std::string& value) {
  const auto* const end = kAlwaysAllowed.end();
  if (std::find(kAlwaysAllowed.begin(), end, name) != end) return true;
  return std::any_of(rule.variables.begin(), rule.variables.end(), [&](const auto& pattern) {
    return IsMatch(pattern.name, name) && IsMatch(pattern.value, value);
  });
}

AllowList::Refusal AllowList::RefusalBy(const Rule& rule, const ExecLine& line) {
  const std::string of_program = " of " + Quoted(line.arguments[0]);
  const std::size_t num_given = line.arguments.size() - 1;
  for (std::size_t i = 0; i < num_given; ++i) {
    const std::string& argument = line.arguments[i + 1];
    const bool is_allowed = i < rule.arguments.size() ? IsMatch(rule.arguments[i], argument)
                                                      : rule.takes_more_arguments;
    if (is_allowed) continue;
    return {i,
            "argument " + std::to_string(i + 1) + " " + Quoted(argument) + of_program +
                " is not allowed"};
  }
  if (num_given < rule.arguments.size()) {
    return {num_given,
            Quoted(line.arguments[0]) + " is not allowed without an argument " +
                std::to_string(num_given + 1)};
  }
  for (std::size_t i = 0; i < line.environment.size(); ++i) {
    const auto& [name, value] = line.environment[i];
    if (IsVariableAllowed(rule, name, value)) continue;
    std::string setting = name;
    setting.append("=").append(value);
    return {num_given + i, "variable " + Quoted(setting) + of_program + " is not allowed"};
  }
  return {};
}

std::string AllowList::WhyRefused(const ExecLine& line) const {
  if (line.arguments.empty()) return "it names no program";
  const Refusal* furthest = nullptr;
  std::vector<Refusal> refusals;
  refusals.reserve(rules_.size());
  for (const Rule& rule : rules_) {
    if (rule.program != line.arguments[0]) continue;
    refusals.push_back(RefusalBy(rule, line));
    if (refusals.back().reason.empty()) return {};
    if (furthest == nullptr || refusals.back().num_passed > furthest->num_passed) {
      furthest = &refusals.back();
    }
  }
  if (furthest == nullptr) return "no rule allows the program " + Quoted(line.arguments[0]);
  return furthest->reason;
}

}  // namespace clearway::core::procman
