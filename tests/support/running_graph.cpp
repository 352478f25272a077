// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/running_graph.hpp"

#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <sys/wait.h>
#include <utility>

#include "common/core/procman/exec_string.hpp"

namespace clearway::test {
namespace {

std::string Quoted(const std::string& word) {
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string ContentOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

std::filesystem::path ProgramFolder() {
  const char* const folder = std::getenv("CLEARWAY_BIN");
  if (folder == nullptr) throw std::runtime_error("CLEARWAY_BIN is not set: run by ctest");
  return folder;
}

std::string Program(const std::string& name) {
  std::string file = "clearway-" + name;
  std::replace(file.begin(), file.end(), '_', '-');
  return ProgramFolder() / file;
}

ProgramResult RunProgram(const std::vector<std::string>& command,
                         const std::filesystem::path& folder,
                         int timeout_s) {
  const std::filesystem::path out = folder / "program.out";
  const std::filesystem::path err = folder / "program.err";
  std::string line = "timeout --kill-after=10 " + std::to_string(timeout_s);
  for (const std::string& word : command) line += ' ' + Quoted(word);
  line += " >" + Quoted(out) + " 2>" + Quoted(err) + " </dev/null";
  const int status = std::system(line.c_str());
  ProgramResult result;
  result.exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  result.out = ContentOf(out);
  result.err = ContentOf(err);
  return result;
}

RunningGraph::RunningGraph(const std::string& url,
                           std::vector<std::string> arguments,
                           std::vector<std::string> play_arguments,
                           std::filesystem::path folder)
    : url_(url + "?ttl=0"),
      arguments_(std::move(arguments)),
      play_arguments_(std::move(play_arguments)),
      folder_(std::move(folder)) {
  peer_.emplace(url_);
}

void RunningGraph::StartDeputy() {
  const std::vector<std::string> command{Program("deputy"),
                                         "--id",
                                         kDeputy,
                                         "--lcm-url",
                                         url_,
                                         "--allow-any",
                                         "--allow-root",
                                         "--set",
                                         "deputy.state_folder=" + (folder_ / "state").string(),
                                         "--set",
                                         "deputy.logs.folder=" + folder_.string()};
  deputy_ = std::make_unique<host::ChildProcess>("deputy", command, folder_ / "deputy.log");
}

void RunningGraph::KillDeputy() {
  deputy_->Signal(SIGKILL);
  deputy_->WaitOrKill(10'000);
}

core::procman::DesiredCommand RunningGraph::CommandOf(const std::string& name) const {
  std::string channel = name + "_STATUS";
  for (char& c : channel) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  core::procman::ExecLine line{.environment = {{"CLEARWAY_STATUS_CHANNEL", channel}},
                               .arguments = {Program(name)}};
  line.arguments.insert(line.arguments.end(), arguments_.begin(), arguments_.end());
  if (name == "play") {
    line.arguments.emplace_back("--headless");
    line.arguments.insert(line.arguments.end(), play_arguments_.begin(), play_arguments_.end());
  }
  core::procman::DesiredCommand command = Wanted(name, core::procman::FormatExecLine(line));
  command.spec.auto_respawn = respawns_;
  const auto known = commands_.find(name);
  command.run_id = known == commands_.end() ? 1 : known->second.run_id + 1;
  return command;
}

void RunningGraph::Order(const std::vector<std::string>& names) {
  if (!deputy_) StartDeputy();
  if (!peer_->AwaitDeputy(kDeputy)) {
    throw std::runtime_error("no deputy:\n" + deputy_->LastWords());
  }
  for (const std::string& name : names) commands_[name] = CommandOf(name);
  std::vector<core::procman::DesiredCommand> orders;
  for (const auto& [name, command] : commands_) orders.push_back(command);
  const auto all_run = [&] {
    return std::all_of(names.begin(), names.end(), [this](const std::string& name) {
      return PidOf(name) != 0 && peer_->Command(kDeputy, name).run_id == commands_.at(name).run_id;
    });
  };
  // As a sheriff: again and again, since one may be lost.
  for (int attempt = 0; attempt < 30; ++attempt) {
    peer_->Order(kDeputy, orders);
    if (peer_->Await(all_run, 1'000'000)) return;
  }
  throw std::runtime_error("does not start:\n" + deputy_->LastWords());
}

std::int32_t RunningGraph::PidOf(const std::string& name) const {
  return peer_->Command(kDeputy, name).pid;
}

void RunningGraph::Signal(const std::string& name, int signal) {
  const std::int32_t pid = PidOf(name);
  if (pid == 0) throw std::runtime_error(name + " does not run");
  kill(pid, signal);
}

void RunningGraph::Kill(const std::string& name) {
  const std::int32_t pid = PidOf(name);
  Signal(name, SIGKILL);
  if (!peer_->Await([&] { return PidOf(name) != pid; })) {
    throw std::runtime_error("nobody told that " + name + " ended");
  }
}

std::optional<int> RunningGraph::AwaitEnd(const std::string& name, std::int64_t timeout_us) {
  if (!peer_->Await([&] { return PidOf(name) == 0; }, timeout_us)) return std::nullopt;
  const int status = peer_->Command(kDeputy, name).exit_code;
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace clearway::test
