// SPDX-License-Identifier: GPL-3.0-or-later
// The inside of a body: fibres along curves, and regions from labels.
#include "precompute/geometry/solids.hpp"
#include "precompute/mesh/volume/quadratic.hpp"
#include "precompute/solve/contact/body_energy.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/label_ball.hpp"
#include "tests/support/laws.hpp"
#include "tests/support/press.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

Curves circle(int count, double radius) {
  Curves c;
  for (int k = 0; k < count; ++k) {
    const double a = 2 * std::numbers::pi * k / count;
    c.points.emplace_back(radius * std::cos(a), radius * std::sin(a), 0);
    c.pieces.push_back({k, (k + 1) % count});
  }
  return c;
}

// A flat ring between two radii, `count` cells round, each of six tetrahedra.
mesh::TetMesh ring(int count, double inner, double outer, double height) {
  mesh::LinearTets linear;
  for (int k = 0; k < count; ++k) {
    const double a = 2 * std::numbers::pi * k / count;
    for (const double z : {0.0, height}) {
      for (const double r : {inner, outer}) linear.points.emplace_back(r * std::cos(a), r * std::sin(a), z);
    }
  }
  for (int k = 0; k < count; ++k) {
    std::array<int, 3> axes{0, 1, 2};
    do {
      std::array<int, 3> at{0, 0, 0};
      const auto id = [&] { return 4 * ((k + at[2]) % count) + 2 * at[1] + at[0]; };
      std::array<std::int32_t, 4> t{id(), 0, 0, 0};
      for (std::size_t s = 0; s < 3; ++s) {
        ++at[std::size_t(axes[s])];
        t[s + 1] = id();
      }
      const auto& p = linear.points;
      if ((p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).dot(p[t[3]] - p[t[0]]) < 0) std::swap(t[2], t[3]);
      linear.tets.push_back(t);
    } while (std::next_permutation(axes.begin(), axes.end()));
  }
  linear.regions.assign(linear.tets.size(), 0);
  return mesh::make_quadratic(linear);
}

MaterialScene fibrous(const Vector3d& direction) {
  MaterialScene m;
  m.law = MaterialScene::Law::holzapfel;
  m.young = 5e3;
  m.poisson = 0.45;
  m.k1 = 5e3;
  m.k2 = 2;
  m.fibre = direction;
  return m;
}

// Fibres round a ring that is stretched along x alone: at an angle t to x they are longer by l^2 sin^2 t + cos^2 t.
TEST(Fibres, AlongACircleHaveTheEnergyOfTheirOwnStretches) {
  constexpr double stretch = 1.3;
  Body body;
  body.material = fibrous({0, 0, 1});  // across the stretch: no energy of fibres
  body.diagonal = 0.1;
  double error = 1;
  for (const int count : {24, 48}) {
    const mesh::TetMesh mesh = ring(count, 0.018, 0.022, 0.004);
    const VectorXd rest = test::stacked(mesh);
    VectorXd x = rest;
    for (Eigen::Index k = 0; k < x.size(); k += 3) x[k] *= stretch;
    body.fibres = nullptr;
    const double matrix = BodyEnergy(body, mesh).value(x);
    body.fibres = std::make_shared<const geometry::CurveQuery>(circle(64, 0.02));
    const double both = BodyEnergy(body, mesh).value(x);
    double mean = 0;
    constexpr int kSteps = 360;
    for (int k = 0; k < kSteps; ++k) {
      const double along = std::pow(std::sin(2 * std::numbers::pi * k / kSteps), 2) * (stretch * stretch - 1);
      mean += body.material.k1 / (2 * body.material.k2) * std::expm1(body.material.k2 * along * along) / kSteps;
    }
    double volume = 0;
    for (const auto& t : mesh.tets) {
      const auto& p = mesh.nodes;
      volume += (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).dot(p[t[3]] - p[t[0]]) / 6;
    }
    const double now = std::abs((both - matrix) / (mean * volume) - 1);
    EXPECT_LT(now, error / 3);  // second order of the elements' size
    error = now;
  }
  EXPECT_LT(error, 0.005);
}

