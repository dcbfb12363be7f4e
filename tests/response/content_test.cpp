// SPDX-License-Identifier: GPL-3.0-or-later
// What is written is what is read, sections that a scene does not use are absent, wrong content is refused.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>

#include "formats/error.hpp"
#include "palpate/runtime.hpp"
#include "tests/support/response_samples.hpp"

namespace palpate {
namespace {

using layout::Section;
using runtime::View;
using Options = test::ResponseSampleOptions;

void expect_close(const float (&a)[3], const Triple& b) {
  for (int k = 0; k < 3; ++k) EXPECT_EQ(a[k], static_cast<float>(b[k]));
}

TEST(ResponseFile, ReadsBackWhatWasWritten) {
  Options options;
  options.tools = Options::Tools::all;
  options.subdivision = 3;
  options.search = true;
  options.rim = options.relief = options.grasp = options.turn = true;
  const ResponseFileContent content = test::ball_content(options);
  const std::vector<std::byte> bytes = encode(content);
  const runtime::OpenResult opened = View::open(bytes.data(), bytes.size());
  ASSERT_TRUE(opened) << opened.error;
  const View& v = opened.view;

  EXPECT_EQ(v.features, layout::feature_all & ~(layout::feature_coupled | layout::feature_spin));
  EXPECT_EQ(v.meta->depth_scale, content.depth_scale);
  EXPECT_EQ(v.meta->rim_share, static_cast<float>(content.rim_share));
  EXPECT_EQ(v.meta->rim_limit, static_cast<float>(content.rim_limit));
  ASSERT_EQ(v.meta->site_count, content.sites.size());
  for (std::size_t i = 0; i < content.sites.size(); ++i) {
    expect_close(v.sites[i].position, content.sites[i].position);
    expect_close(v.sites[i].tangent, content.sites[i].tangent);
  }
  ASSERT_EQ(v.meta->triangle_count, content.surface_triangles.size());
  for (std::size_t i = 0; i < content.surface_triangles.size(); ++i) {
    const ResponseTriangle& t = content.surface_triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(v.triangles[i].vertex[k], t.vertices[k]);
      EXPECT_EQ(v.triangles[i].site[k], content.patches[t.patch][k]);
    }
  }
  ASSERT_EQ(v.meta->tool_count, 3U);
  EXPECT_EQ(v.find_tool("rod"), 1U);
  EXPECT_EQ(v.find_tool("ro"), 3U);
  EXPECT_STREQ(v.tool_vertices[4].name, "stem");
  ASSERT_EQ(v.meta->response_count, content.responses.size());
  for (std::size_t i = 0; i < content.responses.size(); ++i) {
    const Response& r = content.responses[i];
    EXPECT_EQ(v.response_head(i).flags, r.flags);
    EXPECT_EQ(v.relief(i), static_cast<double>(r.relief));
    EXPECT_EQ(0, std::memcmp(v.normal_coefs(i), r.normal.data(), 4 * r.normal.size()));
    EXPECT_EQ(0, std::memcmp(v.lateral_coefs(i) + 6, r.lateral_y.data(), 4 * r.lateral_y.size()));
    EXPECT_EQ(0, std::memcmp(v.friction_coefs(i) + 2 * 5 + 7, r.sideways_y.data(), 4 * r.sideways_y.size()));
    EXPECT_EQ(0, std::memcmp(v.friction_coefs(i) + 2 * 5 + 2 * 7, r.friction.data(), 4 * r.friction.size()));
    EXPECT_EQ(v.grasp_head(i).pulled, static_cast<float>(r.grasp_pulled));
    EXPECT_EQ(0, std::memcmp(v.grasp_curves(i), r.grasp.data(), 4 * r.grasp.size()));
    EXPECT_EQ(v.turn_head(i).turned, static_cast<float>(r.turned));
    EXPECT_EQ(0, std::memcmp(v.turn_curves(i), r.turn.data(), 4 * r.turn.size()));
  }
  EXPECT_EQ(std::string(v.provenance, v.provenance_size), content.provenance);
}

TEST(ResponseFile, SameContentSameBytes) { EXPECT_EQ(encode(test::box_content()), encode(test::box_content())); }

TEST(ResponseFile, FrictionlessOneTipFlatFileHasNoSectionItDoesNotUse) {
  Options options;
  options.friction = options.lateral = false;
  const std::vector<std::byte> bytes = encode(test::box_content(options));
  const runtime::OpenResult opened = View::open(bytes.data(), bytes.size());
  ASSERT_TRUE(opened) << opened.error;
  EXPECT_EQ(opened.view.features, 0U);
  for (const Section absent : {Section::tool_vertices, Section::tool_patches, Section::spins, Section::search,
                               Section::grasp, Section::turn}) {
    EXPECT_EQ(opened.view.section_bytes(absent), 0U);
  }
  EXPECT_EQ(opened.view.header().section_count, 7U);
  EXPECT_EQ(opened.view.response_size, 8 + 4 * opened.view.meta->normal_coefs);
}

TEST(ResponseFile, SectionsAreAlignedAndTheFileEndsAligned) {
  const std::vector<std::byte> bytes = encode(test::box_content());
  const View v = View::open(bytes.data(), bytes.size()).view;
  for (std::uint32_t i = 0; i < v.header().section_count; ++i) EXPECT_EQ(v.sections()[i].offset % 64, 0U);
  EXPECT_EQ(bytes.size() % 64, 0U);
}

struct Wrong {
  const char* says;
  std::function<void(ResponseFileContent&)> spoil;
};

void expect_refused(const ResponseFileContent& good, ExitCode code, const std::vector<Wrong>& cases) {
  for (const Wrong& bad : cases) {
    ResponseFileContent content = good;
    bad.spoil(content);
    try {
      encode(content);
      ADD_FAILURE() << "accepted: " << bad.says;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code) << error.what();
      EXPECT_NE(std::string(error.what()).find(bad.says), std::string::npos) << error.what();
    }
  }
}

