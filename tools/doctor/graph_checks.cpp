// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/graph_checks.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <set>

#include "common/messages/channels.hpp"

namespace clearway::doctor {
namespace {

namespace channels = messages::channels;

// As a deputy says when the file that it was told of cannot be read.
constexpr char kUnreadable[] = "unreadable";

std::string NameOf(const HeardProcess& process) {
  return process.channel + " from process " + std::to_string(process.pid) + " on " + process.host;
}

// What ssh and scp take for a host and nothing else: anybody on the bus may say what it is called.
bool IsHostName(const std::string& host) {
  return !host.empty() && host.front() != '-' && std::all_of(host.begin(), host.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' || c == '_';
  });
}

// The command, to be given here, for another host by its name; none where that is no name.
std::vector<std::string> On(const std::string& host, const Here& here, const std::string& command) {
  if (host == here.host || host == here.deputy) return {command};
  if (!IsHostName(host)) return {};
  return {"ssh " + host + ' ' + command};
}

std::vector<std::string> EndIt(const HeardProcess& process, const Here& here) {
  return On(process.host, here, "sudo kill " + std::to_string(process.pid));
}

bool IsRunByADeputy(const HeardProcess& process, const Heard& heard) {
  return std::any_of(heard.deputies.begin(), heard.deputies.end(), [&](const HeardDeputy& each) {
    // A deputy that says nothing of its host may be anywhere.
    return each.pids.contains(process.pid) && (!each.is_ours || each.host == process.host);
  });
}

// Channels of sensor data and results, whoever sends them: a player has no status.
bool HasData(const Heard& heard) {
  return heard.channels.contains(channels::kLidarPoints.name) ||
         heard.channels.contains(channels::kObstaclePoints.name) ||
         heard.channels.contains(channels::kDetections.name);
}

Finding Traffic(State state, std::string text) {
  return {.check = "traffic", .state = state, .text = std::move(text), .mend = {}};
}

Findings CheckTwice(const Heard& heard, const Here& here) {
  std::map<std::string, std::vector<const HeardProcess*>> by_channel;
  for (const HeardProcess& each : heard.processes) by_channel[each.channel].push_back(&each);
  Findings findings;
  for (const auto& [channel, processes] : by_channel) {
    if (processes.size() < 2) continue;
    Finding finding = Traffic(State::kWarning, "two graphs on one bus: ");
    std::vector<std::string> names;
    for (const HeardProcess* each : processes) names.push_back(NameOf(*each));
    finding.text += Join(names) + "; end all but one";
    for (std::size_t i = 1; i < processes.size(); ++i) {
      for (std::string& command : EndIt(*processes[i], here)) {
        finding.mend.push_back(std::move(command));
      }
    }
    findings.push_back(std::move(finding));
  }
  return findings;
}

}  // namespace

Findings CheckTraffic(const Heard& heard, const Here& here) {
  Findings findings = CheckTwice(heard, here);
  std::vector<std::string> names;
  std::vector<std::string> mend;
  for (const HeardProcess& each : heard.processes) {
    if (IsRunByADeputy(each, heard)) continue;
    names.push_back(NameOf(each));
    for (std::string& command : EndIt(each, here)) mend.push_back(std::move(command));
  }
  if (!names.empty()) {
    findings.push_back(Traffic(State::kWarning,
                               "a graph runs already that no deputy started; another one on this "
                               "bus would be a second: " +
                                   Join(names)));
    findings.back().mend = std::move(mend);
  } else if (heard.processes.empty() && HasData(heard)) {
    findings.push_back(
        Traffic(State::kWarning,
                "somebody without a status publishes data of a graph (a log player?): " +
                    Join({heard.channels.begin(), heard.channels.end()})));
  }
  if (!findings.empty()) return findings;
  if (heard.channels.empty()) return {Traffic(State::kOk, "nobody publishes on the buses yet")};
  return {Traffic(State::kOk, "heard: " + Join({heard.channels.begin(), heard.channels.end()}))};
}

Findings CheckConfig(const ConfigFacts& config) {
  constexpr char kCheck[] = "configuration";
  if (config.path.empty()) return {{kCheck, State::kNotChecked, "no --config is given", {}}};
  if (config.problems.empty()) {
    return {{kCheck, State::kOk, config.path + " is good; its digest is " + config.digest, {}}};
  }
  Findings findings;
  for (const std::string& problem : config.problems) {
    findings.push_back({kCheck, State::kProblem, problem, {}});
  }
  return findings;
}

