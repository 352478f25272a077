// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/command.hpp"

#include <array>
#include <charconv>
#include <optional>
#include <sstream>
#include <vector>

namespace clearway::relay {
namespace {

using Verb = Command::Verb;

constexpr double kMaxDelay_ms = 60'000.0;

struct Form {
  std::string_view word;
  Verb verb;
  std::optional<double> max_value;  // It takes a value in [0, this], and perhaps a direction.
  bool takes_port = false;
};

constexpr std::array kForms{Form{"loss", Verb::kLoss, 1.0},
                            Form{"duplicate", Verb::kDuplicate, 1.0},
                            Form{"delay-ms", Verb::kDelay, kMaxDelay_ms},
                            Form{"jitter-ms", Verb::kJitter, kMaxDelay_ms},
                            Form{"cut", Verb::kCut, std::nullopt, true},
                            Form{"mend", Verb::kMend, std::nullopt, true},
                            Form{"stats", Verb::kStatistics, std::nullopt},
                            Form{"quit", Verb::kQuit, std::nullopt}};

const Form& FormOf(const std::string& word) {
  std::string known;
  for (const Form& form : kForms) {
    if (form.word == word) return form;
    known += ' ' + std::string(form.word);
  }
  throw CommandError("unknown command \"" + word + "\"; known:" + known);
}

double ParseValue(const std::string& word, const Form& form) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool is_number = error == std::errc() && end == word.data() + word.size();
  // Not in this form for NaN.
  if (!is_number || !(value >= 0.0 && value <= *form.max_value)) {
    std::ostringstream text;
    text << form.word << ": expected a number in [0, " << *form.max_value << "], not \"" << word
         << '"';
    throw CommandError(text.str());
  }
  return value;
}

void ParseDirection(const std::string& word, Command& command) {
  const std::size_t colon = word.find(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == word.size()) {
    throw CommandError("expected FROM:TO, where * is any port, not \"" + word + '"');
  }
  command.from = word.substr(0, colon);
  command.to = word.substr(colon + 1);
}

}  // namespace

Command ParseCommand(std::string_view line) {
  std::istringstream stream{std::string(line)};
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  if (words.empty()) throw CommandError("an empty line");
  const Form& form = FormOf(words[0]);
  const bool takes_value = form.max_value.has_value();
  const std::size_t least = takes_value || form.takes_port ? 2 : 1;
  if (words.size() < least) throw CommandError(words[0] + ": something is missing behind it");
  if (words.size() > least + (takes_value ? 1 : 0)) {
    throw CommandError(words[0] + ": too much behind it: \"" + words.back() + '"');
  }
  Command command{.verb = form.verb};
  if (takes_value) command.value = ParseValue(words[1], form);
  if (form.takes_port) command.from = words[1];
  if (words.size() == 3) ParseDirection(words[2], command);
  return command;
}

}  // namespace clearway::relay
