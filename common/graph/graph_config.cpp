// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/graph_config.hpp"

namespace clearway::config {

template LoadResult<graph::GraphConfig> Parse(const std::string& text,
                                              const std::string& file,
                                              std::span<const std::string> overrides);
template LoadResult<graph::GraphConfig> Load(const std::filesystem::path& file,
                                             std::span<const std::string> overrides);
template std::string Print(const LoadResult<graph::GraphConfig>& result);
template std::string ToXml(const graph::GraphConfig& root, const XmlOptions& options);
template std::string Digest(const graph::GraphConfig& root);
template std::string Reference(const graph::GraphConfig& root);

}  // namespace clearway::config
