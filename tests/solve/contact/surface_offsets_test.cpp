// SPDX-License-Identifier: GPL-3.0-or-later
// Offsets from flat facets to the round surface, and what they are worth.
#include "precompute/solve/contact/surface_offsets.hpp"

#include "precompute/geometry/solids.hpp"
#include "precompute/mesh/surface/remesh.hpp"
#include "precompute/mesh/volume/volume_mesh.hpp"
#include "precompute/solve/pair/contact_size.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "precompute/surface/support_rim.hpp"

#include <gtest/gtest.h>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;

constexpr double kBall = 0.006;

// A ball whose lower half is held.
Body ball_body() {
  const Surface ball = geometry::ellipsoid({0, 0, 0}, Vector3d::Constant(kBall), 0.0004, "ball");
  Body body;
  body.query = std::make_shared<const geometry::SurfaceQuery>(ball);
  body.base_size = 0.001;
  body.base = mesh::remesh_uniform(ball, body.base_size);
  body.diagonal = 2 * kBall * std::sqrt(3.0);
  body.material.young = 5000;
  body.material.poisson = 0.45;
  SupportScene lower;
  lower.point = Vector3d::Zero();
  body.supports = {lower};
  body.support_rim = surface::support_rim(body);
  return body;
}

ContactFrame top(const Body& body) {
  ContactFrame frame;
  frame.origin = body.query->closest({0, 0, kBall}).point;
  return frame;
}

TEST(SurfaceOffsets, CarryNodesOfFacesToTheSurface) {
  const Body body = ball_body();
  const mesh::VolumeMeshResult made =
      mesh::mesh_volume(body, [](const Vector3d&) { return 0.4 * kBall; }, {top(body).origin}, {});
  ASSERT_TRUE(made.usable) << made.cause;
  const std::vector<Vector3d> offsets = surface_offsets(made.mesh, *body.query);
  double largest = 0, outward = 0;
  for (const auto& face : made.mesh.faces) {
    for (int k = 0; k < 6; ++k) {
      const Vector3d &node = made.mesh.nodes[face[k]], &offset = offsets[face[k]];
      EXPECT_LT(body.query->closest(node + offset).distance, 1e-9);
      largest = std::max(largest, offset.norm());
      // Corners lie outside, middles of edges inside.
      if (k < 3) outward = std::max(outward, -offset.dot(node.normalized()));
    }
  }
  // Edges of L would lie L^2 / (8 R) below their ends, and facets of that in the mean two thirds as far.
  EXPECT_GT(outward, 0.3 * 0.4 * 0.4 * kBall / 12);
  EXPECT_GT(largest, 0.3 * 0.4 * 0.4 * kBall / 8);
  EXPECT_LT(largest, 4 * 0.4 * 0.4 * kBall / 8);
}

TEST(SurfaceOffsets, CoarseFacetsOfABallAnswerAsFineOnes) {
  const Body body = ball_body();
  ToolScene sphere;
  sphere.radius = kBall / 2;
  const tool::Tool tool = tool::make_tool(sphere);
  PairPath path;
  path.normal_depths = {0.0003, 0.0006, 0.0012};
  std::vector<double> forces[2];
  for (const int fine : {0, 1}) {
    PairOptions options;
    options.refine = fine == 0 ? 1.4 : 0.6;
    const PairResult r = solve_pair({body, tool, tool.vertices[0], top(body)}, path, options);
    ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
    for (const Sample& s : r.samples) forces[fine].push_back(s.force.norm());
  }
  for (std::size_t k = 0; k < forces[0].size(); ++k) {
    EXPECT_NEAR(forces[0][k] / forces[1][k], 1, 0.02) << path.normal_depths[k];
  }
}

}  // namespace
}  // namespace palpate::solve
