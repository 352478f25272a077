// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/output_files.hpp"

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

}  // namespace clearway::graph