// Every way of being wrong is refused, with a message that says which.
TEST(ResponseFile, WrongContentIsRefusedByName) {
  const ResponseFileContent good = test::box_content();
  ASSERT_NO_THROW(encode(good));
  expect_refused(
      good, ExitCode::bad_input,
      {
          {"depth scale", [](auto& c) { c.depth_scale = 0; }},
          {"depth scale", [](auto& c) { c.depth_scale = 2e3; }},
          {"sideways scale", [](auto& c) { c.sideways_scale = 0; }},
          {"sideways scale", [](auto& c) { c.sideways_scale = 1e-10; }},
          {"3 normal coefficients, allowed 4 to 32",
           [](auto& c) {
             c.normal_coefs = 3;
             for (Response& r : c.responses) r.normal.resize(3);
           }},
          {"all 0 or none", [](auto& c) { c.friction_coefs = 0; }},
          {"contact surface triangle 0: no patch 0", [](auto& c) { c.patches.clear(); }},
          {"site 2: position", [](auto& c) { c.sites[2].position[1] = NAN; }},
          {"site 2: position", [](auto& c) { c.sites[2].position[1] = 2e5; }},
          {"site 3: frame",
           [](auto& c) {
             c.sites[3].normal = Triple{0, 0, 2};
           }},
          {"site 4: frame", [](auto& c) { c.sites[4].tangent = c.sites[4].normal; }},
          {"site 5: depth limit", [](auto& c) { c.sites[5].depth_limit = 1; }},
          {"its patch must have three different sites", [](auto& c) { c.patches[1][0] = 9999; }},
          {"SURFACE_VERTICES: vertex 7", [](auto& c) { c.surface_vertices[7][2] = 2e5; }},
          {"contact surface triangle 0: no patch 9999", [](auto& c) { c.surface_triangles[0].patch = 9999; }},
          {"grid",
           [](auto& c) {
             c.surface_triangles[0].grid[0] = std::array<std::uint16_t, 2>{1, 1};
           }},
          {"disagree on the weights", [](auto& c) { std::swap(c.patches[0][0], c.patches[0][1]); }},
          {"not closed", [](auto& c) { c.surface_triangles.pop_back(); }},
          {"oriented",
           [](auto& c) { std::swap(c.surface_triangles[0].vertices[0], c.surface_triangles[0].vertices[1]); }},
          {"responses: there are", [](auto& c) { c.tools.clear(); }},
          {"name must have", [](auto& c) { c.tools[0].name = std::string(40, 'x'); }},
          {"tool 0: has no vertex", [](auto& c) { c.tools[0].vertices.clear(); }},
          {"tool 0: only a profile has an axis", [](auto& c) { c.tools[0].axis_length = 0.03; }},
          {"tool 0: the probe radius of a mesh", [](auto& c) { c.tools[0].kind = layout::ToolKind::mesh; }},
          {"sites times tool vertices", [](auto& c) { c.responses.pop_back(); }},
          {"response 2, lateral x: has 5", [](auto& c) { c.responses[2].lateral_x.pop_back(); }},
          {"PROVENANCE", [](auto& c) { c.provenance = "no"; }},
      });
}

