// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings as users write them, and those that are wrong, each with the line that its message must name.
#include "formats/recording/recording.hpp"

#include <gtest/gtest.h>

#include <ostream>
#include <vector>

#include "formats/io/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace palpate::test {
namespace {

const char* const kHeader = "x,y,z,dx,dy,dz,fx,fy,fz\n";
const char* const kRow = "0.01,0.02,0.05,0,0,-0.001,0.01,0,0.2\n";

TEST(Recording, ReadsColumnsInAnyOrderAndPassesComments) {
  const TemporaryFolder folder;
  const Recording r =
      read_recording(folder.write("a.csv",
                                  "\xEF\xBB\xBF# probe\r\n\r\n fz, fx ,fy,tool,dx,dy,dz,site,weight,t,tool_vertex\r\n"
                                  "# pushed by hand\r\n0.2,1e-2,0, probe ,0,1e-4,-0.001,7,0.5,12.25,3\r\n"
                                  "0.3,0,0,,0,0,-0.002,7,0,12.5,0"));
  ASSERT_EQ(r.rows.size(), 2U);
  const RecordedRow& row = r.rows[0];
  EXPECT_EQ(row.line, 5U);
  EXPECT_EQ(row.site, 7);
  EXPECT_EQ(row.deflection, Eigen::Vector3d(0, 1e-4, -0.001));
  EXPECT_EQ(row.force, Eigen::Vector3d(0.01, 0, 0.2));
  EXPECT_EQ(row.tool, "probe");
  EXPECT_EQ(row.tool_vertex, 3);
  EXPECT_EQ(row.weight, 0.5);
  EXPECT_TRUE(r.rows[1].tool.empty());
  EXPECT_EQ(r.rows[1].line, 6U);
}

TEST(Recording, PointsAreInPlaceOfSites) {
  const TemporaryFolder folder;
  const Recording r = read_recording(folder.write("a.csv", std::string(kHeader) + kRow));
  ASSERT_EQ(r.rows.size(), 1U);
  EXPECT_FALSE(r.rows[0].site);
  EXPECT_EQ(r.rows[0].point, Eigen::Vector3d(0.01, 0.02, 0.05));
  EXPECT_EQ(r.rows[0].weight, 1.0);
}

struct Case {
  std::string name, text;
  int line;  ///< 0: of the file as a whole
  std::string expected;
};
[[maybe_unused]] void PrintTo(const Case& test_case, std::ostream* out) { *out << test_case.name; }

std::vector<Case> cases() {
  const std::string head = kHeader, row = kRow;
  const auto bad_row = [&](const std::string& name, const std::string& text, const std::string& expected) {
    return Case{name, "# comment\n" + head + row + text + "\n" + row, 4, expected};
  };
  return {
      {"empty", "", 0, "no header"},
      {"comments_only", "# a\n# b\n", 0, "no header"},
      {"header_only", head, 0, "no row"},
      {"headless", row, 1, "unknown column '0.01'"},
      {"unknown_column", "x,y,z,dx,dy,dz,fx,fy,fz,speed\n" + row, 1, "unknown column 'speed'; allowed: x, y, z"},
      {"semicolons", "x;y;z;dx;dy;dz;fx;fy;fz\n", 1, "unknown column 'x;y;z"},
      {"twice", "\nx,y,z,dx,dy,dz,fx,fy,fz,fx\n", 2, "'fx' is there twice"},
      {"no_force", "x,y,z,dx,dy,dz,fx,fy\n", 1, "'fz' is missing"},
      {"no_deflection", "x,y,z,dx,dy,fx,fy,fz\n", 1, "'dz' is missing"},
      {"no_place", "dx,dy,dz,fx,fy,fz\n", 1, "x, y, z or the column site"},
      {"half_a_place", "x,y,dx,dy,dz,fx,fy,fz\n", 1, "x, y, z or the column site"},
      {"two_places", "site,x,dx,dy,dz,fx,fy,fz\n", 1, "x, y, z or the column site"},
      bad_row("too_few", "0.01,0.02,0.05,0,0,-0.001,0.01,0", "got 8 fields, the header has 9"),
      bad_row("too_many", "0.01,0.02,0.05,0,0,-0.001,0.01,0,0.2,", "got 10 fields, the header has 9"),
      bad_row("text", "0.01,0.02,0.05,0,0,deep,0.01,0,0.2",
              "column dz: got 'deep'; allowed a number, -100 <= dz <= 100"),
      bad_row("empty_field", "0.01,0.02,0.05,0,0,,0.01,0,0.2", "column dz: got ''"),
      bad_row("unit", "0.01,0.02,0.05,0,0,-1mm,0.01,0,0.2", "column dz: got '-1mm'"),
      bad_row("nan", "0.01,0.02,0.05,0,0,-0.001,nan,0,0.2", "column fx: got 'nan'"),
      bad_row("infinite", "0.01,0.02,0.05,0,0,-0.001,0,0,inf", "column fz: got 'inf'"),
      bad_row("millimetres", "100.5,0.02,0.05,0,0,-0.001,0,0,1", "column x: got '100.5'; allowed a number, -100 <= x"),
      bad_row("overflow", "0.01,0.02,0.05,0,0,-0.001,0,0,1e999", "column fz: got '1e999'"),
      {"bad_site", "site,dx,dy,dz,fx,fy,fz\n-1,0,0,0,0,0,0\n", 2, "column site: got '-1'; allowed a whole number"},
      {"site_with_a_point", "site,dx,dy,dz,fx,fy,fz\n1.5,0,0,0,0,0,0\n", 2, "column site: got '1.5'"},
      {"bad_vertex", "site,dx,dy,dz,fx,fy,fz,tool_vertex\n1,0,0,0,0,0,0,tip\n", 2, "column tool_vertex: got 'tip'"},
      {"bad_weight", "site,dx,dy,dz,fx,fy,fz,weight\n1,0,0,0,0,0,0,-1\n", 2, "column weight: got '-1'"},
      {"bad_time", "site,dx,dy,dz,fx,fy,fz,t\n1,0,0,0,0,0,0,noon\n", 2, "column t: got 'noon'"},
  };
}

class BadRecording : public testing::TestWithParam<Case> {};

TEST_P(BadRecording, NamesFileLineAndCause) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("bad.csv", GetParam().text);
  try {
    read_recording(file);
    FAIL() << "read without complaint";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    const std::string text = error.what();
    const std::string place =
        file.string() + (GetParam().line > 0 ? ":" + std::to_string(GetParam().line) + ": " : ": the recording ");
    EXPECT_EQ(text.substr(0, place.size()), place);
    EXPECT_NE(text.find(GetParam().expected), std::string::npos) << text;
  }
}

INSTANTIATE_TEST_SUITE_P(All, BadRecording, testing::ValuesIn(cases()),
                         [](const auto& test_case) { return test_case.param.name; });

TEST(Recording, AFileThatIsNotThereIsAnIoError) {
  try {
    read_recording("no/such/recording.csv");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::io);
  }
}

}  // namespace
}  // namespace palpate::test
