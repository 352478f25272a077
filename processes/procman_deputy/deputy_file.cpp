// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_deputy/deputy_file.hpp"

namespace clearway::config {

template LoadResult<DeputyFile> Parse(const std::string& text,
                                      const std::string& file,
                                      std::span<const std::string> overrides);
template LoadResult<DeputyFile> Load(const std::filesystem::path& file,
                                     std::span<const std::string> overrides);
template std::string Print(const LoadResult<DeputyFile>& result);

}  // namespace clearway::config