// From the scene's files to forces: a straight centreline is a direction.
TEST(Fibres, AlongAStraightCentrelineAnswerAsThoseOfOneDirection) {
  const test::TemporaryFolder folder;
  Scene scene;
  scene.body.surfaces.emplace_back();
  scene.sampling.normal_points = 4;
  const Surface block = test::box_surface({-0.02, -0.02, -0.02}, {0.02, 0.02, 0}, 4);
  const auto forces = [&] {
    const Body body = prepare_body(scene, block);
    PairOptions options = pair_options(scene);
    options.mesh_size = 0.7;
    options.growth = 1;
    options.max_size = 0.01;
    const PairResult r = test::press(body, ToolScene{}, bake_path(scene, 0.002), options);
    EXPECT_TRUE(r.outcome.accepted) << r.outcome.cause;
    std::vector<Vector3d> all;
    for (const Sample& s : r.samples) all.push_back(s.force);
    return all;
  };
  scene.material = fibrous({1, 0, 0});
  const std::vector<Vector3d> constant = forces();
  scene.material = fibrous({0, 0, 0});
  scene.material.centreline.file = folder.write("line.csv", "-0.05,0.01,-0.01\n0,0.01,-0.01\n0.03,0.01,-0.01\n");
  const std::vector<Vector3d> straight = forces();
  scene.material.centreline.file =
      folder.write("across.obj", "v 0 -50 0\nv 0 50 0\nv 50 0 0\no wrong\nl 1 3\no right\nl 1 2\n");
  scene.material.centreline.meshes = {"right"};
  scene.material.centreline.unit = 0.001;
  const std::vector<Vector3d> across = forces();
  ASSERT_EQ(straight.size(), constant.size());
  ASSERT_FALSE(constant.empty());
  for (std::size_t k = 0; k < constant.size(); ++k) EXPECT_EQ(straight[k], constant[k]);
  // Turned by a right angle about the push: another mesh of the same block would answer alike.
  EXPECT_NEAR(across.back().z() / constant.back().z(), 1, 0.03);
  EXPECT_NE(across.back(), constant.back());
}

// A stiff ball under the tip, as voxels and by its measures; the coarse meshes of the two differ by a percent or two.
TEST(Labels, ABallOfVoxelsAnswersAsTheBall) {
  const test::TemporaryFolder folder;
  constexpr double radius = 0.006;
  const Vector3d centre(0, 0, -0.009);
  Scene scene;
  scene.body.surfaces.emplace_back();
  scene.sampling.normal_points = 4;
  RegionScene& region = scene.regions.emplace_back();
  region.name = "ball";
  region.material.young = 20 * scene.material.young;
  const Surface block = test::box_surface({-0.03, -0.03, -0.03}, {0.03, 0.03, 0}, 4);
  const auto force = [&] {
    const Body body = prepare_body(scene, block);
    PairOptions options = pair_options(scene);
    options.growth = 1;
    options.max_size = 0.015;
    const PairResult r = test::press(body, ToolScene{}, bake_path(scene, 0.0025), options);
    EXPECT_TRUE(r.outcome.accepted) << r.outcome.cause;
    return r.samples.empty() ? 0.0 : r.samples.back().force.z();
  };
  region.shape = RegionScene::Shape::ellipsoid;
  region.centre = centre;
  region.radii.setConstant(radius);
  const double ball = force();
  region.shape = RegionScene::Shape::labels;
  region.labels.values = {3};
  for (const auto& [voxels, tolerance] : {std::pair{3.0, 0.05}, std::pair{8.0, 0.03}}) {
    region.labels.file =
        folder.write("ball.nrrd", test::nrrd(test::label_ball(centre, radius, radius / voxels), 3));
    const double found = force();
    EXPECT_NEAR(found / ball, 1, tolerance) << voxels;
    RecordProperty("voxels_" + std::to_string(int(voxels)), std::to_string(found / ball));
  }
  scene.regions.clear();
  EXPECT_LT(force(), 0.8 * ball);  // it is felt at all
}

}  // namespace
}  // namespace palpate::solve
