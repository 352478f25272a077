// SPDX-License-Identifier: BSD-3-Clause
// The files in config/: they load, and those that are generated are up to date.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/graph/graph_config.hpp"
#include "tests/support/test_data.hpp"
#include "tools/config_tool/generated_files.hpp"

namespace clearway::graph {
namespace {

std::filesystem::path ConfigFolder() {
  return test::SourceFolder() / "config";
}

std::string Content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file.good()) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::filesystem::path> ShippedGraphs() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(ConfigFolder())) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".xml") && !name.ends_with("_scene.xml")) files.push_back(entry.path());
  }
  return files;
}

// Where two texts differ first, for a message that can be read.
std::string FirstDifference(const std::string& file, const std::string& generated) {
  std::size_t line = 1;
  std::size_t i = 0;
  while (i < file.size() && i < generated.size() && file[i] == generated[i]) {
    line += file[i++] == '\n' ? 1 : 0;
  }
  return "line " + std::to_string(line) + ": file has '" + file.substr(i, 60) +
         "', generated is '" + generated.substr(i, 60) + "'";
}

TEST(ShippedConfigTest, EveryFileLoads) {
  const auto files = ShippedGraphs();

  EXPECT_GE(files.size(), 6U);
  for (const std::filesystem::path& file : files) {
    EXPECT_NO_THROW((void)config::Load<GraphConfig>(file)) << file;
  }
}

TEST(ShippedConfigTest, TheDefaultFileIsWhatClearwayConfigPrints) {
  const std::string file = Content(ConfigFolder() / "default.xml");
  const std::string generated = config_tool::DefaultXml();

  EXPECT_TRUE(file == generated) << "run `clearway-config default > config/default.xml`; "
                                 << FirstDifference(file, generated);
}

TEST(ShippedConfigTest, TheReferenceIsWhatClearwayConfigPrints) {
  const std::string file = Content(ConfigFolder() / "reference.md");
  const std::string generated = config_tool::ReferenceMarkdown();

  EXPECT_TRUE(file == generated) << "run `clearway-config reference > config/reference.md`; "
                                 << FirstDifference(file, generated);
}

TEST(ShippedConfigTest, TheDefaultFileHasTheDefaultsOfTheCode) {
  const auto loaded = config::Load<GraphConfig>(ConfigFolder() / "default.xml");

  EXPECT_EQ(config::Digest(loaded.root), config::Digest(GraphConfig{}));
}

}  // namespace
}  // namespace clearway::graph
