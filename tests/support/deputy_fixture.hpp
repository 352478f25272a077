// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/host/child_process.hpp"
#include "common/host/process_table.hpp"
#include "tests/support/live_buses.hpp"
#include "tests/support/procman_peer.hpp"
#include "tests/support/running_graph.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::test {

/// Real deputies on a bus of the test's own, and a peer that gives them orders.
class DeputyProgramTest : public testing::Test {
 protected:
  using State = core::procman::CommandState;

  /// One more deputy; `more` are further arguments.
  host::ChildProcess& StartDeputy(const std::string& id, std::vector<std::string> more = {}) {
    std::vector<std::string> command{Program("deputy"),
                                     "--id",
                                     id,
                                     "--lcm-url",
                                     url_ + "?ttl=0",
                                     "--allow-root",
                                     "--set",
                                     "deputy.logs.folder=" + LogFolder(id).string()};
    if (std::find(more.begin(), more.end(), "--config") == more.end()) {
      more.emplace_back("--allow-any");
    }
    command.insert(command.end(), more.begin(), more.end());
    command.insert(command.begin(), launcher_.begin(), launcher_.end());
    const std::string name = "deputy" + std::to_string(deputies_.size());
    deputies_.push_back(
        std::make_unique<host::ChildProcess>(name, command, folder_.path() / (name + ".log")));
    return *deputies_.back();
  }

  [[nodiscard]] std::filesystem::path LogFolder(const std::string& id) const {
    return folder_.path() / ("logs_" + id);
  }

  void StartDeputyAndAwait(const std::string& id, std::vector<std::string> more = {}) {
    StartDeputy(id, std::move(more));
    ASSERT_TRUE(peer_.AwaitDeputy(id)) << deputies_.back()->LastWords();
  }

  [[nodiscard]] static bool IsAlive(std::int32_t pid) {
    const auto process = host::ReadProcess(pid);
    return process && process->state != 'Z';
  }

  /// A process of this host whose command line holds `text`.
  [[nodiscard]] static std::int32_t PidWith(const std::string& text) {
    const host::ProcessTable table = host::ProcessTable::Read();
    for (const host::ProcessEntry& process : table.entries()) {
      std::ifstream file("/proc/" + std::to_string(process.pid) + "/cmdline");
      std::string line((std::istreambuf_iterator<char>(file)), {});
      std::replace(line.begin(), line.end(), '\0', ' ');
      if (process.state != 'Z' && line.find(text) != std::string::npos) return process.pid;
    }
    return 0;
  }

  [[nodiscard]] const std::string& OutputOf(const std::string& id) {
    return peer_.output[{"d", id}];
  }
  bool AwaitOutput(const std::string& id, const std::string& text) {
    return peer_.Await([&] { return OutputOf(id).find(text) != std::string::npos; });
  }

  std::vector<std::string> launcher_;  ///< Words before a deputy's own: a program that starts it.
  TestFolder folder_;
  std::string url_{TestUrl(NextPort())};
  ProcmanPeer peer_{url_};
  std::vector<std::unique_ptr<host::ChildProcess>> deputies_;

 private:
  static int NextPort() {
    static int port = 17700;
    return port++;
  }
};

}  // namespace clearway::test
