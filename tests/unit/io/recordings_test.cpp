// SPDX-License-Identifier: BSD-3-Clause
// Every real recording that is at hand, against figures from an independent reader.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/pcd_reader.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/io/pcd_maker.hpp"

namespace clearway::io {
namespace {

/// Figures of a readable file; sums are over the points with finite coordinates. They were computed
/// from the files by another reader, in another language, that knows each file's kind beforehand.
struct Expected {
  const char* file;
  std::size_t points;
  std::size_t finite;
  double sum_x;
  double sum_y;
  double sum_z;
  std::uint64_t sum_intensity;  ///< Rounded and clamped values, with a scale of 1.
};

void PrintTo(const Expected& expected, std::ostream* out) {
  *out << expected.file;
}

// clang-format off
constexpr Expected kReadable[] = {
    {"indoor/pcl_person_organised.pcd", 307200, 242749, -24231.36577, -25962.31106, 587278.7091, 0},
    {"indoor/pcl_sac_plane_test.pcd", 3283, 3283, 3697.339023, -217.9378376, -43.72511591, 0},
    {"indoor/tier4_nebula/40p_1673400149711850138.pcd", 56762, 56762, 11458.69064, 35246.0574, 1820.134878, 0},
    {"indoor/tier4_nebula/at128_1679653308704927652.pcd", 10198, 10198, 45982.62758, -8071.576526, 6264.121147, 0},
    {"indoor/tier4_nebula/vlp16_1673400472138016708.pcd", 14831, 14831, -15976.41381, 5498.528463, 5695.354016, 612296},
    {"indoor/tier4_nebula/xt16_1732848128093928016.pcd", 26287, 26287, -16594.6028, 8236.548839, 3452.976872, 0},
    {"livox/mid100_street.pcd", 240887, 240887, 3332142.076, -76647.92307, 237713.398, 0},
    {"pcd_odd/misc/bonxai_apple_noversion.pcd", 3161, 3161, -30.11674265, 2230.072, -36.98716509, 0},
    {"pcd_odd/misc/nebula_ascii_xyz.pcd", 2, 2, -3, 2.875, 9.75, 0},
    {"pcd_odd/misc/nebula_binary_xyz_pcl.pcd", 2, 2, -8.75, 22.5, 26.25, 0},
    {"pcd_odd/misc/pcl_ism_test_cat_CRLF.pcd", 3400, 3400, 35.90527822, -17308.21658, 98145.86402, 0},
    {"pcd_odd/misc/pcllearning_width_height_mismatch.pcd", 16946, 16946, 363914.8257, 15034.76172, -4887.809168, 795729},
    {"pcd_odd/misc/pjlab_ring_f64timestamp_compressed.pcd", 8572, 8572, 25136.92472, 9700.952639, 11478.76011, 1295330},
    {"pcd_odd/misc/pythonpcl_flydracyl_nonewline_after_DATA_ascii.pcd", 6731, 6731, 2006.465376, 2947.322398, 8392.505821, 0},
    {"pcd_odd/misc/ros_padded_ring_1539765924.pcd", 12067, 12067, 84406.13153, -10614.12978, 15578.99162, 215679},
    {"pcd_odd/misc/ros_padded_ring_1539765929.pcd", 12153, 12153, 75279.20484, -10167.82419, 13960.43693, 208059},
    {"pcd_odd/misc/udacity_simpleHighway_ascii.pcd", 976, 976, -15.18458278, 151.3437532, 110.6607644, 0},
    {"pcd_odd/pcl/brisk_keypoints_gt.pcd", 1860, 1860, 535693.2068, 542857.5116, 0, 0},
    {"pcd_odd/pcl/bun0.pcd", 397, 397, -11.54513501, 40.75310292, 10.83887708, 0},
    {"pcd_odd/pcl/colored_cloud.pcd", 1000, 1000, -218.5127597, -513.7772444, 1210.10301, 0},
    {"pcd_odd/pcl/lamppost.pcd", 1771, 1771, -17894.46875, 131.0625, -3798.350834, 0},
    {"pcd_odd/pcl/milk_color.pcd", 13704, 13704, -770.3041106, -1874.07732, 10610.02935, 0},
    {"pcd_odd/pcl/nhood_test.pcd", 36, 36, -37.64856303, -26.863635, 55.16075873, 0},
    {"pcd_odd/pcl/noisy_slice_displaced.pcd", 3782, 3782, 3780.918205, 2821.702064, 4847.998939, 0},
    {"pcd_odd/pcl/object_template_4.pcd", 1159, 1159, -139.3496521, 116.512674, 840.176581, 0},
    {"pcd_odd/pcl/pcl_logo.pcd", 12909, 12909, 200.1789952, 1943.265804, 0, 0},
    {"pcd_odd/pypcd4/ascii.pcd", 213, 213, 1.929937275, 32.31178915, 0, 0},
    {"pcd_odd/pypcd4/ascii_multi_count.pcd", 8, 8, 4, 4, 4, 4},
    {"pcd_odd/pypcd4/ascii_organized.pcd", 8, 8, 4, 4, 4, 4},
    {"pcd_odd/pypcd4/ascii_with_empty_points.pcd", 0, 0, 0, 0, 0, 0},
    {"pcd_odd/pypcd4/ascii_with_underscore.pcd", 213, 213, 1.929937275, 32.31178915, 0, 0},
    {"pcd_odd/pypcd4/binary.pcd", 213, 213, 1.929937275, 32.31178915, 0, 0},
    {"pcd_odd/pypcd4/binary_compressed.pcd", 213, 213, 1.929937275, 32.31178915, 0, 0},
    {"pcd_odd/pypcd4/binary_compressed_organized.pcd", 8, 8, 4, 4, 4, 4},
};
// clang-format on

struct Refused {
  const char* file;
  const char* reason;
};

void PrintTo(const Refused& refused, std::ostream* out) {
  *out << refused.file;
}

constexpr Refused kRefused[] = {
    {"pcd_odd/pypcd4/ascii_empty.pcd", ": is empty (0 bytes)"},
    {"pcd_odd/pypcd4/ascii_invalid_header.pcd", ":3: unknown header entry \"FIEL\""},
    {"pcd_odd/pcl/brisk_descriptors_gt.pcd",
     ": has no field \"x\"; expected x y z, FIELDS are: brisk_scale brisk_orientation "
     "brisk_descriptor512"},
};

/// The sums are printed with 10 digits.
constexpr double kPrintedPrecision = 1e-9;

class ReadableRecordingTest : public testing::TestWithParam<Expected> {};

TEST_P(ReadableRecordingTest, GivesWhatAnotherReaderGives) {
  const Expected& expected = GetParam();
  const auto path = test::TestData(expected.file);
  if (!path) GTEST_SKIP() << test::MissingData(expected.file);

  const core::PointCloud cloud = ReadPcd(*path).cloud;

  std::size_t finite = 0;
  std::array<double, 3> sum = {0.0, 0.0, 0.0};
  std::uint64_t sum_intensity = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    sum_intensity += cloud.intensity[i];
    if (!core::IsFinite(cloud, i)) continue;
    ++finite;
    sum[0] += static_cast<double>(cloud.x[i]);
    sum[1] += static_cast<double>(cloud.y[i]);
    sum[2] += static_cast<double>(cloud.z[i]);
  }
  EXPECT_EQ(cloud.size(), expected.points);
  EXPECT_EQ(finite, expected.finite);
  EXPECT_EQ(sum_intensity, expected.sum_intensity);
  const auto tolerance = [](double value) { return std::abs(value) * kPrintedPrecision + 1e-6; };
  EXPECT_NEAR(sum[0], expected.sum_x, tolerance(expected.sum_x));
  EXPECT_NEAR(sum[1], expected.sum_y, tolerance(expected.sum_y));
  EXPECT_NEAR(sum[2], expected.sum_z, tolerance(expected.sum_z));
}

INSTANTIATE_TEST_SUITE_P(All, ReadableRecordingTest, testing::ValuesIn(kReadable));

class RefusedRecordingTest : public testing::TestWithParam<Refused> {};

TEST_P(RefusedRecordingTest, IsRefusedWithItsReason) {
  const auto path = test::TestData(GetParam().file);
  if (!path) GTEST_SKIP() << test::MissingData(GetParam().file);

  EXPECT_THAT(
      [&] { (void)ReadPcd(*path); },
      testing::ThrowsMessage<ReadError>(testing::StartsWith(path->string() + GetParam().reason)));
}

INSTANTIATE_TEST_SUITE_P(All, RefusedRecordingTest, testing::ValuesIn(kRefused));

TEST(Recordings, AreAllInTheTables) {
  const auto root = test::TestData(".");
  if (!root || !test::TestData("pcd_odd")) GTEST_SKIP() << test::MissingData("pcd_odd");
  std::set<std::string> known;
  for (const Expected& expected : kReadable) known.insert(expected.file);
  for (const Refused& refused : kRefused) known.insert(refused.file);

  for (const char* folder : {"pcd_odd", "indoor", "livox"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(*root / folder)) {
      if (entry.path().extension() != ".pcd") continue;
      const std::string name = std::filesystem::relative(entry.path(), *root).string();
      EXPECT_TRUE(known.count(name) == 1) << name << " is in no table";
    }
  }
}

TEST(Recordings, AreTheSameCloudInEachEncoding) {
  for (const auto& [one, other] :
       {std::pair{"pcd_odd/pypcd4/binary.pcd", "pcd_odd/pypcd4/binary_compressed.pcd"},
        std::pair{"pcd_odd/pypcd4/binary.pcd", "pcd_odd/pypcd4/ascii.pcd"},
        std::pair{"pcd_odd/pypcd4/ascii_organized.pcd",
                  "pcd_odd/pypcd4/binary_compressed_organized.pcd"}}) {
    const auto one_path = test::TestData(one);
    const auto other_path = test::TestData(other);
    if (!one_path || !other_path) GTEST_SKIP() << test::MissingData(one);

    const core::PointCloud one_cloud = ReadPcd(*one_path, 255.0).cloud;
    const core::PointCloud other_cloud = ReadPcd(*other_path, 255.0).cloud;

    EXPECT_EQ(one_cloud.x, other_cloud.x) << one;
    EXPECT_EQ(one_cloud.y, other_cloud.y) << one;
    EXPECT_EQ(one_cloud.z, other_cloud.z) << one;
    EXPECT_EQ(one_cloud.intensity, other_cloud.intensity) << one;
  }
}

TEST(Recordings, AreTheSameCompressedAgainByAnotherCompressor) {
  const char* file = "pcd_odd/pcl/colored_cloud.pcd";
  const auto path = test::TestData(file);
  if (!path) GTEST_SKIP() << test::MissingData(file);
  const core::PointCloud cloud = ReadPcd(*path).cloud;
  std::string by_field;
  for (const auto* axis : {&cloud.x, &cloud.y, &cloud.z}) {
    for (const float value : *axis) by_field += test::Encode(static_cast<double>(value), 'F', 4);
  }

  const std::string bytes =
      test::Render({.width = "WIDTH 1000",
                    .points = "POINTS 1000",
                    .data = "DATA binary_compressed",
                    .body = test::CompressedBody(test::CompressLzf(by_field), by_field.size())});
  const core::PointCloud again = ParsePcd(bytes, "again.pcd").cloud;

  EXPECT_EQ(again.x, cloud.x);
  EXPECT_EQ(again.y, cloud.y);
  EXPECT_EQ(again.z, cloud.z);
}

TEST(Recordings, OfferTheirViewpointAndGrid) {
  const char* logo = "pcd_odd/pcl/pcl_logo.pcd";
  const char* person = "indoor/pcl_person_organised.pcd";
  const auto logo_path = test::TestData(logo);
  const auto person_path = test::TestData(person);
  if (!logo_path || !person_path) GTEST_SKIP() << test::MissingData(logo);

  const PcdFile logo_file = ReadPcd(*logo_path);
  const PcdFile person_file = ReadPcd(*person_path);

  EXPECT_THAT(logo_file.viewpoint.translation_m, testing::ElementsAre(0.0, 0.0, -2.0));
  EXPECT_THAT(logo_file.viewpoint.rotation_wxyz, testing::ElementsAre(0.0, 1.0, 0.0, 0.0));
  EXPECT_EQ(person_file.width, 640U);
  EXPECT_EQ(person_file.height, 480U);
}

TEST(Recordings, AreRefusedWhenCutAnywhere) {
  // Each real file once more, cut at some places of its body; what is cut off there is more than
  // padding and more than the last number of a row.
  for (const Expected& expected : kReadable) {
    const auto path = test::TestData(expected.file);
    if (!path) GTEST_SKIP() << test::MissingData(expected.file);
    if (expected.points == 0) continue;
    std::ifstream stream(*path, std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    const std::size_t end = bytes.find_last_not_of(std::string("\0\n ", 3));
    for (const std::size_t cut : {std::size_t{0}, end / 3, end / 2, end - end / 100 - 30}) {
      EXPECT_THROW((void)ParsePcd(std::string_view(bytes).substr(0, cut), "cut.pcd"), ReadError)
          << expected.file << " cut to " << cut;
    }
  }
}

}  // namespace
}  // namespace clearway::io
