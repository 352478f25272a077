// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/map/map_file.hpp"

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_folder.hpp"
#include "tests/unit/io/map/refusal.hpp"

namespace clearway::io {
namespace {

using test::RefusalOf;
using test::TestFolder;
using testing::ElementsAre;

std::string YamlFor(const std::string& image) {
  return "resolution: 0.1\nimage: " + image +
         "\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\nmode: raw\n";
}

class Home {
 public:
  explicit Home(const char* folder) {
    if (const char* old = std::getenv("HOME")) old_ = old;
    Set(folder);
  }
  ~Home() { Set(old_ ? old_->c_str() : nullptr); }
  Home(const Home&) = delete;
  Home& operator=(const Home&) = delete;

 private:
  static void Set(const char* folder) {
    if (folder == nullptr) {
      unsetenv("HOME");
    } else {
      setenv("HOME", folder, 1);
    }
  }
  std::optional<std::string> old_;
};

class MapFile : public testing::Test {
 protected:
  MapFile() {
    std::filesystem::create_directory(folder_.path() / "images");
    image_ = folder_.Write("images/a.pgm", "P2 2 1 255 7 8");
  }

  [[nodiscard]] std::string Refusal(const std::string& image) const {
    const std::filesystem::path yaml = folder_.Write("m.yaml", YamlFor(image));
    return RefusalOf([&] { return LoadMap(yaml); });
  }

  TestFolder folder_;
  std::filesystem::path image_;
};

TEST_F(MapFile, FindsTheImageBesideTheYamlFileFromAnywhere) {
  const std::filesystem::path yaml = folder_.Write("m.yaml", YamlFor("images/a.pgm"));

  const LoadedMap map = LoadMap(yaml);

  EXPECT_EQ(map.image_path, image_);
  EXPECT_EQ(map.description.image, "images/a.pgm");
  EXPECT_THAT(map.grid.cells, ElementsAre(7, 8));
}

TEST_F(MapFile, FindsAnImageByItsAbsolutePath) {
  const std::filesystem::path yaml = folder_.Write("m.yaml", YamlFor(image_.string()));

  EXPECT_EQ(LoadMap(yaml).image_path, image_);
}

TEST_F(MapFile, FindsAnImageBelowTheHomeFolder) {
  const Home home(folder_.path().c_str());
  const std::filesystem::path yaml = folder_.Write("m.yaml", YamlFor("~/images/a.pgm"));

  EXPECT_EQ(LoadMap(yaml).image_path, image_);
}

TEST_F(MapFile, SaysWhenThereIsNoHomeFolder) {
  const Home home(nullptr);

  EXPECT_EQ(Refusal("~/images/a.pgm"),
            (folder_.path() / "m.yaml").string() +
                ":2: image \"~/images/a.pgm\": $HOME is not set: expected a path that does not "
                "need it");
}

TEST_F(MapFile, NamesYamlFileLineAndImageWhenTheImageIsNoGood) {
  const std::string yaml = (folder_.path() / "m.yaml").string();
  EXPECT_EQ(
      Refusal("b.pgm"),
      yaml + ":2: image \"b.pgm\": " + (folder_.path() / "b.pgm").string() + ": no such file");
  EXPECT_EQ(
      Refusal("images"),
      yaml + ":2: image \"images\": " + (folder_.path() / "images").string() + ": is not a file");
  EXPECT_EQ(Refusal("m.yaml"),
            yaml + ":2: image \"m.yaml\": " + yaml +
                ": starts with \"resoluti\", which is no image known here; allowed are PGM (P2, "
                "P5) and PNG");
}

TEST_F(MapFile, SaysWhenThereIsNoYamlFile) {
  const std::filesystem::path yaml = folder_.path() / "none.yaml";

  EXPECT_EQ(RefusalOf([&] { return LoadMap(yaml); }), yaml.string() + ": no such file");
}

TEST_F(MapFile, RefusesAnImageGivenAsTheYamlFile) {
  const std::filesystem::path yaml = folder_.Write("big.pgm", std::string(70'000, '0'));

  EXPECT_EQ(RefusalOf([&] { return LoadMap(yaml); }),
            yaml.string() + ": has 70000 bytes: expected the YAML file of a map, at most 65536");
}

}  // namespace
}  // namespace clearway::io
