// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/deployment_checks.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <set>
#include <string_view>

#include "common/messages/channels.hpp"
#include "processes/procman_deputy/child_set.hpp"

namespace clearway::doctor {
namespace {

using core::procman::DeployedCommand;
using core::procman::Deployment;
using core::procman::ExecLine;

constexpr char kCheck[] = "deployment";
constexpr std::string_view kProgramPrefix = "clearway-";
constexpr std::string_view kSensorDriver = "clearway-livox-driver";

// What the deputy itself reads needs no permission.
bool IsAlwaysAllowed(const std::string& name) {
  return name == kStatusChannelVariable || name == kRestartUnhealthyVariable;
}

std::string BaseName(const std::string& program) {
  return std::filesystem::path(program).filename().string();
}

// A word of a pattern that means exactly `text`.
std::string PatternWord(const std::string& text) {
  if (text.empty()) return "''";
  std::string word;
  for (const char c : text) {
    if (std::string_view("*?\\'\" \t\n\r\f\v").find(c) != std::string_view::npos) word += '\\';
    word += c;
  }
  return text == "..." ? "\\..." : word;
}

std::string XmlAttribute(const std::string& name, const std::string& value) {
  std::string text = ' ' + name + "=\"";
  for (const char c : value) {
    switch (c) {
      case '&':
        text += "&amp;";
        break;
      case '<':
        text += "&lt;";
        break;
      case '"':
        text += "&quot;";
        break;
      case '\t':
      case '\n':
      case '\r':
        text += "&#" + std::to_string(int{c}) + ';';  // As it is it would become a space.
        break;
      default:
        text += c;
    }
  }
  return text + '"';
}

std::optional<std::string> SettingOf(const ExecLine& line, std::string_view name) {
  std::optional<std::string> value;
  for (const auto& [key, text] : line.environment) {
    if (key == name) value = text;
  }
  return value;
}

// The channel of a program of the graph's own; nothing when it is not one.
std::optional<std::string> StatusChannelOf(const std::string& program) {
  const std::string name = BaseName(program);
  if (!name.starts_with(kProgramPrefix)) return std::nullopt;
  std::string channel = name.substr(kProgramPrefix.size()) + "_STATUS";
  for (char& c : channel) {
    c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  const auto& all = messages::channels::kAllStatuses;
  const bool is_known = std::any_of(
      all.begin(), all.end(), [&channel](const auto& each) { return channel == each.name; });
  return is_known ? std::optional(channel) : std::nullopt;
}

// What follows --config.
std::optional<std::string> ConfigOf(const ExecLine& line) {
  constexpr std::string_view kOption = "--config";
  for (std::size_t i = 1; i < line.arguments.size(); ++i) {
    const std::string& argument = line.arguments[i];
    if (argument == kOption && i + 1 < line.arguments.size()) return line.arguments[i + 1];
    if (argument.starts_with(std::string(kOption) + '='))
      return argument.substr(kOption.size() + 1);
  }
  return std::nullopt;
}

// Judges one command after the other; a file that many name is judged once.
class CommandChecker {
 public:
  CommandChecker(const Deployment& deployment, const HostView& host)
      : deployment_(deployment), host_(host) {}

  void Check(const DeployedCommand& command) {
    const core::procman::ParsedExecLine parsed =
        core::procman::ParseExecLine(command.spec.exec, host_.variable);
    if (!parsed.line) {
      Add(command, State::kProblem, parsed.problem);
      return;
    }
    CheckVariables(command, *parsed.line);
    CheckProgram(command, *parsed.line);
    CheckAllowed(command, *parsed.line);
    CheckStatus(command, *parsed.line);
    CheckRestart(command, *parsed.line);
    CheckConfig(command, *parsed.line);
  }

  [[nodiscard]] Findings Take() { return std::move(findings_); }

 private:
  Finding& Add(const DeployedCommand& command, State state, const std::string& text) {
    findings_.push_back({kCheck,
                         state,
                         deployment_.file + ':' + std::to_string(command.line) + ": \"" +
                             command.spec.id + "\": " + text,
                         {}});
    return findings_.back();
  }

  // A name that is not set stays as it is written, which no program means.
  void CheckVariables(const DeployedCommand& command, const ExecLine& line) {
    for (const std::string& argument : line.arguments) {
      const std::size_t begin = argument.find("${");
      const std::size_t end = begin == std::string::npos ? begin : argument.find('}', begin);
      if (end == std::string::npos) continue;
      const std::string name = argument.substr(begin + 2, end - begin - 2);
      if (!unset_.insert(name).second) continue;
      Add(command,
          State::kProblem,
          "the variable " + name + " is not set here; the deputy needs it")
          .mend = {"# systemctl edit clearway-deputy, below [Service]: Environment=" + name +
                   "=VALUE"};
    }
  }

  void CheckProgram(const DeployedCommand& command, const ExecLine& line) {
    const std::string& program = line.arguments.front();
    if (host_.find_program(program)) return;
    Add(command, State::kProblem, "no program \"" + program + "\" in " + host_.search_path);
  }

  void CheckAllowed(const DeployedCommand& command, const ExecLine& line) {
    if (!host_.allowed) return;
    const std::string why = host_.allowed->WhyRefused(line);
    if (why.empty()) return;
    Add(command, State::kProblem, "the host's file refuses it: " + why).mend = {
        "# in " + host_.host_file + ", below <clearway>: " + AllowElement(line)};
  }

  void CheckStatus(const DeployedCommand& command, const ExecLine& line) {
    const auto given = SettingOf(line, kStatusChannelVariable);
    if (!given) return;
    const auto own = StatusChannelOf(line.arguments.front());
    if (own && *given != *own && !given->ends_with(*own)) {  // A prefix may stand before it.
      Add(command,
          State::kProblem,
          BaseName(line.arguments.front()) + " publishes " + *own + ", not " + *given +
              ": it would never become ready")
          .mend = {"# in " + deployment_.file + ": " + kStatusChannelVariable + '=' + *own};
    } else if (!own && !IsKnownStatus(*given)) {
      Add(command,
          State::kWarning,
          *given +
              " is no status that a program of clearway publishes: without one the command "
              "would never become ready");
    }
  }

  static bool IsKnownStatus(const std::string& channel) {
    const auto& all = messages::channels::kAllStatuses;
    return std::any_of(all.begin(), all.end(), [&channel](const auto& each) {
      return channel.ends_with(each.name);
    });
  }

  void CheckRestart(const DeployedCommand& command, const ExecLine& line) {
    const auto given = SettingOf(line, kRestartUnhealthyVariable);
    if (!given) return;
    int seconds = 0;
    const char* const end = given->data() + given->size();
    const auto [stop, error] = std::from_chars(given->data(), end, seconds);
    if (error == std::errc() && stop == end && seconds >= 1 && seconds <= 86400) return;
    Add(command,
        State::kProblem,
        std::string(kRestartUnhealthyVariable) + "=\"" + *given +
            "\": expected whole seconds in [1, 86400]");
  }

  void CheckConfig(const DeployedCommand& command, const ExecLine& line) {
    const auto file = ConfigOf(line);
    if (!file || file->find("${") != std::string::npos || !files_.insert(*file).second) return;
    const bool is_of_graph = StatusChannelOf(line.arguments.front()).has_value();
    const NamedConfig config = host_.read_config(*file, is_of_graph);
    if (!config.is_readable) {
      Finding& finding = Add(command, State::kProblem, "its --config " + *file + " cannot be read");
      if (is_of_graph && !host_.graph_config.empty()) {
        finding.mend = {"sudo install -D -m 644 " + ShellWord(host_.graph_config) + ' ' +
                        ShellWord(*file)};
      }
      return;
    }
    for (const std::string& problem : config.problems) Add(command, State::kProblem, problem);
    if (std::filesystem::path(*file).is_relative()) {
      Add(command,
          State::kWarning,
          "its --config " + *file + " is relative: it starts at the deputy's working folder");
    }
  }

  const Deployment& deployment_;
  const HostView& host_;
  std::set<std::string> files_;
  std::set<std::string> unset_;
  Findings findings_;
};

}  // namespace

Findings CheckCommands(const Deployment& deployment,
                       const std::string& deputy,
                       const HostView& host) {
  CommandChecker checker(deployment, host);
  std::size_t num_own = 0;
  for (const DeployedCommand& command : deployment.commands) {
    if (command.deputy != deputy) continue;
    ++num_own;
    checker.Check(command);
  }
  if (num_own == 0) {
    return {{kCheck,
             State::kWarning,
             deployment.file + ": no command is for this host's deputy \"" + deputy +
                 "\"; it names " + Join(DeputiesOf(deployment)),
             {}}};
  }
  Findings findings = checker.Take();
  if (!host.allowed) {
    findings.push_back({kCheck,
                        State::kWarning,
                        "there is no " + host.host_file +
                            ": a deputy refuses all commands without it (or --allow-any)",
                        {}});
  }
  if (!findings.empty()) return findings;
  return {{kCheck,
           State::kOk,
           deployment.file + ": the " + std::to_string(num_own) + " commands of deputy \"" +
               deputy + "\" can run here",
           {}}};
}

std::vector<std::string> DeputiesOf(const Deployment& deployment) {
  std::set<std::string> ids;
  for (const DeployedCommand& command : deployment.commands) ids.insert(command.deputy);
  return {ids.begin(), ids.end()};
}

bool HasLiveSensor(const Deployment& deployment, const std::string& deputy) {
  return std::any_of(
      deployment.commands.begin(), deployment.commands.end(), [&](const DeployedCommand& command) {
        if (command.deputy != deputy) return false;
        const auto parsed = core::procman::ParseExecLine(
            command.spec.exec, [](const std::string&) { return std::optional<std::string>(); });
        return parsed.line && BaseName(parsed.line->arguments.front()) == kSensorDriver;
      });
}

std::string AllowElement(const ExecLine& line) {
  std::string arguments;
  for (std::size_t i = 1; i < line.arguments.size(); ++i) {
    arguments += (i > 1 ? " " : "") + PatternWord(line.arguments[i]);
  }
  std::string environment;
  for (const auto& [name, value] : line.environment) {
    if (IsAlwaysAllowed(name)) continue;
    environment +=
        (environment.empty() ? "" : " ") + PatternWord(std::string(name).append("=").append(value));
  }
  std::string element = "<allow" + XmlAttribute("program", line.arguments.front());
  if (!arguments.empty()) element += XmlAttribute("arguments", arguments);
  if (!environment.empty()) element += XmlAttribute("environment", environment);
  return element + "/>";
}

}  // namespace clearway::doctor
