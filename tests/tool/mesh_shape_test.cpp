// SPDX-License-Identifier: GPL-3.0-or-later
// Signed distance of meshes: exact away from the surface, its own derivatives at it, sharpness as it is.
#include "precompute/tool/mesh_shape.hpp"

#include "formats/io/error.hpp"
#include "formats/surface/surface_io.hpp"
#include "precompute/geometry/solids.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

namespace palpate::tool {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Surface ball(double radius, int frequency) {
  Surface s = geometry::geodesic_sphere(frequency, "ball");
  for (Vector3d& v : s.vertices) v *= radius;
  return s;
}

TEST(MeshShape, GradientAndHessianAreThoseOfTheValue) {
  const MeshShape shape(test::box_surface({-1, -0.6, -0.8}, {1, 0.6, 0.8}), 0.15);
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> coordinate(-1.2, 1.2);
  int checked = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vector3d p(coordinate(engine), coordinate(engine), coordinate(engine));
    const DistanceSample s = shape.distance(p);
    if (std::abs(s.value) > 0.09) continue;
    ++checked;
    constexpr double step = 1e-6;
    Vector3d slope;
    Matrix3d bend;
    for (int i = 0; i < 3; ++i) {
      const DistanceSample up = shape.distance(p + step * Vector3d::Unit(i));
      const DistanceSample down = shape.distance(p - step * Vector3d::Unit(i));
      slope[i] = (up.value - down.value) / (2 * step);
      bend.col(i) = (up.gradient - down.gradient) / (2 * step);
    }
    ASSERT_LT((slope - s.gradient).norm(), 1e-8) << p.transpose();
    ASSERT_LT((bend - s.hessian).norm(), 1e-6) << p.transpose();
    EXPECT_LT(s.gradient.norm(), 1 + 1e-9);
  }
  EXPECT_GT(checked, 1000);
}

TEST(MeshShape, FlatFacesAndFarPlacesAreExact) {
  const MeshShape shape(test::box_surface({-1, -1, -1}, {1, 1, 1}), 0.1);
  for (const double off : {-0.14, -0.02, 0.0, 0.07, 0.14}) {
    const DistanceSample s = shape.distance({0.2, 1 + off, -0.3});
    EXPECT_NEAR(s.value, off, 1e-12);
    EXPECT_LT((s.gradient - Vector3d::UnitY()).norm(), 1e-10);
    EXPECT_LT(s.hessian.norm(), 1e-8);
  }
  EXPECT_NEAR(shape.distance({3, 3, 1}).value, std::sqrt(8.0), 1e-12);
  EXPECT_NEAR(shape.distance({0.1, 0, 0}).value, -0.9, 1e-12);
  // A right-angled edge steps back about as one rounded by half that radius: by 0.41 of it along the diagonal.
  const Vector3d diagonal = Vector3d(1, 1, 0).normalized();
  double low = -0.2, high = 0.2;
  for (int k = 0; k < 40; ++k) {
    const double middle = (low + high) / 2;
    (shape.distance(Vector3d(1, 1, 0.03) + middle * diagonal).value < 0 ? low : high) = middle;
  }
  EXPECT_NEAR(low / 0.05, -0.41, 0.1);
  // The face is flat up to about the rounding from the edge.
  EXPECT_NEAR(shape.distance({0.9, 1, 0.03}).value, 0, 1e-3 * 0.1);
  EXPECT_GT(shape.distance({0.97, 1, 0.03}).value, 1e-4);
}

TEST(MeshShape, LowerBoundsAreBelowTheDistanceAndNotFarBelow) {
  const MeshShape shape(ball(1, 12), 0.1);
  std::mt19937 engine(9);
  std::uniform_real_distribution<double> coordinate(-3, 3);
  for (int k = 0; k < 3000; ++k) {
    const Vector3d p(coordinate(engine), coordinate(engine), coordinate(engine));
    const double bound = shape.lower_bound(p), value = shape.distance(p).value;
    ASSERT_LE(bound, value + 1e-12) << p.transpose();
    if (std::abs(value) < 0.3) {
      EXPECT_GT(bound, value - 0.3);
    }
    if (value > 0.7) {
      EXPECT_GT(bound, 0.1);
    }
  }
}

