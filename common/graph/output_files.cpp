// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/output_files.hpp"

#include <cerrno>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace clearway::graph {

void RefuseToOverwrite(const std::vector<std::filesystem::path>& written,
                       const std::vector<std::filesystem::path>& read) {
  for (const std::filesystem::path& output : written) {
    for (const std::filesystem::path& input : read) {
      std::error_code ignored;
      if (std::filesystem::equivalent(output, input, ignored)) {
        throw std::runtime_error(output.string() + ": is read by this command; give another file");
      }
    }
  }
}

void WriteFile(const std::filesystem::path& path, const std::string& text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) {
    throw std::runtime_error(path.string() +
                             ": cannot write: " + std::generic_category().message(errno));
  }
}

}  // namespace clearway::graph
