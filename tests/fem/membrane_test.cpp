// SPDX-License-Identifier: GPL-3.0-or-later
// The capsule's membrane: derivatives through large and flat states, closed forms of stretch, rigid motion.
#include "precompute/fem/membrane.hpp"

#include "precompute/algebra/spectrum.hpp"
#include "tests/fem/deformed_block.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <vector>

namespace palpate::fem {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

mesh::TetMesh cube(const std::vector<double>& cuts) { return test::block_mesh(cuts, cuts, cuts); }

class Sheet final : public EnergyProblem {
public:
  explicit Sheet(const mesh::TetMesh& mesh, double young = 3e4, double thickness = 1e-3)
      : membrane_(mesh, std::vector<char>(mesh.nodes.size(), 0), {thickness, young}) {}
  double value(const VectorXd& x) const override { return membrane_.value(x); }
  double gradient(const VectorXd& x, VectorXd& g) const override {
    g.setZero();
    return membrane_.gradient(x, g);
  }
  void hessian(const VectorXd& x, HessianKind kind, BlockMatrix& m) const override { membrane_.hessian(x, kind, m); }
  double load(const VectorXd&) const override { return 1; }

private:
  MembraneEnergy membrane_;
};

TEST(Membrane, DerivativesAgreeWithDifferences) {
  const mesh::TetMesh mesh = cube({0, 0.45, 1});
  const Sheet sheet(mesh);
  std::mt19937 random(3);
  for (const double amplitude : {0.0, 0.02, 0.1}) {
    for (const double squeeze : {1.0, 0.4, 1.8}) {
      const Vector3d stretch(squeeze, 1 / std::sqrt(squeeze), 1);
      const VectorXd x = test::shaken(test::mapped(mesh, stretch.asDiagonal()), amplitude, random);
      if (amplitude > 0 || squeeze != 1) {
        EXPECT_LT(test::gradient_error(sheet, x, 1e-6), 1e-6);
      }
      EXPECT_LT(test::hessian_error(sheet, mesh, x, 1e-6), 1e-6);
    }
  }
}

// Faces nearly without area, however they got there, and a body inside out.
TEST(Membrane, DerivativesAgreeWithDifferencesAlsoWhereFacesDegenerate) {
  const mesh::TetMesh mesh = cube({0, 0.45, 1});
  const Sheet sheet(mesh);
  std::mt19937 random(3);
  for (const Vector3d& stretch : {Vector3d(1, 1, 0.05), Vector3d(1, 0.05, 0.05), Vector3d(0.05, 3, 1),
                                  Vector3d(0.05, 0.05, 0.05), Vector3d(1, 0.9, -1), Vector3d(1, 0.9, -0.05)}) {
    const VectorXd x = test::shaken(test::mapped(mesh, stretch.asDiagonal()), 0.001, random);
    EXPECT_LT(test::gradient_error(sheet, x, 1e-7), 1e-6) << "stretch " << stretch.transpose();
    EXPECT_LT(test::hessian_error(sheet, mesh, x, 1e-7), 1e-6) << "stretch " << stretch.transpose();
  }
}

// A closed block has six unit faces: the two across z have the stretches of x and y, and so on.
TEST(Membrane, EnergyOfAStretchIsTheClosedForm) {
  const mesh::TetMesh mesh = cube({0, 0.45, 1});
  const double young = 3e4, thickness = 1e-3;
  const Sheet sheet(mesh, young, thickness);
  const Vector3d s(1.3, 0.8, 1.1);
  const auto density = [&](double a, double b) { return a * a + b * b + 1 / (a * a * b * b) - 3; };
  const double expected =
      young / 6 * thickness * 2 * (density(s.x(), s.y()) + density(s.y(), s.z()) + density(s.z(), s.x()));
  EXPECT_NEAR(sheet.value(test::mapped(mesh, s.asDiagonal())) / expected, 1, 1e-10);
}

TEST(Membrane, RigidMotionCostsNothing) {
  const mesh::TetMesh mesh = cube({0, 0.45, 1});
  const Sheet sheet(mesh);
  const VectorXd x = test::mapped(mesh, Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix());
  VectorXd g(x.size());
  EXPECT_NEAR(sheet.gradient(x, g), 0, 1e-12);
  EXPECT_LT(g.cwiseAbs().maxCoeff(), 1e-10);
}

// A capsule lies round an organ: the walls of its cavities have none.
TEST(Membrane, CavitiesHaveNone) {
  const mesh::TetMesh whole = cube({0, 1, 2, 3});
  mesh::TetMesh hollow = whole;
  hollow.tets.clear();
  for (const auto& t : whole.tets) {
    const Vector3d middle = (whole.nodes[t[0]] + whole.nodes[t[1]] + whole.nodes[t[2]] + whole.nodes[t[3]]) / 4;
    if ((middle - Vector3d(1.5, 1.5, 1.5)).cwiseAbs().maxCoeff() > 0.5) hollow.tets.push_back(t);
  }
  hollow.regions.assign(hollow.tets.size(), 0);
  // Every face of the middle cell, seen from the tetrahedra round it.
  std::map<std::array<std::int32_t, 3>, std::array<std::int32_t, 6>> once;
  constexpr int kFaces[4][6] = {{0, 2, 1, 6, 5, 4}, {0, 1, 3, 4, 8, 7}, {1, 2, 3, 5, 9, 8}, {2, 0, 3, 6, 7, 9}};
  for (const auto& t : hollow.tets) {
    for (const auto& f : kFaces) {
      std::array<std::int32_t, 6> face{};
      for (std::size_t k = 0; k < 6; ++k) face[k] = t[std::size_t(f[k])];
      std::array<std::int32_t, 3> key{face[0], face[1], face[2]};
      std::sort(key.begin(), key.end());
      if (!once.try_emplace(key, face).second) once.erase(key);
    }
  }
  hollow.faces.clear();
  for (const auto& [key, face] : once) hollow.faces.push_back(face);
  ASSERT_EQ(hollow.faces.size(), whole.faces.size() + 12);
  const Eigen::Matrix3d stretch = Vector3d(1.2, 0.9, 1.1).asDiagonal();
  EXPECT_NEAR(Sheet(hollow).value(test::mapped(hollow, stretch)) / Sheet(whole).value(test::mapped(whole, stretch)), 1,
              1e-12);
}

// A face without area is refused by an infinite energy, not by a NaN.
TEST(Membrane, CollapsedFaceIsInfinite) {
  const mesh::TetMesh mesh = cube({0, 1});
  const Sheet sheet(mesh);
  VectorXd x = test::mapped(mesh, Eigen::Vector3d(0, 1, 1).asDiagonal());
  EXPECT_EQ(sheet.value(x), HUGE_VAL);
  VectorXd g(x.size());
  EXPECT_EQ(sheet.gradient(x, g), HUGE_VAL);
}

// The convex Hessian has a Cholesky factor where the exact one has none: under compression.
TEST(Membrane, ConvexHessianIsNotIndefinite) {
  const mesh::TetMesh mesh = cube({0, 1});
  const Sheet sheet(mesh);
  const VectorXd x = test::mapped(mesh, Eigen::Vector3d(0.7, 0.7, 0.7).asDiagonal());
  for (const HessianKind kind : {HessianKind::exact, HessianKind::convex}) {
    BlockMatrix matrix(mesh, std::vector<char>(mesh.nodes.size(), 0));
    matrix.set_zero();
    sheet.hessian(x, kind, matrix);
    const Eigen::MatrixXd lower = matrix.matrix();
    const Eigen::VectorXd values = algebra::spectrum(lower).values;
    const double least = values.minCoeff(), most = values.maxCoeff();
    if (kind == HessianKind::convex) {
      EXPECT_GT(least, -1e-9 * most);
    } else {
      EXPECT_LT(least, -1e-3 * most);
    }
  }
}

}  // namespace
}  // namespace palpate::fem
