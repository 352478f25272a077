// SPDX-License-Identifier: BSD-3-Clause
// Input: an XML text, then any number of overrides, each behind a byte 0x01.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "common/config/config.hpp"
#include "tests/unit/config/sample_config.hpp"

namespace {

using clearway::config::ConfigError;
using clearway::config::sample::Root;

void Require(bool holds) {
  if (!holds) std::abort();
}

/// What loads can be written, loads again to the same values, and keeps its digest.
void CheckRoundTrip(const clearway::config::LoadResult<Root>& result) {
  const std::string xml = clearway::config::ToXml(result.root, {.with_help = true});
  const auto again = clearway::config::Parse<Root>(xml, "again.xml");
  Require(again.root == result.root);
  Require(clearway::config::Digest(again.root) == clearway::config::Digest(result.root));
  Require(!clearway::config::Print(result).empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::string> parts(1);
  for (std::size_t i = 0; i < size; ++i) {
    if (data[i] == 1) {
      parts.emplace_back();
    } else {
      parts.back() += static_cast<char>(data[i]);
    }
  }
  const std::string xml = parts.front();
  parts.erase(parts.begin());
  try {
    CheckRoundTrip(clearway::config::Parse<Root>(xml, "fuzz.xml", parts));
  } catch (const ConfigError& error) {
    Require(!error.problems().empty());
    for (const std::string& problem : error.problems())
      Require(problem.find('\n') == std::string::npos);
  }
  return 0;
}
