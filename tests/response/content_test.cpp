// SPDX-License-Identifier: GPL-3.0-or-later
// The content that is read is the content that was written, unused sections are absent, wrong content is refused.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>

#include "formats/io/error.hpp"
#include "palpate/format/open.hpp"
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
  options.softening = options.bonded = options.bonded_torque = true;
  options.modes = 8;
  const ResponseFileContent content = test::ball_content(options);
  const std::vector<std::byte> bytes = encode(content);
  const runtime::OpenResult opened = View::open(bytes.data(), bytes.size());
  ASSERT_TRUE(opened) << opened.error;
  const View& v = opened.view;

  EXPECT_EQ(v.features, layout::feature_all & ~layout::feature_spin);
  EXPECT_EQ(v.meta->depth_scale, content.depth_scale);
  EXPECT_EQ(v.meta->tangential_scale, content.tangential_scale);
  EXPECT_EQ(response::degrees(*v.meta), content.degrees);
  ASSERT_EQ(v.meta->site_count, content.sites.size());
  for (std::size_t i = 0; i < content.sites.size(); ++i) {
    expect_close(v.vertices[i].xyz, content.surface_vertices[i]);
    expect_close(v.sites[i].tangent, content.sites[i].tangent);
  }
  ASSERT_EQ(v.meta->triangle_count, content.surface_triangles.size());
  for (std::uint32_t i = 0; i < content.surface_triangles.size(); ++i) {
    const ResponseTriangle& t = content.surface_triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(v.triangle(i).vertex[k], t.vertices[k]);
      EXPECT_EQ(v.triangle(i).site[k], content.patches[t.patch][k]);
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
    EXPECT_EQ(v.softening(i), static_cast<double>(r.softening));
    EXPECT_EQ(v.coefficient_unit(i), r.unit);
    std::vector<std::int16_t> coefs(r.coefficients.size());
    v.coefficients(i, coefs.data());
    EXPECT_EQ(coefs, r.coefficients);
    EXPECT_EQ(v.bonded_head(i).pulled, static_cast<float>(r.bonded_pulled));
    EXPECT_EQ(0, std::memcmp(v.bonded_curves(i), r.bonded.data(), 4 * r.bonded.size()));
    EXPECT_EQ(v.torque_head(i).rotated, static_cast<float>(r.rotated));
    EXPECT_EQ(0, std::memcmp(v.torque_curves(i), r.bonded_torque.data(), 4 * r.bonded_torque.size()));
  }
  EXPECT_EQ(std::string(v.provenance, v.provenance_size), content.provenance);
}

TEST(ResponseFile, CoefficientsOfEveryWidthAreReadBack) {
  for (const std::uint32_t bits : {8U, 12U, 16U}) {
    for (const bool bias : {false, true}) {
      for (const bool friction : {false, true}) {
        Options options;
        options.cells = 1;
        options.bits = bits;
        options.bias = bias;
        options.friction = friction;
        const ResponseFileContent content = test::box_content(options);
        const std::vector<std::byte> bytes = encode(content);
        const runtime::OpenResult opened = View::open(bytes.data(), bytes.size());
        ASSERT_TRUE(opened) << opened.error;
        for (std::size_t i = 0; i < content.responses.size(); ++i) {
          std::vector<std::int16_t> coefs(content.responses[i].coefficients.size());
          opened.view.coefficients(i, coefs.data());
          EXPECT_EQ(coefs, content.responses[i].coefficients) << bits;
        }
      }
    }
  }
}

TEST(ResponseFile, SameContentSameBytes) { EXPECT_EQ(encode(test::box_content()), encode(test::box_content())); }

