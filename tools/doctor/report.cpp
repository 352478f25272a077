// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/report.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include <nlohmann/json.hpp>

namespace clearway::doctor {
namespace {

const char* NameOf(State state) {
  switch (state) {
    case State::kOk:
      return "ok";
    case State::kWarning:
      return "warning";
    case State::kProblem:
      return "problem";
    case State::kNotChecked:
      break;
  }
  return "not checked";
}

// First in a line, so that what matters is found by the eye.
const char* MarkOf(State state) {
  switch (state) {
    case State::kOk:
      return "[ok]";
    case State::kWarning:
      return "[warning]";
    case State::kProblem:
      return "[PROBLEM]";
    case State::kNotChecked:
      break;
  }
  return "[-]";
}

// What other hosts said must not move a terminal's cursor.
std::string Printable(std::string text) {
  std::replace_if(
      text.begin(),
      text.end(),
      [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; },
      '?');
  return text;
}

std::size_t Count(const Findings& findings, State state) {
  return static_cast<std::size_t>(std::count_if(
      findings.begin(), findings.end(), [state](const Finding& f) { return f.state == state; }));
}

std::string Counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + ' ' + noun + (count == 1 ? "" : "s");
}

}  // namespace

std::string FormatText(const Findings& findings) {
  std::string text;
  for (const Finding& finding : findings) {
    std::array<char, 64> head{};
    std::snprintf(
        head.data(), head.size(), "%-9s %-16s ", MarkOf(finding.state), finding.check.c_str());
    text += head.data();
    if (finding.state == State::kNotChecked) text += "not checked: ";
    text += Printable(finding.text) + '\n';
    for (const std::string& command : finding.mend) {
      text += "          mend: " + Printable(command) + '\n';
    }
  }
  return text + Counted(Count(findings, State::kProblem), "problem") + ", " +
         Counted(Count(findings, State::kWarning), "warning") + '\n';
}

std::string FormatJson(const Patient& patient, const Findings& findings) {
  nlohmann::ordered_json json;
  json["version"] = patient.version;
  json["host"] = patient.host;
  json["deputy"] = patient.deputy;
  json["problems"] = Count(findings, State::kProblem);
  json["warnings"] = Count(findings, State::kWarning);
  json["findings"] = nlohmann::ordered_json::array();
  for (const Finding& finding : findings) {
    json["findings"].push_back({{"check", finding.check},
                                {"state", NameOf(finding.state)},
                                {"text", finding.text},
                                {"mend", finding.mend}});
  }
  // Names from other hosts need not be UTF-8.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

int ExitStatusOf(const Findings& findings) {
  return Count(findings, State::kProblem) > 0 ? 1 : 0;
}

}  // namespace clearway::doctor