namespace {

Finding Digest(State state, std::string text) {
  return {.check = "digests", .state = state, .text = std::move(text), .mend = {}};
}

std::string NameOf(const HeardDeputy& deputy) {
  return "deputy \"" + deputy.id + "\" on " + deputy.host;
}

// Brings this host's file to the deputy's host, to the same place.
std::string CopyTo(const std::string& host, const std::string& path) {
  const std::string file = std::filesystem::absolute(path).string();
  return "scp " + ShellWord(file) + ' ' + ShellWord("root@" + host + ':' + file);
}

// The digest that all are compared with: this host's, else that of the first deputy that has one.
std::string ReferenceDigest(const Heard& heard, const ConfigFacts& config) {
  if (!config.digest.empty()) return config.digest;
  for (const HeardDeputy& each : heard.deputies) {
    if (!each.config_digest.empty() && each.config_digest != kUnreadable) return each.config_digest;
  }
  return {};
}

Finding CheckDigestOf(const HeardDeputy& deputy,
                      const std::string& reference,
                      const ConfigFacts& config,
                      const Here& here) {
  const std::string name = NameOf(deputy);
  if (deputy.config_digest.empty()) {
    Finding finding = Digest(State::kWarning,
                             name +
                                 " was not told of the graph's configuration: set "
                                 "<deputy graph_config=\"...\"> in its host's file");
    finding.mend = On(deputy.host, here, "sudoedit /etc/clearway/deputy.xml");
    return finding;
  }
  if (deputy.config_digest == reference) {
    return Digest(State::kOk, name + " has the same configuration (" + reference + ")");
  }
  Finding finding = Digest(State::kProblem, name);
  if (deputy.config_digest == kUnreadable) {
    finding.text += " cannot use its configuration";
  } else {
    finding.text +=
        " has another configuration: digest " + deputy.config_digest + " instead of " + reference;
  }
  if (deputy.host == here.host) {
    const bool is_known = deputy.id == here.deputy && !here.deputy_config.empty();
    finding.text += is_known ? "; its file is " + here.deputy_config
                             : "; its file is named by <deputy graph_config> or --set";
    if (is_known && !config.digest.empty()) {
      finding.mend = {"sudo cp " + ShellWord(config.path) + ' ' + ShellWord(here.deputy_config)};
    }
  } else if (!config.digest.empty() && IsHostName(deputy.host)) {
    finding.mend = {CopyTo(deputy.host, config.path)};
  }
  return finding;
}

}  // namespace

Findings CheckDigests(const Heard& heard, const ConfigFacts& config, const Here& here) {
  const std::string reference = ReferenceDigest(heard, config);
  Findings findings;
  for (const HeardDeputy& each : heard.deputies) {
    if (each.is_ours) findings.push_back(CheckDigestOf(each, reference, config, here));
  }
  for (const HeardProcess& each : heard.processes) {
    if (reference.empty() || each.config_digest == reference ||
        each.config_digest == config.effective_digest) {
      continue;
    }
    findings.push_back(Digest(State::kWarning,
                              NameOf(each) + " runs with another configuration: digest " +
                                  each.config_digest + " instead of " + reference +
                                  " (an older file, or started with --set or --lcm-url)"));
    findings.back().mend = EndIt(each, here);
  }
  if (!findings.empty()) return findings;
  return {heard.processes.empty()
              ? Digest(State::kNotChecked, "no deputy and no process was heard to compare with")
              : Digest(State::kOk, "all processes run with one configuration")};
}

Findings CheckVersions(const Heard& heard, const Here& here) {
  constexpr char kCheck[] = "versions";
  Findings findings;
  const auto compare = [&](const std::string& name, const std::string& version) {
    if (version == here.version) return;
    findings.push_back({kCheck,
                        State::kProblem,
                        name + " is version " + version + ", this program is " + here.version +
                            ": install the same on all hosts",
                        {}});
  };
  std::size_t num_compared = heard.processes.size();
  for (const HeardDeputy& each : heard.deputies) {
    if (each.is_ours) {
      compare(NameOf(each), each.version);
      ++num_compared;
    } else {
      findings.push_back({kCheck,
                          State::kWarning,
                          "deputy \"" + each.id +
                              "\" tells no version: it is another procman's, or of a version "
                              "with other messages",
                          {}});
    }
  }
  for (const HeardProcess& each : heard.processes) compare(NameOf(each), each.version);
  if (!findings.empty()) return findings;
  if (num_compared == 0) {
    return {{kCheck, State::kNotChecked, "no deputy and no process was heard to compare with", {}}};
  }
  return {{kCheck, State::kOk, "all that was heard is version " + here.version, {}}};
}

Findings CheckDeputies(const Heard& heard,
                       const std::vector<std::string>& wanted_ids,
                       const Here& here) {
  constexpr char kCheck[] = "deputies";
  Findings findings;
  std::vector<std::string> there;
  for (const HeardDeputy& each : heard.deputies) {
    there.push_back(each.id);
    if (each.problem.empty()) continue;
    findings.push_back({kCheck, State::kWarning, NameOf(each) + " says: " + each.problem, {}});
  }
  for (const std::string& id : std::set<std::string>(wanted_ids.begin(), wanted_ids.end())) {
    if (std::find(there.begin(), there.end(), id) != there.end()) continue;
    findings.push_back({kCheck,
                        State::kWarning,
                        "deputy \"" + id + "\" of the deployment was not heard",
                        On(id, here, "sudo systemctl start clearway-deputy")});
  }
  if (!findings.empty()) return findings;
  if (there.empty()) return {{kCheck, State::kOk, "none was heard, and none is asked for", {}}};
  return {{kCheck, State::kOk, "heard: " + Join(there), {}}};
}

}  // namespace clearway::doctor
