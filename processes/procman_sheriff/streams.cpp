// SPDX-License-Identifier: BSD-3-Clause
// What verbs print as it happens, and who else gives orders.
#include <cerrno>
#include <charconv>
#include <csignal>

#include "processes/procman_sheriff/table.hpp"
#include "processes/procman_sheriff/verbs.hpp"

namespace clearway {
namespace {

// A line that is longer is printed in pieces.
constexpr std::size_t kMaxLineBytes = 4096;

// Only colours pass of what a terminal would obey.
std::string ForTerminal(const std::string& line) {
  std::string clean;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const auto byte = static_cast<unsigned char>(line[i]);
    if (line.compare(i, 2, "\x1b[") == 0) {
      const std::size_t end = line.find_first_not_of("0123456789;", i + 2);
      if (end != std::string::npos && line[end] == 'm') clean += line.substr(i, end - i + 1);
      if (end == std::string::npos) break;
      i = end;
    } else if (byte == '\t' || (byte >= 0x20 && byte != 0x7F)) {
      clean += line[i];
    }
  }
  return clean;
}

}  // namespace

void SheriffVerbRun::PrintOutput(const CommandOutput& output) {
  if (phase_ != Phase::kStreaming || !FollowsOutputOf(output.command)) return;
  const bool many = process_.sheriff().Look(runtime_.MonotonicUs()).deputies.size() > 1;
  const std::string who = output.command.empty() ? output.deputy
                          : many                 ? output.deputy + "/" + output.command
                                                 : output.command;
  const std::string prefix = Printable(who) + ": ";
  std::string& rest = unfinished_lines_[prefix];
  rest += output.text;
  for (std::size_t end = rest.find('\n'); end != std::string::npos; end = rest.find('\n')) {
    printer_.out(prefix + ForTerminal(rest.substr(0, end)));
    rest.erase(0, end + 1);
  }
  if (rest.size() > kMaxLineBytes) {
    printer_.out(prefix + ForTerminal(rest));
    rest.clear();
  }
}

// Targets are looked up each time: commands become known as deputies report.
bool SheriffVerbRun::FollowsOutputOf(const std::string& command) {
  if (request_.targets.empty()) return true;
  if (command.empty()) return false;
  const auto commands = KnownCommands();
  targets_.clear();
  for (const std::string& word : request_.targets) {
    const NamedTarget named = FindTarget(word, commands);
    if (named.target) targets_.push_back(*named.target);
  }
  return !targets_.empty() && IsTargeted(command);
}

void SheriffVerbRun::PrintChange(const core::procman::Change& change) {
  const bool is_observing = phase_ == Phase::kStreaming && request_.verb == SheriffVerb::kObserve;
  if (is_observing) {
    printer_.out(request_.json ? ChangeJson(change) : ChangeLine(change));
    return;
  }
  const bool is_progress = phase_ == Phase::kActing && printer_.shows_progress &&
                           change.kind == core::procman::Change::Kind::kCommand;
  if (!is_progress || (request_.verb != SheriffVerb::kRun && !IsTargeted(change.command))) return;
  printer_.error(Printable(change.command) + ": " + (change.to.empty() ? "gone" : change.to) +
                 (change.text.empty() ? "" : ", " + Printable(change.text)));
}

bool HasSheriffEnded(const std::string& sheriff_id, const std::string& host) {
  if (!sheriff_id.starts_with(host + ":")) return false;
  const char* begin = sheriff_id.data() + host.size() + 1;
  const char* end = sheriff_id.data() + sheriff_id.size();
  int pid = 0;
  const auto [stop, error] = std::from_chars(begin, end, pid);
  if (error != std::errc() || stop == end || *stop != ':' || pid <= 0) return false;
  return kill(pid, 0) != 0 && errno == ESRCH;
}

}  // namespace clearway
