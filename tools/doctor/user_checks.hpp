// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

#include "tools/doctor/finding.hpp"

/// Whether the deputy's user can read what it needs.
namespace clearway::doctor {

struct User {
  std::string name;
  uid_t uid = 0;
  std::vector<gid_t> groups;
};

/// A user by name, with all groups; nothing when there is none of this name.
[[nodiscard]] std::optional<User> ReadUser(const std::string& name);

/// A folder or file, as stat() tells.
struct PathPart {
  std::filesystem::path path;
  mode_t mode = 0;
  uid_t uid = 0;
  gid_t gid = 0;
};

/// A file with the folders above it, the root first.
struct FileFacts {
  std::filesystem::path file;
  std::vector<PathPart> parts;  ///< Ends at the first part that is not there.
  bool is_there = false;
};

[[nodiscard]] FileFacts ReadFileFacts(const std::filesystem::path& file);

struct UserFacts {
  bool is_root = false;      ///< This program runs as root.
  std::string deputy_user;   ///< Name of the user that the deputy runs as.
  std::optional<User> user;  ///< Nothing: there is none of this name.
  std::vector<FileFacts> files;
};

/// By owner, group and mode; access lists are not looked at.
[[nodiscard]] Findings CheckUser(const UserFacts& facts);

}  // namespace clearway::doctor
