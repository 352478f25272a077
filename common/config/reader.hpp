// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "common/config/schema.hpp"

namespace clearway::config::internal {

/// Larger files are refused unread.
inline constexpr std::size_t kLargestFileBytes = std::size_t{1} << 20U;

/// Elements of lists in one file, all lists together.
inline constexpr std::size_t kMostListItems = 4096;

/// An XML text and the name that its problems are told with.
struct Source {
  std::string file;
  std::string text;
};

/// Path of a value -> "config/site.xml:41" or "--set". Values that are not in it are defaults.
using Origins = std::map<std::string, std::string>;

/// Throws ConfigError when the file cannot be read or is larger than kLargestFileBytes.
[[nodiscard]] Source ReadSource(const std::filesystem::path& file);

/// Fills the struct behind `root` from the XML text, then from the overrides, and checks all of it.
/// Throws ConfigError with every problem found.
[[nodiscard]] Origins Fill(Element& root,
                           const Source& source,
                           std::span<const std::string> overrides);

}  // namespace clearway::config::internal