TEST(ResponseFile, FrictionlessOneTipFlatFileHasNoSectionItDoesNotUse) {
  Options options;
  options.friction = options.bias = false;
  const std::vector<std::byte> bytes = encode(test::box_content(options));
  const runtime::OpenResult opened = View::open(bytes.data(), bytes.size());
  ASSERT_TRUE(opened) << opened.error;
  EXPECT_EQ(opened.view.features, 0U);
  for (const Section absent :
       {Section::tool_vertices, Section::tool_patches, Section::spins, Section::search, Section::bonded,
        Section::bonded_torque, Section::compliance, Section::compliance_sites}) {
    EXPECT_EQ(opened.view.section_bytes(absent), 0U);
  }
  EXPECT_EQ(opened.view.header().section_count, 8U);
  EXPECT_EQ(opened.view.response_size, 8U + 4U + 2U * 4U) << "head, unit, four coefficients of F";
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
          {"depth_scale", [](auto& c) { c.depth_scale = 0; }},
          {"depth_scale", [](auto& c) { c.depth_scale = 2e3; }},
          {"tangential scale: must be above 0 with friction", [](auto& c) { c.tangential_scale = 0; }},
          {"tangential_scale", [](auto& c) { c.tangential_scale = 1e-10; }},
          {"normal_degree must be 2 to 6", [](auto& c) { c.degrees.normal = 7; }},
          {"stiffness_degree must be 0 or 2 to 6", [](auto& c) { c.degrees.stiffness = 1; }},
          {"must be 0 in a frictionless file", [](auto& c) { c.degrees.friction_families = false; }},
          {"coefficients: have 10 bits", [](auto& c) { c.coef_bits = 10; }},
          {"torques of bonded contacts: need curves", [](auto& c) { c.has_bonded_torque = true; }},
          {"response 1: has a slip softening", [](auto& c) { c.responses[1].softening = 0.1F; }},
          {"contact surface triangle 0: no patch 0", [](auto& c) { c.patches.clear(); }},
          {"vertex 2 is not finite", [](auto& c) { c.surface_vertices[2][1] = NAN; }},
          {"vertex 2 is not finite", [](auto& c) { c.surface_vertices[2][1] = 2e5; }},
          {"site 3: frame",
           [](auto& c) {
             c.sites[3].normal = Triple{0, 0, 2};
           }},
          {"site 4: frame", [](auto& c) { c.sites[4].tangent = c.sites[4].normal; }},
          {"site 5: depth limit", [](auto& c) { c.sites[5].depth_limit = 1; }},
          {"SURFACE_PATCHES: patch 1: must have three different sites", [](auto& c) { c.patches[1][0] = 9999; }},
          {"SURFACE_VERTICES: vertex 7", [](auto& c) { c.surface_vertices[7][2] = 2e5; }},
          {"contact surface triangle 0: no patch 9999", [](auto& c) { c.surface_triangles[0].patch = 9999; }},
          {"grid",
           [](auto& c) {
             c.surface_triangles[0].grid[0] = std::array<std::uint8_t, 2>{1, 1};
           }},
          {"a corner at a site must have its vertex", [](auto& c) { std::swap(c.patches[0][0], c.patches[0][1]); }},
          {"vertices for", [](auto& c) { c.surface_vertices.resize(3); }},
          {"not closed", [](auto& c) { c.surface_triangles.pop_back(); }},
          {"oriented",
           [](auto& c) { std::swap(c.surface_triangles[0].vertices[0], c.surface_triangles[0].vertices[1]); }},
          {"responses: there are", [](auto& c) { c.tools.clear(); }},
          {"name must have", [](auto& c) { c.tools[0].name = std::string(40, 'x'); }},
          {"tool 0: has no vertex", [](auto& c) { c.tools[0].vertices.clear(); }},
          {"tool 0: only a profile has an axis", [](auto& c) { c.tools[0].axis_length = 0.03; }},
          {"tool 0: the probe radius of a mesh", [](auto& c) { c.tools[0].kind = layout::ToolKind::mesh; }},
          {"sites times tool vertices", [](auto& c) { c.responses.pop_back(); }},
          {"response 2, coefficients: has 30 coefficients, the file 31",
           [](auto& c) { c.responses[2].coefficients.pop_back(); }},
          {"response 2: coefficient 0 is -32768", [](auto& c) { c.responses[2].coefficients[0] = -32768; }},
          {"PROVENANCE", [](auto& c) { c.provenance = "no"; }},
      });
}

