// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config.hpp"
#include "tests/unit/config/parse_problems.hpp"

namespace clearway::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

struct BadDocument {
  std::string xml;
  std::string problem;
};

class BadDocumentTest : public testing::TestWithParam<BadDocument> {};

TEST_P(BadDocumentTest, HasItsExactMessage) {
  EXPECT_THAT(ProblemsOf(GetParam().xml), ElementsAre(GetParam().problem));
}

INSTANTIATE_TEST_SUITE_P(
    EachKind,
    BadDocumentTest,
    testing::Values(
        BadDocument{"", R"(site.xml: the file is empty: expected <clearway version="1">)"},
        BadDocument{" \n ", R"(site.xml: the file is empty: expected <clearway version="1">)"},
        BadDocument{"<!-- only this -->",
                    R"(site.xml: there is no element: expected <clearway version="1">)"},
        BadDocument{
            "<clearwy version=\"1\"/>",
            R"(site.xml:1: the root element is <clearwy>: expected <clearway version="1">)"},
        BadDocument{"\n<clearway/>",
                    "site.xml:2: <clearway> needs the attribute version: expected version=\"1\""},
        BadDocument{"<clearway version=\"1.0\"/>",
                    R"(site.xml:1: <clearway> version="1.0": expected "1")"},
        BadDocument{"<clearway version=\"1\">\n<sensor>\n</clearway>",
                    "site.xml:2: malformed XML: an opening and a closing tag do not match"},
        BadDocument{"<clearway version=\"1\">\n<sensor x_m=\"1\" x_m=\"2\"/></clearway>",
                    "site.xml:2: malformed XML: an attribute is incomplete, not in quotes or given"
                    " twice"},
        BadDocument{"<clearway version=\"1\"/><clearway version=\"1\"/>",
                    "site.xml:1: <clearway> beside the root element: expected one element only"},
        BadDocument{"<clearway version=\"1\"/>\nmore",
                    "site.xml:2: malformed XML: text outside of all elements or without an end"},
        BadDocument{
            "more\n<clearway version=\"1\"/>",
            "site.xml:1: text \"more\\x0a\" beside the root element: expected one element only"},
        BadDocument{"<!DOCTYPE a><clearway version=\"1\"/>",
                    "site.xml:1: <!DOCTYPE a> beside the root element: expected one element only"},
        BadDocument{std::string("<clearway version=\"1\"/>\0<x/>", 27),
                    "site.xml: the file holds a zero byte: expected UTF-8 text"},
        BadDocument{InRoot("<![CDATA[x]]>"),
                    "site.xml:1: <clearway> contains \"x\": expected only elements and comments;"
                    " values are attributes"}));

TEST(DocumentTest, MayHoldCommentsDeclarationAndByteOrderMark) {
  EXPECT_THAT(ProblemsOf("\xef\xbb\xbf<?xml version=\"1.0\"?>\n<!-- a -->\n"
                         "<clearway version=\"1\">\n <!-- b -->\n</clearway>\n<!-- c -->\n"),
              IsEmpty());
}

TEST(DocumentTest, NestedDeeplyIsRefusedNotFollowed) {
  std::string xml;
  for (int i = 0; i < 100'000; ++i) xml += "<a>";

  EXPECT_THAT(ProblemsOf(xml), ElementsAre(HasSubstr("elements are nested too deeply")));
}

TEST(DocumentTest, WithTooManyListItemsIsRefused) {
  std::string items;
  for (int i = 0; i < 5000; ++i) items += "<sensor/>";

  EXPECT_THAT(ProblemsOf(InRoot(items)),
              ElementsAre("site.xml:1: <clearway> has too many <sensor> elements: expected at most"
                          " 4096 in all lists of a file"));
}

TEST(ListTest, InTheFileReplacesTheDefaultAndEachItemStartsFromItsDefault) {
  const auto result = Parse<sample::Root>(
      InRoot(R"(<sensor name="a" x_m="1"/><preprocessor/><sensor name="b"/>)"), "site.xml");

  EXPECT_THAT(result.root.sensors,
              ElementsAre(sample::Sensor{.name = "a", .x_m = 1.0, .yaw_rad = 0.0},
                          sample::Sensor{.name = "b", .x_m = 0.0, .yaw_rad = 0.0}));
}

TEST(ListTest, AbsentFromTheFileKeepsTheDefault) {
  EXPECT_EQ(Parse<sample::Root>(InRoot(""), "site.xml").root, sample::Root{});
}

class FileTest : public testing::Test {
 protected:
  FileTest() {
    const auto* const info = testing::UnitTest::GetInstance()->current_test_info();
    file_ = std::filesystem::path(testing::TempDir()) /
            (std::string("clearway_config_") + info->name() + ".xml");
  }
  ~FileTest() override { std::filesystem::remove(file_); }

  void Write(const std::string& text) const { std::ofstream(file_, std::ios::binary) << text; }

  [[nodiscard]] std::string Error(const std::filesystem::path& file) const {
    try {
      (void)Load<sample::Root>(file);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path file_;
};

TEST_F(FileTest, IsReadWithOverridesAndOrigins) {
  Write("<clearway version=\"1\"\n speed_mps=\"2\"><sensor x_m=\"1\"/></clearway>");

  const auto result = Load<sample::Root>(file_, std::vector<std::string>{"sensor[0].x_m=3"});

  EXPECT_EQ(result.root.speed_mps, 2.0);
  EXPECT_EQ(result.root.sensors.at(0).x_m, 3.0);
  EXPECT_THAT(result.origins,
              ElementsAre(std::pair("sensor[0].x_m", "--set"),
                          std::pair("speed_mps", file_.string() + ":2")));
}

TEST_F(FileTest, ThatIsMissingIsToldWithTheSystemsReason) {
  EXPECT_EQ(Error("/nowhere/site.xml"),
            "/nowhere/site.xml: cannot read the file: No such file or directory");
}

TEST_F(FileTest, ThatIsAFolderIsToldWithTheSystemsReason) {
  EXPECT_EQ(Error("/"), "/: cannot read the file: Is a directory");
}

TEST_F(FileTest, OfOneMebibyteIsReadAndALargerOneRefused) {
  std::string text = InRoot("");
  text.resize(internal::kLargestFileBytes, ' ');

  Write(text);
  EXPECT_EQ(Error(file_), "");

  Write(text + " ");
  EXPECT_EQ(Error(file_), file_.string() + ": cannot read the file: it is larger than 1 MiB");
}

struct TwiceTheSameName {
  double a_m = 0.0;
  int b = 0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("a_m", self.a_m, 0.0, 1.0, "");
    visitor.Integer("a_m", self.b, 0, 1, "");
  }
};

struct ReservedName {
  int version = 1;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Integer("version", self.version, 0, 1, "");
  }
};

struct BoundsInTheWrongOrder {
  double a_m = 0.0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("a_m", self.a_m, 1.0, 0.0, "");
  }
};

TEST(BinderTest, ThrowsOnMistakesInTheStruct) {
  EXPECT_THROW((void)Digest(TwiceTheSameName{}), std::logic_error);
  EXPECT_THROW((void)Digest(ReservedName{}), std::logic_error);
  EXPECT_THROW((void)Digest(BoundsInTheWrongOrder{}), std::logic_error);
}

}  // namespace
}  // namespace clearway::config
