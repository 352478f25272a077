// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/host/child_process.hpp"

namespace clearway::test {

/// Where the programs of this build are.
[[nodiscard]] std::filesystem::path ProgramFolder();

/// A program of this build, by its name without "clearway-".
[[nodiscard]] std::string Program(const std::string& name);

/// What a program that ended gave back.
struct ProgramResult {
  int exit_status = -1;  ///< 124 when it had to be ended.
  std::string out;
  std::string err;
};

/// Runs a program to its end, for at most `timeout_s`; `folder` takes what it prints.
[[nodiscard]] ProgramResult RunProgram(const std::vector<std::string>& command,
                                       const std::filesystem::path& folder,
                                       int timeout_s = 120);

/// The programs of the graph, each of which can be ended, frozen and started anew.
class RunningGraph {
 public:
  /// `arguments` goes to every program, `play_arguments` to the player only.
  RunningGraph(std::vector<std::string> arguments,
               std::vector<std::string> play_arguments,
               std::filesystem::path folder);

  /// Names as in <NAME>_STATUS: preprocessor, clusterer, stop_guard, play.
  void Start(const std::string& name);
  void StartAll();
  /// SIGKILL; returns when it is gone.
  void Kill(const std::string& name);
  void Signal(const std::string& name, int signal);
  [[nodiscard]] host::ChildProcess& process(const std::string& name) {
    return *processes_.at(name);
  }

 private:
  std::vector<std::string> arguments_;
  std::vector<std::string> play_arguments_;
  std::filesystem::path folder_;
  std::map<std::string, std::unique_ptr<host::ChildProcess>> processes_;
};

}  // namespace clearway::test
