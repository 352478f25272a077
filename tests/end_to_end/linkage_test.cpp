// SPDX-License-Identifier: BSD-3-Clause
// What runs on the robot brings no display libraries along.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/running_graph.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::test {
namespace {

std::string LibrariesOf(const std::string& program) {
  const TestFolder folder;
  const ProgramResult result = RunProgram({"ldd", Program(program)}, folder.path());
  EXPECT_EQ(result.exit_status, 0) << result.err;
  return result.out;
}

class LinkageTest : public testing::TestWithParam<const char*> {};

TEST_P(LinkageTest, ARobotProgramLinksNeitherVtkNorQt) {
  const std::string libraries = LibrariesOf(GetParam());

  EXPECT_THAT(libraries, testing::HasSubstr("liblcm"));
  for (const char* unwanted : {"libvtk", "libQt", "libGL", "libX11", "libcairo"}) {
    EXPECT_THAT(libraries, testing::Not(testing::HasSubstr(unwanted)));
  }
}

INSTANTIATE_TEST_SUITE_P(Programs,
                         LinkageTest,
                         testing::Values("preprocessor", "clusterer", "stop-guard", "play"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST(StopGuardLinkageTest, ThereIsNoPcl) {
  EXPECT_THAT(LibrariesOf("stop-guard"), testing::Not(testing::HasSubstr("libpcl")));
  EXPECT_THAT(LibrariesOf("stop-guard"), testing::Not(testing::HasSubstr("libflann")));
}

}  // namespace
}  // namespace clearway::test