TEST(ResponseFile, NeighboursThatDisagreeOnTheWeightsOfACornerAreRefused) {
  Options options;
  options.subdivision = 3;
  expect_refused(test::box_content(options), ExitCode::bad_input,
                 {{"disagree on the weights", [](auto& c) {
                     for (ResponseTriangle& t : c.surface_triangles) {
                       for (int k = 0; k < 3; ++k) {
                         if (t.vertices[k] < c.sites.size() || t.grid[k][0] == t.grid[k][1]) continue;
                         std::swap(t.grid[k][0], t.grid[k][1]);
                         return;
                       }
                     }
                   }}});
}

// More than 65536 triangles: indices of four bytes.
TEST(ResponseFile, ALargeSurfaceHasWideIndices) {
  Options options;
  options.subdivision = 23;
  options.search = true;
  const ResponseFileContent content = test::ball_content(options);
  ASSERT_GT(content.surface_triangles.size(), 65536U);
  const std::vector<std::byte> bytes = encode(content);
  const runtime::OpenResult opened = View::open(bytes.data(), bytes.size());
  ASSERT_TRUE(opened) << opened.error;
  EXPECT_EQ(opened.view.meta->index_bytes, 4U);
  const auto last = static_cast<std::uint32_t>(content.surface_triangles.size() - 1);
  const ResponseTriangle& written = content.surface_triangles.back();
  const layout::SurfaceTriangle read = opened.view.triangle(last);
  EXPECT_EQ(read.patch, written.patch);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(read.vertex[k], written.vertices[k]);
    EXPECT_EQ(read.site[k], content.patches[written.patch][k]);
    EXPECT_EQ(read.grid[k][0], written.grid[k][0]);
    EXPECT_EQ(read.grid[k][1], written.grid[k][1]);
  }
}

TEST(ResponseFile, WrongResponsesAreANumericalFailure) {
  const ResponseFileContent good = test::box_content();
  const response::Offsets o = response::offsets(good.degrees);
  const auto at = [](int index) { return static_cast<std::size_t>(index); };
  expect_refused(
      good, ExitCode::numerical,
      {
          {"response 1: flags 3, allowed one of", [](auto& c) { c.responses[1].flags = 3; }},
          {"response 1: depth limit", [](auto& c) { c.responses[1].depth_limit = 1; }},
          {"response 1: its unit", [](auto& c) { c.responses[1].unit = INFINITY; }},
          {"response 1: the normal force must start at zero and not decrease",
           [&](auto& c) { c.responses[1].coefficients[at(o.bias - 1)] = 0; }},
          {"response 2: the normal force must start at zero", [](auto& c) { c.responses[2].coefficients[0] = -1; }},
          {"response 3: stiffness and coupling break the passivity inequalities",
           [&](auto& c) { c.responses[3].coefficients[at(o.stiffness)] = 0; }},
          {"response 4: the friction coefficient is out of 0 to 10",
           [&](auto& c) { c.responses[4].coefficients[at(o.friction)] = -1; }},
      });
}

TEST(ResponseFile, ASpringOfAFrictionlessBodyIsTheNormalForceAlone) {
  Options options;
  options.friction = options.bias = false;
  options.bits = 8;
  const std::vector<std::byte> bytes = encode(test::box_content(options));
  EXPECT_EQ(View::open(bytes.data(), bytes.size()).view.response_size, 8U + 4U + 4U);
}

TEST(ResponseFile, AWrongSearchTreeIsRefused) {
  Options options;
  options.search = true;
  expect_refused(test::box_content(options), ExitCode::bad_input,
                 {{"SEARCH", [](auto& c) { c.search[0].upper[0] = 0; }},
                  {"SEARCH", [](auto& c) { std::swap(c.surface_triangles.front(), c.surface_triangles.back()); }}});
}

// A pose does not determine the contact point of another tool of several vertices.
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
