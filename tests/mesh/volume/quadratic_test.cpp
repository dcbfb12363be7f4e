// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of linear tetrahedra, regions, and the quadratic numbering.
#include "precompute/mesh/volume/quadratic.hpp"

#include "precompute/mesh/volume/tet_checks.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;

// A corner of a cube inside a bigger one: point 4 is unused, the second tetrahedron shares a face.
LinearTets two_tets() {
  LinearTets m;
  m.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {9, 9, 9}, {1, 1, 1}};
  m.tets = {{0, 1, 2, 3}, {1, 3, 2, 5}};
  m.regions = {0, 0};
  return m;
}

const SurfaceTriangles kOuter = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 5}, {2, 3, 5}, {3, 1, 5}};

TEST(TetChecks, NegativeIsTurnedFlatIsRefused) {
  LinearTets m = two_tets();
  std::swap(m.tets[0][0], m.tets[0][1]);
  EXPECT_EQ(orient_tets(m), "");
  for (const auto& t : m.tets) {
    const Vector3d& a = m.points[t[0]];
    EXPECT_GT((m.points[t[1]] - a).cross(m.points[t[2]] - a).dot(m.points[t[3]] - a), 0);
  }
  m.points[5] = {0.3, 0.3, 0.4};
  EXPECT_NE(orient_tets(m), "");
  m = two_tets();
  m.tets[1][2] = 17;
  EXPECT_NE(orient_tets(m), "");
  m.tets.clear();
  EXPECT_EQ(orient_tets(m), "no tetrahedra");
}

TEST(TetChecks, BoundaryMustBeTheSurface) {
  LinearTets m = two_tets();
  ASSERT_EQ(orient_tets(m), "");
  EXPECT_EQ(find_regions(m, kOuter, {}), "");
  EXPECT_EQ(m.regions, (std::vector<std::int32_t>{0, 0}));
  SurfaceTriangles wrong = kOuter;
  wrong.pop_back();
  EXPECT_NE(find_regions(m, wrong, {}), "");
  wrong = kOuter;
  std::swap(wrong[2][0], wrong[2][1]);
  EXPECT_NE(find_regions(m, wrong, {}), "") << "inside out";
  wrong = kOuter;
  wrong.push_back({0, 1, 5});
  EXPECT_NE(find_regions(m, wrong, {}), "") << "a triangle that is not there";
}

TEST(TetChecks, RegionInsideIsFlooded) {
  // A tetrahedron with its centre: the four small ones round it; one more layer outside.
  LinearTets m;
  m.points = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}, {0, 0, 0}};
  for (int k = 0; k < 4; ++k) m.points.push_back(-3 * m.points[k]);
  m.tets = {{0, 1, 2, 4}, {0, 1, 3, 4}, {0, 2, 3, 4}, {1, 2, 3, 4}};
  // Point 5 + k lies beyond the face opposite to corner k.
  m.tets.push_back({1, 2, 3, 5});
  m.tets.push_back({0, 2, 3, 6});
  m.tets.push_back({0, 1, 3, 7});
  m.tets.push_back({0, 1, 2, 8});
  ASSERT_EQ(orient_tets(m), "");
  SurfaceTriangles inner, outer;
  for (const auto& [a, b, c, apex] : {std::array{1, 2, 3, 5}, {0, 2, 3, 6}, {0, 1, 3, 7}, {0, 1, 2, 8}}) {
    const Vector3d out = (m.points[b] - m.points[a]).cross(m.points[c] - m.points[a]);
    const bool outward = out.dot(m.points[a]) > 0;
    inner.push_back(outward ? std::array{a, b, c} : std::array{a, c, b});
    const auto& t = inner.back();
    for (int k = 0; k < 3; ++k) outer.push_back({t[k], t[(k + 1) % 3], apex});
  }
  EXPECT_EQ(find_regions(m, outer, {inner}), "");
  EXPECT_EQ(m.regions, (std::vector<std::int32_t>{1, 1, 1, 1, 0, 0, 0, 0}));
  const std::vector<double> volumes = region_volumes(m, 1);
  EXPECT_NEAR(volumes[1], 8.0 / 3, 1e-12);
  // The same walls, the inner one facing inward: a cavity, whose filling and centre point go.
  LinearTets hollow = m;
  SurfaceTriangles both = outer;
  for (const auto& t : inner) both.push_back({t[0], t[2], t[1]});
  EXPECT_EQ(find_regions(hollow, both, {}), "");
  EXPECT_EQ(hollow.tets.size(), 4U);
  EXPECT_EQ(hollow.regions, (std::vector<std::int32_t>{0, 0, 0, 0}));
  EXPECT_EQ(hollow.points.size(), 8U);
  EXPECT_NEAR(region_volumes(hollow, 0)[0], volumes[0], 1e-12);
  SurfaceTriangles missing = inner;
  missing[0] = {0, 1, 5};
  EXPECT_NE(find_regions(m, outer, {missing}), "");
}

TEST(TetChecks, AnglesOfTheCornerAndTheRegularTetrahedron) {
  LinearTets corner;
  corner.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  corner.tets = {{0, 1, 2, 3}};
  EXPECT_NEAR(min_dihedral(corner), std::acos(1 / std::sqrt(3.0)) * 180 / std::numbers::pi, 1e-9);
  LinearTets regular;
  regular.points = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
  regular.tets = {{0, 1, 2, 3}};
  ASSERT_EQ(orient_tets(regular), "");
  EXPECT_NEAR(min_dihedral(regular), std::acos(1.0 / 3) * 180 / std::numbers::pi, 1e-9);
}

TEST(Quadratic, NodesAreMiddlesAndFacesPointOut) {
  LinearTets m = two_tets();
  ASSERT_EQ(orient_tets(m), "");
  const TetMesh q = make_quadratic(m);
  EXPECT_EQ(q.corner_count, 5);
  EXPECT_EQ(q.nodes.size(), 5u + 9u);
  ASSERT_EQ(q.tets.size(), 2u);
  constexpr int edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  for (const auto& t : q.tets) {
    for (int k = 0; k < 6; ++k) {
      EXPECT_EQ(q.nodes[t[4 + k]], (q.nodes[t[edges[k][0]]] + q.nodes[t[edges[k][1]]]) / 2);
      EXPECT_GE(t[4 + k], q.corner_count);
    }
  }
  ASSERT_EQ(q.faces.size(), 6u);
  double six = 0;
  for (const auto& f : q.faces) {
    six += q.nodes[f[0]].dot(q.nodes[f[1]].cross(q.nodes[f[2]]));
    for (int k = 0; k < 3; ++k) EXPECT_EQ(q.nodes[f[3 + k]], (q.nodes[f[k]] + q.nodes[f[(k + 1) % 3]]) / 2);
  }
  EXPECT_NEAR(six / 6, 1.0 / 6 + 1.0 / 3, 1e-12);
}

}  // namespace
}  // namespace palpate::mesh
