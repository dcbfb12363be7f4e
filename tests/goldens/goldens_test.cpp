// SPDX-License-Identifier: GPL-3.0-or-later
// Files of version 2 as they were frozen: they open, answer as they did, and are written as they were.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "formats/response.hpp"
#include "tests/goldens/goldens.hpp"

namespace palpate::test {
namespace {

using runtime::View;

const std::filesystem::path kFolder = PALPATE_GOLDENS;

std::vector<std::string> names() {
  std::vector<std::string> list;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    if (entry.path().extension() == ".palp") list.push_back(entry.path().stem().string());
  }
  std::sort(list.begin(), list.end());
  return list;
}

std::vector<GoldenLine> read_lines(const std::filesystem::path& file) {
  std::vector<GoldenLine> lines;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    GoldenLine golden;
    words >> golden.word;
    std::vector<double>* to = &golden.asked;
    for (std::string word; words >> word;) {
      if (word == "=") {
        to = &golden.answered;
      } else {
        to->push_back(std::stod(word));
      }
    }
    lines.push_back(golden);
  }
  return lines;
}

Triple triple(const float (&v)[3]) { return to_triple(v); }

std::vector<float> list(const float* from, std::uint32_t count) { return {from, from + count}; }

Response response(const View& v, std::uint64_t i) {
  const layout::Meta& m = *v.meta;
  Response r;
  r.depth_limit = v.response_head(i).depth_limit;
  r.flags = v.response_head(i).flags;
  if (m.relief_count > 0) r.relief = static_cast<float>(v.relief(i));
  r.normal = list(v.normal_coefs(i), m.normal_coefs);
  if (m.lateral_coefs > 0) {
    r.lateral_x = list(v.lateral_coefs(i), m.lateral_coefs);
    r.lateral_y = list(v.lateral_coefs(i) + m.lateral_coefs, m.lateral_coefs);
  }
  if (m.friction_coefs > 0) {
    const float* from = v.friction_coefs(i);
    for (auto* family : {&r.growth_x, &r.growth_y}) *family = list(from, m.growth_coefs), from += m.growth_coefs;
    for (auto* family : {&r.sideways_x, &r.sideways_y})
      *family = list(from, m.sideways_coefs), from += m.sideways_coefs;
    r.friction = list(from, m.friction_coefs);
  }
  if (layout::is_coupled(m)) {
    std::int16_t coefs[coupled::kMostCoefs];
    v.coupled_coefs(i, coefs);
    r.unit = v.coupled_unit(i);
    r.coupled.assign(coefs, coefs + coupled::count(layout::coupled_degrees(m)));
  }
  if (v.grasps != nullptr) {
    r.grasp_depth = v.grasp_head(i).depth;
    r.grasp_pulled = v.grasp_head(i).pulled;
    r.grasp = list(v.grasp_curves(i), layout::kGraspCurves * m.grasp_coefs);
  }
  if (v.turns != nullptr) {
    r.turned = v.turn_head(i).turned;
    r.turn = list(v.turn_curves(i), layout::kTurnCurves * m.grasp_coefs);
  }
  return r;
}

ResponseTool tool(const View& v, const layout::ToolRecord& from) {
  ResponseTool t{
      from.name, static_cast<layout::ToolKind>(from.kind), from.radius, from.probe_radius, from.axis_length, {}, {}};
  if (v.tool_vertices == nullptr) {
    t.vertices.emplace_back();
    return t;
  }
  for (std::uint32_t k = 0; k < from.vertex_count; ++k) {
    const layout::ToolVertexRecord& r = v.tool_vertices[from.first_vertex + k];
    t.vertices.push_back({r.name, triple(r.point), triple(r.normal), triple(r.tangent), r.meridian});
    if (v.spins != nullptr) t.vertices.back().spins = v.spins[from.first_vertex + k];
  }
  for (std::uint32_t k = 0; k < from.patch_count; ++k) {
    const auto& p = v.tool_patches[from.first_patch + k].vertex;
    t.patches.push_back({p[0] - from.first_vertex, p[1] - from.first_vertex, p[2] - from.first_vertex});
  }
  return t;
}

