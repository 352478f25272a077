// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace clearway::test {

/// The folder of the sources that this test was built from.
inline std::filesystem::path SourceFolder() {
  const char* source = std::getenv("CLEARWAY_SOURCE");
  return source != nullptr ? std::filesystem::path(source) : std::filesystem::current_path();
}

/// A file or folder of the real recordings: below $CLEARWAY_TEST_DATA, else below ../shared/data
/// beside the checkout. Nothing when it is not there: the test then skips itself and says so.
inline std::optional<std::filesystem::path> TestData(const std::string& relative) {
  const char* configured = std::getenv("CLEARWAY_TEST_DATA");
  const std::filesystem::path root = configured != nullptr
                                         ? std::filesystem::path(configured)
                                         : SourceFolder().parent_path() / "shared" / "data";
  const std::filesystem::path path = root / relative;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path;
}

/// Why a test that needs a recording does not run.
inline std::string MissingData(const std::string& relative) {
  return "recording '" + relative +
         "' is not here (looked below $CLEARWAY_TEST_DATA, else ../shared/data beside the sources)";
}

}  // namespace clearway::test
