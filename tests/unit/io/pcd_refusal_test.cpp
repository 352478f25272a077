// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/pcd_reader.hpp"
#include "tests/unit/io/pcd_maker.hpp"

namespace clearway::io {
namespace {

using test::PcdRecipe;
using testing::HasSubstr;
using testing::ThrowsMessage;

struct Refusal {
  std::string name;
  PcdRecipe recipe;
  std::string message;  ///< The whole line.
};

void PrintTo(const Refusal& refusal, std::ostream* out) {
  *out << refusal.name;
}

std::string Floats(std::size_t count) {
  std::string bytes;
  for (std::size_t i = 0; i < count; ++i) bytes += test::Encode(1.5, 'F', 4);
  return bytes;
}

std::string Bytes(std::size_t count) {
  return std::string(count, '\x01');
}

class PcdRefusalTest : public testing::TestWithParam<Refusal> {};

TEST_P(PcdRefusalTest, SaysWhatIsWrongAndWhere) {
  const auto parse = [&] { (void)ParsePcd(test::Render(GetParam().recipe), "scan.pcd"); };

  EXPECT_THAT(parse, ThrowsMessage<ReadError>(GetParam().message));
}

const std::string kRange = ": expected one whole number in [0, 100000000]";

INSTANTIATE_TEST_SUITE_P(
    Header,
    PcdRefusalTest,
    testing::Values(
        Refusal{"Version",
                {.version = "VERSION 8"},
                R"(scan.pcd:2: VERSION "8": expected .5, .6 or .7)"},
        Refusal{"UnknownEntry",
                {.width = "WITDH 2"},
                "scan.pcd:7: unknown header entry \"WITDH\"; a PCD header has # VERSION FIELDS "
                "SIZE TYPE COUNT WIDTH HEIGHT VIEWPOINT POINTS DATA"},
        Refusal{"EntryTwice",
                {.points = "WIDTH 2"},
                "scan.pcd:10: WIDTH is there twice, first in line 7"},
        Refusal{"FieldsMissing",
                {.fields = ""},
                "scan.pcd:10: FIELDS is missing; expected at least x y z"},
        Refusal{"FieldsEmpty",
                {.fields = "FIELDS"},
                "scan.pcd:3: FIELDS is empty; expected at least x y z"},
        Refusal{"NoXyz",
                {.fields = "FIELDS x z descriptor"},
                "scan.pcd: has no field \"y\"; expected x y z, FIELDS are: x z descriptor"},
        Refusal{"XTwice",
                {.fields = "FIELDS x y z x",
                 .size = "SIZE 4 4 4 4",
                 .type = "TYPE F F F F",
                 .count = "COUNT 1 1 1 1"},
                "scan.pcd: field \"x\" is there twice; FIELDS are: x y z x"},
        Refusal{"XOfTwoValues",
                {.count = "COUNT 2 1 1"},
                "scan.pcd: field \"x\" has COUNT 2; expected 1"},
        Refusal{"HalfFloat",
                {.size = "SIZE 4 4 2"},
                "scan.pcd: field \"z\" is a float of SIZE 2; expected 4 or 8"},
        Refusal{"SizeThree",
                {.size = "SIZE 4 3 4"},
                R"(scan.pcd:4: SIZE "3" of field "y": expected 1, 2, 4 or 8)"},
        Refusal{"SizeNegative",
                {.size = "SIZE 4 4 -4"},
                R"(scan.pcd:4: SIZE "-4" of field "z": expected 1, 2, 4 or 8)"},
        Refusal{"SizeNoNumber",
                {.size = "SIZE four 4 4"},
                R"(scan.pcd:4: SIZE "four" of field "x": expected 1, 2, 4 or 8)"},
        Refusal{"SizesTooFew", {.size = "SIZE 4 4"}, "scan.pcd:4: SIZE has 2 values, FIELDS has 3"},
        Refusal{"SizeMissing",
                {.size = "", .data = "DATA binary"},
                "scan.pcd:10: SIZE is missing in the header"},
        Refusal{"TypeLetter",
                {.type = "TYPE F D F"},
                R"(scan.pcd:5: TYPE "D" of field "y": expected I, U or F)"},
        Refusal{"TypesTooMany",
                {.type = "TYPE F F F F"},
                "scan.pcd:5: TYPE has 4 values, FIELDS has 3"},
        Refusal{"CountZero",
                {.count = "COUNT 1 0 1"},
                R"(scan.pcd:6: COUNT "0" of field "y": expected a whole number in [1, 1000000])"},
        Refusal{"CountNegative",
                {.count = "COUNT 1 -1 1"},
                R"(scan.pcd:6: COUNT "-1" of field "y": expected a whole number in [1, 1000000])"},
        Refusal{"CountHuge",
                {.count = "COUNT 1 1 18446744073709551615"},
                "scan.pcd:6: COUNT \"18446744073709551615\" of field \"z\": expected a whole "
                "number in [1, 1000000]"},
        Refusal{"WidthNegative", {.width = "WIDTH -2"}, R"(scan.pcd:7: WIDTH "-2")" + kRange},
        Refusal{"HeightFraction", {.height = "HEIGHT 1.0"}, R"(scan.pcd:8: HEIGHT "1.0")" + kRange},
        Refusal{"PointsEmpty", {.points = "POINTS"}, R"(scan.pcd:10: POINTS "")" + kRange},
        Refusal{"PointsTwoValues",
                {.points = "POINTS 2 2"},
                R"(scan.pcd:10: POINTS "2" and more)" + kRange},
        Refusal{"PointsHuge",
                {.points = "POINTS 99999999999999999999"},
                R"(scan.pcd:10: POINTS "99999999999999999999")" + kRange},
        Refusal{"PointsBinaryRubbish",
                {.points = "POINTS \x01\xff"},
                R"(scan.pcd:10: POINTS "\x01\xff")" + kRange},
        Refusal{"NoCountAtAll",
                {.width = "", .points = ""},
                "scan.pcd:9: the header has neither POINTS nor both WIDTH and HEIGHT"},
        Refusal{"GridTooLarge",
                {.width = "WIDTH 100000", .height = "HEIGHT 100000", .points = ""},
                "scan.pcd:7: WIDTH * HEIGHT is 10000000000; expected at most 100000000 points"},
        Refusal{"ViewpointShort",
                {.viewpoint = "VIEWPOINT 0 0 0 1 0 0"},
                "scan.pcd:9: VIEWPOINT has 6 values; expected 7 (tx ty tz qw qx qy qz)"},
        Refusal{"ViewpointNotFinite",
                {.viewpoint = "VIEWPOINT 0 0 nan 1 0 0 0"},
                R"(scan.pcd:9: VIEWPOINT "nan": expected a finite number)"},
        Refusal{"DataUnknown",
                {.data = "DATA asciiart"},
                "scan.pcd:11: DATA \"asciiart\": expected ascii, binary or binary_compressed"},
        Refusal{"DataMissing",
                {.data = "", .body = ""},
                "scan.pcd:10: the file ends after 152 bytes, before the DATA line of its header"}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Body,
    PcdRefusalTest,
    testing::Values(
        Refusal{"AsciiNoNumber",
                {.body = "1 2 3\n4 5,5 6\n"},
                R"(scan.pcd:13: y of point 1 is "5,5": expected a number)"},
        Refusal{"AsciiRowShort",
                {.body = "1 2 3\n4 5\n"},
                "scan.pcd:13: the row of point 1 has 2 values; expected 3"},
        Refusal{"AsciiRowLong",
                {.body = "1 2 3 4\n4 5 6\n"},
                "scan.pcd:12: the row of point 0 has 4 values; expected 3"},
        Refusal{"AsciiTooFew",
                {.body = "1 2 3\n"},
                "scan.pcd:12: the file ends after 1 of 2 points: it is cut short"},
        Refusal{"AsciiHugeCount",
                {.points = "POINTS 100000000"},
                "scan.pcd:13: the file ends after 2 of 100000000 points: it is cut short"},
        Refusal{"AsciiTooMany",
                {.body = "1 2 3\n4 5 6\n7 8 9\n"},
                "scan.pcd:14: a row too many; POINTS is 2"},
        Refusal{"BinaryShort",
                {.data = "DATA binary", .body = Floats(5)},
                "scan.pcd: byte 164: 20 bytes of data follow; expected 2 points of 12 bytes: the "
                "file is cut short"},
        Refusal{"BinaryHugeCount",
                {.points = "POINTS 100000000", .data = "DATA binary", .body = Floats(6)},
                "scan.pcd: byte 172: 24 bytes of data follow; expected 100000000 points of 12 "
                "bytes: the file is cut short"},
        Refusal{"BinaryGoesOn",
                {.data = "DATA binary", .body = Floats(6) + std::string(3, '\0') + "x"},
                "scan.pcd: byte 191: data go on after the 2 points of 12 bytes that the header "
                "announces; expected the end of the file, or zero bytes"},
        Refusal{
            "BinaryAmbiguous",
            {.width = "WIDTH 3", .data = "DATA binary", .body = Floats(6) + std::string(12, '\0')},
            "scan.pcd: byte 164: WIDTH * HEIGHT is 3, POINTS 2, and there are data for either: "
            "which is meant cannot be told"},
        Refusal{"CompressedNoSizes",
                {.data = "DATA binary_compressed", .body = Bytes(7)},
                "scan.pcd: byte 175: the file ends 7 bytes after its header; expected the two "
                "4-byte sizes of the compressed data: it is cut short"},
        Refusal{"CompressedShort",
                {.data = "DATA binary_compressed",
                 .body = test::CompressedBody(Bytes(9), 24).substr(0, 16)},
                "scan.pcd: byte 175: compressed size is 9 bytes, but only 8 follow: it is cut "
                "short"},
        Refusal{"CompressedWrongSize",
                {.data = "DATA binary_compressed", .body = test::CompressedBody(Bytes(9), 25)},
                "scan.pcd: byte 179: uncompressed size is 25 bytes; expected that of 2 points of "
                "12 bytes"},
        Refusal{"CompressedImpossible",
                {.width = "WIDTH 8000000",
                 .points = "POINTS 8000000",
                 .data = "DATA binary_compressed",
                 .body = test::CompressedBody(Bytes(9), 96000000)},
                "scan.pcd: byte 187: compressed size is 9 bytes; they cannot unpack to 96000000"},
        Refusal{"CompressedRubbish",
                {.data = "DATA binary_compressed", .body = test::CompressedBody("\x20\x20", 24)},
                "scan.pcd: byte 183: a back reference points 33 bytes back, only 0 are unpacked"},
        Refusal{"CompressedGoesOn",
                {.data = "DATA binary_compressed",
                 .body = test::CompressedBody(test::StoreLzf(Floats(6)), 24) + "x"},
                "scan.pcd: byte 208: data go on after the 2 points of 12 bytes that the header "
                "announces; expected the end of the file, or zero bytes"}),
    [](const auto& test) { return test.param.name; });

TEST(PcdRefusal, NamesTheFileThatIsNotThere) {
  const auto read = [] { (void)ReadPcd("/no/such/scan.pcd"); };

  EXPECT_THAT(read, ThrowsMessage<ReadError>("/no/such/scan.pcd: no such file"));
}

TEST(PcdRefusal, RefusesAFolderAndADevice) {
  EXPECT_THAT([] { (void)ReadPcd("/tmp"); }, ThrowsMessage<ReadError>("/tmp: is not a file"));
  EXPECT_THAT([] { (void)ReadPcd("/dev/zero"); },
              ThrowsMessage<ReadError>("/dev/zero: is not a file"));
}

TEST(PcdRefusal, RefusesAnEmptyFile) {
  const auto path = std::filesystem::path(testing::TempDir()) / "clearway_nothing.pcd";
  std::ofstream(path).close();

  EXPECT_THAT([&] { (void)ReadPcd(path); },
              ThrowsMessage<ReadError>(HasSubstr("clearway_nothing.pcd: is empty (0 bytes)")));
  std::filesystem::remove(path);
}

TEST(PcdRefusal, RefusesWhatIsNoPcdAtAll) {
  const std::string picture("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);

  EXPECT_THAT([&] { (void)ParsePcd(picture, "scan.pcd"); },
              ThrowsMessage<ReadError>(HasSubstr(R"(scan.pcd:1: unknown header entry "\x89PNG")")));
}

}  // namespace
}  // namespace clearway::io