/// The content that a file was written from.
ResponseFileContent content(const View& v) {
  const layout::Meta& m = *v.meta;
  ResponseFileContent c;
  c.depth_scale = m.depth_scale;
  c.sideways_scale = m.sideways_scale;
  c.normal_coefs = m.normal_coefs;
  c.lateral_coefs = m.lateral_coefs;
  c.growth_coefs = m.growth_coefs;
  c.sideways_coefs = m.sideways_coefs;
  c.friction_coefs = m.friction_coefs;
  if (layout::is_coupled(m)) c.coupled = layout::coupled_degrees(m);
  if (c.coupled) c.coupled_bits = m.coef_bits;
  c.rim_share = static_cast<double>(v.meta->rim_share);
  c.rim_limit = static_cast<double>(v.meta->rim_limit);
  c.reliefs = m.relief_count > 0;
  c.grasp_coefs = m.grasp_coefs;
  c.turns = v.turns != nullptr;
  for (std::uint32_t i = 0; i < m.site_count; ++i) {
    const layout::Site& s = v.sites[i];
    c.sites.push_back({triple(s.position), triple(s.normal), triple(s.tangent), s.depth_limit, s.flags});
  }
  c.subdivision = m.subdivision;
  for (std::uint32_t i = 0; i < m.vertex_count; ++i) c.surface_vertices.push_back(triple(v.vertices[i].xyz));
  for (std::uint32_t i = 0; i < m.triangle_count; ++i) {
    const layout::SurfaceTriangle& t = v.triangles[i];
    ResponseTriangle to{{t.vertex[0], t.vertex[1], t.vertex[2]}, i, {}};
    c.patches.push_back({t.site[0], t.site[1], t.site[2]});
    for (std::size_t k = 0; k < 3; ++k) to.grid[k] = {t.grid[k][0], t.grid[k][1]};
    c.surface_triangles.push_back(to);
  }
  for (std::uint32_t i = 0; i < m.tool_count; ++i) c.tools.push_back(tool(v, v.tools[i]));
  for (std::uint64_t i = 0; i < m.response_count; ++i) c.responses.push_back(response(v, i));
  c.search.assign(v.search, v.search + m.search_nodes);
  c.provenance.assign(v.provenance, v.provenance_size);
  return c;
}

class Golden : public testing::TestWithParam<std::string> {
protected:
  void SetUp() override {
    bytes_ = read_bytes(kFolder / (GetParam() + ".palp"));
    const runtime::OpenResult opened = View::open(bytes_.data(), bytes_.size());
    ASSERT_TRUE(opened) << opened.error;
    view_ = opened.view;
  }
  std::vector<std::byte> bytes_;
  View view_;
};

TEST_P(Golden, AnswersAsItDid) {
  const std::vector<GoldenLine> lines = read_lines(kFolder / (GetParam() + ".forces"));
  ASSERT_GE(lines.size(), 32U);
  const coupled::Degrees degrees = layout::coupled_degrees(*view_.meta);
  const bool steps = layout::is_coupled(*view_.meta) && (degrees.order > 2 || degrees.straight > 0);
  for (const GoldenLine& line : lines) {
    // An anchor that a reader moves in steps is where the specification says, not to the last bit.
    const double tolerance = steps && line.word == "deepen" ? 0.01 : 1e-10;
    const std::vector<double> now = answer(view_, line.word, line.asked);
    ASSERT_EQ(now.size(), line.answered.size());
    double size = 0;
    for (const double value : line.answered) size = std::isinf(value) ? size : std::max(size, std::abs(value));
    for (std::size_t k = 0; k < now.size(); ++k) {
      if (std::isinf(line.answered[k])) {
        EXPECT_EQ(now[k], line.answered[k]);
      } else {
        EXPECT_NEAR(now[k], line.answered[k], tolerance * size)
            << line.word << " " << testing::PrintToString(line.asked);
      }
    }
  }
}

TEST_P(Golden, IsWrittenAsItWas) { EXPECT_EQ(encode(content(view_)), bytes_); }

INSTANTIATE_TEST_SUITE_P(Version1, Golden, testing::ValuesIn(names()), [](const auto& golden) { return golden.param; });

TEST(Goldens, EveryFeatureIsInOneAndLeftOutOfAnother) {
  std::uint32_t with = 0, without = 0;
  for (const std::string& name : names()) {
    const std::vector<std::byte> bytes = read_bytes(kFolder / (name + ".palp"));
    const runtime::OpenResult opened = View::open(bytes.data(), bytes.size());
    ASSERT_TRUE(opened) << name << ": " << opened.error;
    EXPECT_EQ(opened.view.header().version, 2U);
    with |= opened.view.features;
    without |= ~opened.view.features;
  }
  EXPECT_EQ(with, layout::feature_all);
  EXPECT_EQ(without & layout::feature_all, layout::feature_all);
}

}  // namespace
}  // namespace palpate::test
