// SPDX-License-Identifier: GPL-3.0-or-later
// Frozen files of version 4: they open, their answers are the frozen ones, and their content gives the same bytes.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "formats/response/response.hpp"
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

Response read_response(const View& v, std::uint64_t i) {
  const layout::Meta& m = *v.meta;
  Response r;
  r.depth_limit = v.response_head(i).depth_limit;
  r.flags = v.response_head(i).flags;
  if (m.softening_count > 0) r.softening = static_cast<float>(v.softening(i));
  std::int16_t coefs[response::kMostCoefs];
  v.coefficients(i, coefs);
  r.unit = v.coefficient_unit(i);
  r.coefficients.assign(coefs, coefs + response::count(response::degrees(m)));
  if (v.bonded != nullptr) {
    r.bonded_depth = v.bonded_head(i).depth;
    r.bonded_pulled = v.bonded_head(i).pulled;
    r.bonded = list(v.bonded_curves(i), layout::kBondedCurves * m.bonded_coefs);
  }
  if (v.bonded_torque != nullptr) {
    r.rotated = v.torque_head(i).rotated;
    r.bonded_torque = list(v.torque_curves(i), layout::kTorqueCurves * m.bonded_coefs);
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
  c.tangential_scale = m.tangential_scale;
  c.degrees = response::degrees(m);
  c.coef_bits = m.coef_bits;
  c.slip_softening = m.softening_count > 0;
  c.bonded_coefs = m.bonded_coefs;
  c.has_bonded_torque = v.bonded_torque != nullptr;
  for (std::uint32_t i = 0; i < m.site_count; ++i) {
    const layout::Site& s = v.sites[i];
    c.sites.push_back({triple(s.normal), triple(s.tangent), s.depth_limit, s.flags});
  }
  c.subdivision = m.subdivision;
  for (std::uint32_t i = 0; i < m.patch_count; ++i) {
    std::uint32_t site[3];
    v.patch_sites(i, site);
    c.patches.push_back({site[0], site[1], site[2]});
  }
  for (std::uint32_t i = 0; i < m.vertex_count; ++i) c.surface_vertices.push_back(triple(v.vertices[i].xyz));
  for (std::uint32_t i = 0; i < m.triangle_count; ++i) {
    const layout::SurfaceTriangle t = v.triangle(i);
    ResponseTriangle to{{t.vertex[0], t.vertex[1], t.vertex[2]}, t.patch, {}};
    for (std::size_t k = 0; k < 3; ++k) to.grid[k] = {t.grid[k][0], t.grid[k][1]};
    c.surface_triangles.push_back(to);
  }
  for (std::uint32_t i = 0; i < m.tool_count; ++i) c.tools.push_back(tool(v, v.tools[i]));
  for (std::uint64_t i = 0; i < m.response_count; ++i) c.responses.push_back(read_response(v, i));
  c.search.assign(v.search, v.search + m.search_nodes);
  c.search_grid = m.search_grid;
  c.provenance.assign(v.provenance, v.provenance_size);
  if (v.compliance != nullptr) {
    ResponseCompliance shared{v.compliance->modes,
                              v.compliance->negative,
                              v.compliance->poisson,
                              v.compliance->rounding,
                              v.compliance->stiffening,
                              {},
                              {}};
    for (std::uint32_t i = 0; i < m.site_count; ++i) {
      shared.shear.push_back(v.compliance_site(i).shear);
      for (std::uint32_t k = 0; k < 3 * shared.modes; ++k) {
        shared.values.push_back(static_cast<double>(v.compliance_site(i).unit) * v.compliance_modes(i)[k]);
      }
    }
    c.compliance = shared;
  }
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

TEST_P(Golden, GivesTheFrozenAnswers) {
  const std::vector<GoldenLine> lines = read_lines(kFolder / (GetParam() + ".forces"));
  ASSERT_GE(lines.size(), 32U);
  for (const GoldenLine& line : lines) {
    // Frames are stored as floats, and formulas for one rotation differ by their rounding.
    constexpr double kTolerance = 1e-8;
    const std::vector<double> now = answer(view_, line.word, line.asked);
    ASSERT_EQ(now.size(), line.answered.size());
    double size = 0;
    for (const double value : line.answered) size = std::isinf(value) ? size : std::max(size, std::abs(value));
    for (std::size_t k = 0; k < now.size(); ++k) {
      if (std::isinf(line.answered[k])) {
        EXPECT_EQ(now[k], line.answered[k]);
      } else {
        EXPECT_NEAR(now[k], line.answered[k], kTolerance * size)
            << line.word << " " << testing::PrintToString(line.asked);
      }
    }
  }
}

TEST_P(Golden, ContentGivesTheSameBytes) { EXPECT_EQ(encode(content(view_)), bytes_); }

INSTANTIATE_TEST_SUITE_P(Version4, Golden, testing::ValuesIn(names()), [](const auto& golden) { return golden.param; });

TEST(Goldens, EveryFeatureIsInOneAndLeftOutOfAnother) {
  std::uint32_t with = 0, without = 0;
  for (const std::string& name : names()) {
    const std::vector<std::byte> bytes = read_bytes(kFolder / (name + ".palp"));
    const runtime::OpenResult opened = View::open(bytes.data(), bytes.size());
    ASSERT_TRUE(opened) << name << ": " << opened.error;
    EXPECT_EQ(opened.view.header().version, 4U);
    with |= opened.view.features;
    without |= ~opened.view.features;
  }
  EXPECT_EQ(with, layout::feature_all);
  EXPECT_EQ(without & layout::feature_all, layout::feature_all);
}

}  // namespace
}  // namespace palpate::test
