// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes as tools: a fine ball against the ball, a square block against the round punch and its closed form, files that
// are turned, elements at edges.
#include "precompute/tool/mesh_tool.hpp"
#include "formats/surface/surface_io.hpp"
#include "precompute/geometry/solids.hpp"
#include "precompute/solve/pair/contact_size.hpp"
#include "tests/support/press.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;

class MeshTools : public ::testing::Test {
protected:
  tool::Tool tool_of(const Surface& surface, double edge_radius = 0) {
    ToolScene scene;
    scene.shape = ToolScene::Shape::mesh;
    scene.surface.file = folder_.path() / "tool.ply";
    scene.edge_radius = edge_radius;
    write_surface(surface, scene.surface.file);
    return tool::make_tool(scene);
  }
  // The vertex that faces downward most.
  static const tool::ToolVertex& lowest(const tool::Tool& tool) {
    return *std::min_element(tool.vertices.begin(), tool.vertices.end(),
                             [](const auto& a, const auto& b) { return a.normal.z() < b.normal.z(); });
  }
  // Straight in; with friction the contact sticks.
  PairResult press(const Body& body, const tool::Tool& tool, const tool::ToolVertex& vertex, double depth,
                   double friction = 0) {
    scene_.sampling.normal_points = 6;
    scene_.friction = friction;
    PairPath path = bake_path(scene_, depth);
    path.tangential_directions = 0;
    return solve_pair({body, tool, vertex, ContactFrame{}}, path, pair_options(scene_));
  }

  test::TemporaryFolder folder_;
  Scene scene_;
};

TEST_F(MeshTools, AFineBallAnswersAsTheBall) {
  const Body body = test::block_body(0.02, 5e3, 0.49);
  ToolScene sphere;
  sphere.radius = 0.005;
  const tool::Tool exact = tool::make_tool(sphere);
  Surface ball = geometry::geodesic_sphere(24, "ball");
  for (Vector3d& v : ball.vertices) v *= sphere.radius;
  const tool::Tool mesh = tool_of(ball);
  scene_.solver.mesh_size = 0.5;
  const PairResult a = press(body, exact, exact.vertices[0], 0.002), b = press(body, mesh, lowest(mesh), 0.002);
  ASSERT_TRUE(a.outcome.accepted) << a.outcome.cause;
  ASSERT_TRUE(b.outcome.accepted) << b.outcome.cause;
  ASSERT_EQ(a.samples.size(), b.samples.size());
  for (std::size_t k = 2; k < a.samples.size(); ++k) {  // shallower ones touch a few facets
    EXPECT_NEAR(b.samples[k].force.z() / a.samples[k].force.z(), 1, 0.01) << k;
    EXPECT_LT(b.samples[k].force.head<2>().norm(), 0.01 * a.samples[k].force.z()) << k;
  }
}

// A rigid square is stiffer than a circle of its area by 1.2 % (King 1987): 1.012 times Sneddon's 2 E* a d, from a
// depth of a tenth of the rounding of its edges on.
TEST_F(MeshTools, ASquareBlockAnswersAsItsClosedForm) {
  constexpr double side = 0.008, young = 5e3, poisson = 0.3;
  const Body body = test::block_body(0.06, young, poisson);
  const tool::Tool square = tool_of(test::box_surface({-side / 2, -side / 2, 0}, {side / 2, side / 2, side}));
  const tool::ToolVertex face = tool::mesh_vertex(square, {0, 0, 0});
  EXPECT_NEAR(face.normal.z(), -1, 1e-6);
  EXPECT_GT(face.flat_radius, 0);
  const PairResult r = press(body, square, face, 0.0002);
  ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
  const double stiffness = 1.012 * 2 * young / (1 - poisson * poisson) * side / std::sqrt(std::numbers::pi);
  for (const Sample& s : r.samples) {
    EXPECT_NEAR(s.force.z() / (stiffness * s.deflection.norm()), 1, 0.03) << s.deflection.norm();
  }
}

