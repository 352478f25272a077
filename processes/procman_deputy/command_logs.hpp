// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "common/host/rotating_log.hpp"

namespace clearway {

/// Where the output of commands is kept on disk. XML element: <deputy><logs>.
struct CommandLogsConfig {
  std::string folder;
  int max_kb = 10'000;
  int files = 4;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Text("folder",
                 self.folder,
                 "Folder of the commands' output, a file each. Empty: the one that the service "
                 "manager gives (LOGS_DIRECTORY), else ~/.local/state/clearway/logs.");
    visitor.Integer("max_kb", self.max_kb, 10, 10000000, "A file of this size is rotated [kB].");
    visitor.Integer(
        "files", self.files, 1, 100, "Files of one command: NAME.log, NAME.log.1 and so on.");
  }
};

/// A rotating log for each command. Trouble with the disk never stops a command: it is told.
class CommandLogs {
 public:
  explicit CommandLogs(const CommandLogsConfig& config) : config_(config) {}

  void Write(const std::string& command_id, std::string_view text, std::int64_t utime);
  void WriteNote(const std::string& command_id, std::string_view text, std::int64_t utime);

  /// Closes the log of a command that is no more.
  void Close(const std::string& command_id) { logs_.erase(command_id); }

  /// What is wrong with any of them, in words; empty: nothing.
  [[nodiscard]] std::string Problem() const;

 private:
  host::RotatingLog* LogOf(const std::string& command_id);

  CommandLogsConfig config_;
  std::map<std::string, host::RotatingLog> logs_;
  std::string open_problem_;
};

}  // namespace clearway
