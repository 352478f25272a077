// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/messages/procman.hpp"

/// What was heard on the buses for a while.
namespace clearway::doctor {

/// A process of a graph, by its status.
struct HeardProcess {
  std::string channel;
  std::string host;
  std::int32_t pid = 0;
  std::string version;
  std::string config_digest;
};

struct HeardDeputy {
  std::string id;
  bool is_ours =
      false;  ///< It publishes PM_HEALTH, in this version's type: the next four are known.
  std::string host;
  std::string version;
  std::string config_digest;    ///< Empty: it was not told of a configuration.
  std::string problem;          ///< What it says of itself; empty: nothing is wrong.
  std::set<std::int32_t> pids;  ///< Of the commands that it runs.
};

struct Heard {
  std::set<std::string> channels;
  std::vector<HeardProcess> processes;  ///< By channel, then host and process id.
  std::vector<HeardDeputy> deputies;    ///< By id.
};

/// Makes sense of messages, whatever their order and whoever sent them.
class Listener {
 public:
  void OnMessage(const std::string& channel, std::span<const std::byte> bytes);
  [[nodiscard]] Heard Result() const;

 private:
  void OnInfo(std::span<const std::byte> bytes);
  void OnHealth(std::span<const std::byte> bytes);

  std::set<std::string> channels_;
  std::map<std::pair<std::string, std::int64_t>, HeardProcess> processes_;  // By channel, session.
  std::map<std::string, HeardDeputy> deputies_;
  std::map<std::string, messages::HealthAssembler> assemblers_;
};

}  // namespace clearway::doctor