TEST(ResponseFile, WrongCurvesAreANumericalFailure) {
  expect_refused(test::box_content(), ExitCode::numerical,
                 {
                     {"response 1: must be one of", [](auto& c) { c.responses[1].flags = 3; }},
                     {"response 1: depth limit", [](auto& c) { c.responses[1].depth_limit = 1; }},
                     {"response 1: normal force must start at zero and not decrease",
                      [](auto& c) { c.responses[1].normal[9] = 0; }},
                     {"response 2: normal force must start at zero", [](auto& c) { c.responses[2].normal[1] = 0.1F; }},
                     {"response 2: normal force", [](auto& c) { c.responses[2].normal[9] = 2e12F; }},
                     {"RESPONSES: response 2: sideways force", [](auto& c) { c.responses[2].lateral_x[5] = -2e12F; }},
                     {"response 3: sideways force must oppose", [](auto& c) { c.responses[3].sideways_x[6] = 9; }},
                     {"response 3: sideways force",
                      [](auto& c) { c.responses[3].sideways_y[0] += 0.1F, c.responses[3].sideways_y[3] += 0.1F; }},
                     {"response 4: growth", [](auto& c) { c.responses[4].growth_x[3] = -1; }},
                     {"response 4: growth", [](auto& c) { c.responses[4].growth_x[3] = 2e3F; }},
                     {"response 4: friction limit", [](auto& c) { c.responses[4].friction[0] = -1; }},
                     {"response 4: friction limit", [](auto& c) { c.responses[4].friction[0] = INFINITY; }},
                 });
}

TEST(ResponseFile, AWrongSearchTreeIsRefused) {
  Options options;
  options.search = true;
  expect_refused(test::box_content(options), ExitCode::bad_input,
                 {{"SEARCH", [](auto& c) { c.search[0].upper[0] = 0; }},
                  {"SEARCH", [](auto& c) { std::swap(c.surface_triangles.front(), c.surface_triangles.back()); }}});
}

// Where on such a tool the contact is, nothing could tell.
TEST(ResponseFile, OnlyAProfileWithAnAxisOrAMeshHasSeveralVertices) {
  Options options;
  options.tools = Options::Tools::capsule;
  expect_refused(
      test::box_content(options), ExitCode::bad_input,
      {{"tool 0: without an axis", [](auto& c) { c.tools[0].axis_length = 0; }},
       {"tool 0: without an axis",
        [](auto& c) {
          c.tools[0].kind = layout::ToolKind::point_sphere;
          c.tools[0].axis_length = 0;
        }},
       {"tool 0: only a profile has an axis", [](auto& c) { c.tools[0].kind = layout::ToolKind::point_sphere; }}});
}

TEST(ResponseFile, AProfileWhoseSegmentsDoNotAscendIsRefused) {
  Options options;
  options.tools = Options::Tools::capsule;
  ResponseFileContent content = test::box_content(options);
  std::swap(content.tools[0].patches[0], content.tools[0].patches[1]);
  EXPECT_THROW(encode(content), Error);
}

TEST(ResponseFile, SubdividedPatchesShareTheirEdges) {
  Options options;
  options.cells = 2;
  ResponseFileContent content = test::box_content(options);
  const std::vector<GridVertex> grid = subdivide_surface(content, 4);
  const std::size_t patches = content.patches.size(), edges = patches * 3 / 2;
  EXPECT_EQ(content.surface_triangles.size(), 16 * patches);
  EXPECT_EQ(grid.size(), content.sites.size() + 3 * edges + 3 * patches);
  for (const GridVertex& v : grid) EXPECT_NEAR(v.weights[0] + v.weights[1] + v.weights[2], 1, 1e-12);
  EXPECT_NO_THROW(encode(content));
  EXPECT_THROW(subdivide_surface(content, 0), Error);
}

class Folder : public ::testing::Test {
protected:
  void SetUp() override {
    path_ = std::filesystem::temp_directory_path() / ("palpate-response-" + std::to_string(::getpid()));
    std::filesystem::create_directories(path_);
  }
  void TearDown() override { std::filesystem::remove_all(path_); }
  std::filesystem::path path_;
};

TEST_F(Folder, WritesWholeFilesAndLeavesNothingBeside) {
  const std::vector<std::byte> bytes = encode(test::box_content());
  write_response_file(path_ / "a.palp", bytes);
  write_response_file(path_ / "a.palp", bytes);
  EXPECT_EQ(read_bytes(path_ / "a.palp"), bytes);
  const auto count = std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator());
  EXPECT_EQ(count, 1);
}

void expect_io(const std::function<void()>& act, const std::string& says) {
  try {
    act();
    ADD_FAILURE() << "no error, expected: " << says;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::io);
    EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
  }
}

TEST_F(Folder, SystemRefusalsAreIoErrorsThatNameTheFile) {
  const std::vector<std::byte> bytes(100);
  expect_io([&] { write_response_file(path_ / "none" / "a.palp", bytes); }, "a.palp");
  expect_io([&] { (void)read_bytes(path_ / "missing.palp"); }, "missing.palp");
  expect_io([&] { (void)read_bytes(path_); }, "not a regular file");
  std::filesystem::create_directory(path_ / "taken.palp");
  expect_io([&] { write_response_file(path_ / "taken.palp", bytes); }, "taken.palp: cannot write");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()), 1);
}

}  // namespace
}  // namespace palpate
