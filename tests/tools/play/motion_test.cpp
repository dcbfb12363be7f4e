// SPDX-License-Identifier: GPL-3.0-or-later
// Motion files: what is read, what is refused and in which line.
#include "tools/play/motion_file.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "formats/io/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace palpate {
namespace {

using cli::MotionRow;
using cli::read_motion;

const std::string kHeader = "t,x,y,z,qw,qx,qy,qz\n";

TEST(Motion, ReadsRowsWithSpacesAndWindowsLineEnds) {
  const test::TemporaryFolder folder;
  const auto file =
      folder.write("m.csv", " t, x,y,z,qw,qx,qy,qz\r\n0,0.1,-2e-3, 3 ,1,0,0,0\r\n\r\n0.5,1,2,3,0,0,0.6,0.8");
  const std::vector<MotionRow> rows = read_motion(file);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].position.y, -2e-3);
  EXPECT_EQ(rows[0].position.z, 3);
  EXPECT_EQ(rows[1].time, 0.5);
  EXPECT_EQ(rows[1].quaternion[3], 0.8);
}

TEST(Motion, PassesTheMarkOfUtf8Over) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_motion(folder.write("m.csv", "\xEF\xBB\xBF" + kHeader + "0,1,2,3,1,0,0,0\n")).size(), 1U);
}

TEST(Motion, HintsAtMillimetresAndMilliseconds) {
  std::vector<MotionRow> rows;
  for (int k = 0; k < 20; ++k) rows.push_back({0.001 * k, {-0.012, -0.005, 0.03 - 0.001 * k}, {1, 0, 0, 0}});
  const runtime::Vec3 low{-0.05, -0.04, -0.03}, high{0.05, 0.04, 0.03};
  EXPECT_EQ(cli::motion_hint(rows, low, high), "");
  std::vector<MotionRow> millimetres = rows, milliseconds = rows;
  for (MotionRow& row : millimetres) row.position = 1000 * row.position;
  for (MotionRow& row : milliseconds) row.time *= 1000;
  EXPECT_NE(cli::motion_hint(millimetres, low, high).find("look like millimetres"), std::string::npos);
  EXPECT_NE(cli::motion_hint(milliseconds, low, high).find("look like milliseconds"), std::string::npos);
}

TEST(Motion, RefusesWrongFilesWithTheirLine) {
  struct Case {
    std::string text, says;
  };
  const Case cases[] = {
      {"", "m.csv:1: the first line must be the header"},
      {"t,x,y,z\n", "m.csv:1: the first line must be the header"},
      {kHeader, "no rows"},
      {kHeader + "0,0,0,0,1,0,0,0\n0.1,0,0,zero,1,0,0,0\n", "m.csv:3: column 4: 'zero' is not a finite number"},
      {kHeader + "0,0,0,nan,1,0,0,0\n", "m.csv:2: column 4"},
      {kHeader + "0,0,0,1e999,1,0,0,0\n", "m.csv:2: column 4"},
      {kHeader + "0,0,0,,1,0,0,0\n", "m.csv:2: column 4: ''"},
      {kHeader + "0,0,0,0,1,0,0\n", "m.csv:2: 7 columns, expected 8"},
      {kHeader + "0,0,0,0,1,0,0,0,5\n", "m.csv:2: 9 columns, expected 8"},
      {kHeader + "1,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n", "m.csv:3: time 1.000000 s is not after"},
      {kHeader + "0,0,0,0,0,0,0,0\n", "m.csv:2: the quaternion's length is 0.000000, allowed 0.99 to 1.01"},
      {kHeader + "0,0,2e6,0,1,0,0,0\n", "m.csv:2: column 3: beyond 1e6 m"},
      {std::string("\x89PNG\r\n\x1a\n\0\0\0", 11), "m.csv:1"},
  };
  const test::TemporaryFolder folder;
  for (const Case& bad : cases) {
    const auto file = folder.write("m.csv", bad.text);
    try {
      read_motion(file);
      ADD_FAILURE() << "accepted: " << bad.says;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_input);
      EXPECT_NE(std::string(error.what()).find(bad.says), std::string::npos) << error.what();
    }
  }
  try {
    read_motion(folder.path() / "missing.csv");
    ADD_FAILURE() << "read a missing file";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::io);
  }
}

TEST(Motion, TurnsEvenlyTheShortWay) {
  const double half = std::sqrt(0.5);
  const MotionRow a{0, {0, 0, 0}, {1, 0, 0, 0}}, b{1, {1, 2, 3}, {-half, 0, 0, -half}};  // 90 degrees about z
  for (const double share : {0.0, 0.25, 0.5, 1.0}) {
    const runtime::Pose pose = cli::pose_between(a, b, share);
    EXPECT_TRUE(pose.valid());
    const double angle = share * std::acos(0.0);
    EXPECT_NEAR(pose.rotation[0], std::cos(angle), 1e-12);
    EXPECT_NEAR(pose.rotation[3], std::sin(angle), 1e-12);
    EXPECT_NEAR(pose.translation.z, 3 * share, 1e-12);
  }
}

}  // namespace
}  // namespace palpate
