// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/program_path.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace clearway::host {
namespace {

bool IsProgram(const std::filesystem::path& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
         faccessat(AT_FDCWD, path.c_str(), X_OK, AT_EACCESS) == 0;
}

}  // namespace

std::optional<std::filesystem::path> FindProgram(const std::string& name,
                                                 const std::string& path_variable) {
  // A NUL would cut the name short on its way to the system.
  if (name.empty() || name.find('\0') != std::string::npos) return std::nullopt;
  if (name.find('/') != std::string::npos) {
    return IsProgram(name) ? std::optional<std::filesystem::path>(name) : std::nullopt;
  }
  for (std::size_t begin = 0; begin <= path_variable.size();) {
    const std::size_t end = std::min(path_variable.find(':', begin), path_variable.size());
    const std::string folder = path_variable.substr(begin, end - begin);
    const std::filesystem::path path = std::filesystem::path(folder.empty() ? "." : folder) / name;
    if (IsProgram(path)) return path;
    begin = end + 1;
  }
  return std::nullopt;
}

}  // namespace clearway::host
