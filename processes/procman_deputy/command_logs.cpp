// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_deputy/command_logs.hpp"

#include <stdexcept>

#include "common/host/log_file_name.hpp"
#include "common/host/spare_descriptors.hpp"

namespace clearway {

host::RotatingLog* CommandLogs::LogOf(const std::string& command_id) {
  const auto found = logs_.find(command_id);
  if (found != logs_.end()) return &found->second;
  if (!host::HasDescriptorsToSpare()) {
    open_problem_ = "no log of " + command_id + ": too few file descriptors are left (ulimit -n)";
    return nullptr;
  }
  try {
    const std::filesystem::path path =
        std::filesystem::path(config_.folder) / host::FileNameOf(command_id);
    const auto added =
        logs_.try_emplace(command_id, path, std::int64_t{config_.max_kb} * 1000, config_.files);
    open_problem_.clear();
    return &added.first->second;
  } catch (const std::runtime_error& error) {
    open_problem_ = error.what();
    return nullptr;
  }
}

void CommandLogs::Write(const std::string& command_id, std::string_view text, std::int64_t utime) {
  if (host::RotatingLog* const log = LogOf(command_id)) log->Write(text, utime);
}

void CommandLogs::WriteNote(const std::string& command_id,
                            std::string_view text,
                            std::int64_t utime) {
  if (host::RotatingLog* const log = LogOf(command_id)) log->WriteNote(text, utime);
}

std::string CommandLogs::Problem() const {
  if (!open_problem_.empty()) return open_problem_;
  for (const auto& [id, log] : logs_) {
    std::string problem = log.problem();
    if (!problem.empty()) return problem;
  }
  return {};
}

}  // namespace clearway