// The lattice stands along the axes of the file: however the tool lies in there, its face answers alike.
TEST_F(MeshTools, HoweverTheFileIsTurnedTheAnswerIsTheSame) {
  constexpr double side = 0.008;
  const Body body = test::block_body(0.03, 5e3, 0.45);
  const Surface block = test::box_surface({-side / 2, -side / 2, 0}, {side / 2, side / 2, side});
  scene_.solver.mesh_size = 0.5;
  const auto forces = [&](const Eigen::Matrix3d& turn) {
    Surface turned = block;
    for (Vector3d& v : turned.vertices) v = turn * v;
    const tool::Tool tool = tool_of(turned);
    tool::ToolVertex vertex = tool::mesh_vertex(tool, turn * Vector3d(0.0007, -0.0004, 0));
    EXPECT_LT((vertex.normal + turn.col(2)).norm(), 0.05);
    vertex.normal = -turn.col(2);
    vertex.tangent = turn.col(0);
    const PairResult r = press(body, tool, vertex, 0.0008);
    EXPECT_TRUE(r.outcome.accepted) << r.outcome.cause;
    return r.samples;
  };
  const auto straight = forces(Eigen::Matrix3d::Identity()),
             turned = forces(Eigen::AngleAxisd(0.7, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix());
  ASSERT_FALSE(straight.empty());
  ASSERT_EQ(straight.size(), turned.size());
  for (std::size_t k = 0; k < straight.size(); ++k) {
    EXPECT_LT((turned[k].force - straight[k].force).norm() / straight.back().force.norm(), 0.02) << k;
  }
}

TEST_F(MeshTools, EdgesRefineTheMeshWhereTheyTouch) {
  constexpr double side = 0.008;
  const Body body = test::block_body(0.03, 5e3, 0.49);
  const tool::Tool tool = tool_of(test::box_surface({-side / 2, -side / 2, 0}, {side / 2, side / 2, side}));
  const double edge = tool.scene.edge_radius;
  EXPECT_NEAR(edge, side / 20, 1e-9);  // the file has single precision
  const mesh::SizeField size =
      contact_size({body, tool, lowest(tool), ContactFrame{}}, 0.001, 1.0, pair_options(scene_));
  const Eigen::Isometry3d pose = tool::touching_pose(lowest(tool), ContactFrame{});
  for (const double at : {-1.0, -0.3, 0.4}) {
    EXPECT_LT(size(pose * Vector3d(side / 2, at * side / 2, 0)), 1.2 * edge);
    EXPECT_LT(size(pose * Vector3d(at * side / 2, -side / 2, 0)), 1.2 * edge);
  }
  EXPECT_GT(size(pose * Vector3d(0, 0, 0)), 2 * edge);
  EXPECT_GT(size(pose * Vector3d(0.015, 0, 0)), 10 * edge);
  // Pressed with an edge alone, the mesh is fine along it; its other edges are in the air. Twice the rounding deep:
  // at 2.5 times, round-off of the processor's kernels decides whether the ladder's first rung does (8 s) or all of it
  // (minutes).
  constexpr double depth = 0.0008;
  const tool::ToolVertex* on_edge = nullptr;
  for (const tool::ToolVertex& v : tool.vertices) {
    if (std::abs(v.normal.x()) > 0.6 && std::abs(v.normal.z() + std::abs(v.normal.x())) < 0.05) on_edge = &v;
  }
  ASSERT_NE(on_edge, nullptr);
  EXPECT_EQ(on_edge->flat_radius, 0);
  EXPECT_LT(tool::contact_radius(*on_edge, depth), 0.0015);
  const PairResult r = press(body, tool, *on_edge, depth);
  ASSERT_TRUE(r.outcome.accepted) << r.outcome.cause;
}

}  // namespace
}  // namespace palpate::solve
