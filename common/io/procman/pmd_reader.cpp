// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/procman/pmd_reader.hpp"

#include <utility>

#include "common/io/file_bytes.hpp"
#include "common/io/procman/pmd_checks.hpp"
#include "common/io/procman/pmd_parser.hpp"
#include "common/io/procman/pmd_problems.hpp"

namespace clearway::io {

core::procman::Deployment ParsePmd(std::string_view bytes, const std::string& file) {
  if (bytes.size() > kMaxPmdBytes) {
    throw ErrorInFile(file,
                      "has " + std::to_string(bytes.size()) +
                          " bytes: expected a deployment, at most " + std::to_string(kMaxPmdBytes));
  }
  internal::PmdProblems problems(file);
  internal::PmdContent content = internal::ParsePmdContent(bytes, problems);
  // A command that could not be read would be missed by every script that names it.
  if (!problems.has_syntax_problem()) internal::CheckPmdContent(content, problems);
  problems.ThrowIfAny();
  content.deployment.file = file;
  return std::move(content.deployment);
}

core::procman::Deployment ReadPmd(const std::filesystem::path& path) {
  return ParsePmd(ReadFileBytes(path), path.string());
}

}  // namespace clearway::io
