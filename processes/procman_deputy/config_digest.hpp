// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace clearway {

/// Digest of the graph's configuration on this host, read anew when the file has changed.
class ConfigDigest {
 public:
  /// Empty path: there is none, and Get() is always empty.
  explicit ConfigDigest(std::filesystem::path file) : file_(std::move(file)) {}

  /// As in the status of the graph's processes; "unreadable" when the file cannot be read or is
  /// wrong.
  [[nodiscard]] const std::string& Get();

 private:
  std::filesystem::path file_;
  std::filesystem::file_time_type read_time_;
  std::string digest_;
};

}  // namespace clearway