TEST(MeshShape, CurvatureOfABallInItsHessian) {
  constexpr double radius = 0.005, rounding = radius / 5;
  const MeshShape shape(ball(radius, 30), rounding);
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  double worst = 0;
  for (int k = 0; k < 300; ++k) {
    const Vector3d out = Vector3d(normal(engine), normal(engine), normal(engine)).normalized();
    const DistanceSample s = shape.distance(radius * out);
    EXPECT_NEAR(s.value, rounding * rounding / (12 * radius), 4e-4 * radius);
    EXPECT_LT((s.normal() - out).norm(), 0.02);
    worst = std::max(worst, (radius * s.hessian - (Matrix3d::Identity() - out * out.transpose())).norm());
  }
  EXPECT_LT(worst, 0.35);  // of single places; facets are a thirtieth of the radius wide
}

TEST(MeshTool, SharpnessOfABallAndOfACube) {
  const test::TemporaryFolder folder;
  ToolScene scene;
  scene.shape = ToolScene::Shape::mesh;
  scene.surface.file = folder.path() / "tool.ply";
  constexpr double radius = 0.005;
  write_surface(ball(radius, 20), scene.surface.file);
  const Tool round = make_tool(scene);
  EXPECT_TRUE(round.edges.empty());
  for (const ToolVertex& v : round.vertices) {
    EXPECT_NEAR(round.shape->distance(v.point).value, 0, 1e-9);
    EXPECT_NEAR(v.normal.norm(), 1, 1e-12);
    EXPECT_NEAR(v.normal.dot(v.tangent), 0, 1e-12);
    EXPECT_EQ(v.flat_radius, 0);
    EXPECT_NEAR(v.curvature_radius / radius, 1, 0.25);
    for (const double a : {0.4 * radius, 0.7 * radius}) {  // Sneddon's depth for a ball, not its parabola
      EXPECT_NEAR(contact_radius(v, a / 2 * std::log((radius + a) / (radius - a))) / a, 1, 0.08);
    }
  }
  write_surface(test::box_surface({-0.005, -0.005, -0.005}, {0.005, 0.005, 0.005}, 2), scene.surface.file);
  const Tool cube = make_tool(scene);
  EXPECT_FALSE(cube.edges.empty());
  const double rounding = cube.scene.edge_radius;
  int faces = 0, others = 0;
  for (const ToolVertex& v : cube.vertices) {
    EXPECT_NEAR(cube.shape->distance(v.point).value, 0, 1e-9);
    if (v.normal.cwiseAbs().maxCoeff() > 0.9999) {
      ++faces;
      EXPECT_GT(v.flat_radius, 0.002);
    } else {
      ++others;
      EXPECT_EQ(v.flat_radius, 0);
      EXPECT_LT(v.curvature_radius, 3 * rounding);
      // The radius at a wedge of 45 degrees is 2/pi of the depth, and no sharper than the rounding.
      EXPECT_LT(contact_radius(v, 0.001), 0.0013);
    }
  }
  EXPECT_GT(faces, 0);
  EXPECT_GT(others, 7);
  for (const double rounding_radius : {1e-6, 0.1}) {  // too fine a lattice; wider than the tool
    scene.edge_radius = rounding_radius;
    EXPECT_THROW(make_tool(scene), Error) << rounding_radius;
  }
}

TEST(MeshTool, OpenOrInsideOutIsRefused) {
  const test::TemporaryFolder folder;
  ToolScene scene;
  scene.shape = ToolScene::Shape::mesh;
  scene.surface.file = folder.path() / "tool.ply";
  Surface s = test::box_surface({-0.005, -0.005, -0.005}, {0.005, 0.005, 0.005});
  for (auto& t : s.triangles) std::swap(t[1], t[2]);
  const auto cause = [&] {
    write_surface(s, scene.surface.file);
    try {
      make_tool(scene);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_input);
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_NE(cause().find("face inward"), std::string::npos) << cause();
  s.triangles.pop_back();
  EXPECT_NE(cause().find("3 open edges"), std::string::npos) << cause();
}

}  // namespace
}  // namespace palpate::tool
