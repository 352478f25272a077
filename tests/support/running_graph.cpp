// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/running_graph.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <sys/wait.h>
#include <utility>

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

RunningGraph::RunningGraph(std::vector<std::string> arguments,
                           std::vector<std::string> play_arguments,
                           std::filesystem::path folder)
    : arguments_(std::move(arguments)),
      play_arguments_(std::move(play_arguments)),
      folder_(std::move(folder)) {}

void RunningGraph::Start(const std::string& name) {
  std::vector<std::string> command{Program(name)};
  command.insert(command.end(), arguments_.begin(), arguments_.end());
  if (name == "play") {
    command.insert(command.end(), play_arguments_.begin(), play_arguments_.end());
  }
  processes_[name] = std::make_unique<host::ChildProcess>(name, command, folder_ / (name + ".log"));
}

void RunningGraph::StartAll() {
  for (const char* name : {"stop_guard", "preprocessor", "clusterer", "play"}) Start(name);
}

void RunningGraph::Kill(const std::string& name) {
  process(name).Signal(SIGKILL);
  process(name).WaitOrKill(10'000);
}

void RunningGraph::Signal(const std::string& name, int signal) {
  process(name).Signal(signal);
}

}  // namespace clearway::test
