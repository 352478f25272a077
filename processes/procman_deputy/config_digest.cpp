// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_deputy/config_digest.hpp"

#include <system_error>

#include "common/graph/graph_config.hpp"
#include "common/process/log.hpp"

namespace clearway {

const std::string& ConfigDigest::Get() {
  if (file_.empty()) return digest_;
  std::error_code error;
  const auto time = std::filesystem::last_write_time(file_, error);
  if (!error && !digest_.empty() && time == read_time_) return digest_;
  const std::string before = digest_;
  read_time_ = time;
  try {
    digest_ = config::Digest(config::Load<graph::GraphConfig>(file_, {}).root);
  } catch (const std::exception& problem) {
    digest_ = "unreadable";
    if (before != digest_) process::LogError(problem.what());
  }
  return digest_;
}

}  // namespace clearway
