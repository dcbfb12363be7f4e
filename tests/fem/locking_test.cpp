// SPDX-License-Identifier: GPL-3.0-or-later
// Near incompressibility: Cook-type bending and confined compression, coarse meshes against refined ones and against
// mixed elements, which cannot lock. The plain quadratic element, which locks, shows that these problems detect it.
#include "precompute/fem/minimiser.hpp"

#include "tests/support/block_mesh.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/loaded.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace palpate::fem::locking_test {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kYoung = 1e3;

std::vector<double> lines(double length, int cells) {
  std::vector<double> all;
  for (int k = 0; k <= cells; ++k) all.push_back(length * k / cells);
  return all;
}

struct Problem {
  mesh::TetMesh mesh;
  std::function<bool(const Vector3d&)> fixed;
  std::function<Vector3d(const Vector3d&)> traction;  // Pa, dead, on the outer faces
  Body walls;                                         // its supports
};

// Work of the load (J), a measure of the body's compliance.
double compliance(const Problem& p, const Material& material) {
  std::vector<char> fixed(p.mesh.nodes.size(), 0);
  for (std::size_t n = 0; n < p.mesh.nodes.size(); ++n) fixed[n] = p.fixed(p.mesh.nodes[n]);
  const VectorXd force =
      test::face_loads(p.mesh, [&](const Vector3d&, const Vector3d& at, const Vector3d&) { return p.traction(at); });
  const ElasticEnergy energy(p.mesh, {material});
  const solve::BedEnergy bed(p.walls, p.mesh);
  VectorXd x = test::stacked(p.mesh);
  const VectorXd rest = x;
  Minimiser minimiser(p.mesh, fixed);
  MinimiserOptions options;
  options.energy_tolerance = 1e-10;
  options.residual_tolerance = 1e-5;
  const MinimiserResult r = minimiser.minimise(test::Loaded(energy, force, &bed), x, options);
  EXPECT_TRUE(r.converged) << r.cause;
  return force.dot(x - rest);
}

// A clamped bar of 3 x 1 x 1 sheared at its end.
Problem cook(int cells) {
  return {test::block_mesh(lines(3, cells), lines(1, cells), lines(1, cells)),
          [](const Vector3d& at) { return at.x() < 1e-9; },
          [](const Vector3d& at) { return at.x() > 3 - 1e-9 ? Vector3d(0, 0, 1) : Vector3d(0, 0, 0); },
          {}};
}

// A clamped plate of 6 x 2 x 0.5, its end pushed sideways.
Problem plate(int cells, int layers) {
  return {test::block_mesh(lines(6, 3 * cells), lines(2, cells), lines(0.5, layers)),
          [](const Vector3d& at) { return at.x() < 1e-9; },
          [](const Vector3d& at) { return at.x() > 6 - 1e-9 ? Vector3d(0, 0, 0.1) : Vector3d(0, 0, 0); },
          {}};
}

// A cube in a rigid box that it slides in, pressed in the middle of its top: the rest has to rise.
Problem confined(int cells) {
  Body box;
  box.material.young = kYoung;
  box.diagonal = std::sqrt(3.0);
  for (int side = 0; side < 5; ++side) {
    SupportScene wall;
    wall.type = SupportScene::Type::slider;
    const int axis = side % 3;
    wall.point = (side < 3 ? 1e-9 : 1 - 1e-9) * Vector3d::Unit(axis);
    wall.normal = (side < 3 ? 1 : -1) * Vector3d::Unit(axis);
    box.supports.push_back(wall);
  }
  box.support_surfaces.resize(box.supports.size());
  return {test::block_mesh(lines(1, cells), lines(1, cells), lines(1, cells)), [](const Vector3d&) { return false; },
          [](const Vector3d& at) {
            if (at.z() < 1 - 1e-9) return Vector3d(0, 0, 0);
            const double x = std::sin(std::numbers::pi * at.x()), y = std::sin(std::numbers::pi * at.y());
            return Vector3d(0, 0, -0.1 * kYoung * x * x * y * y);
          },
          std::move(box)};
}

// Compliance of GetFEM's quadratic displacements with linear pressures: `tests/fem/getfem_locking.py 8`.
struct Mixed {
  double poisson, cook, confined;  // J; within 0.3 % (6 cells) and 0.1 % (10 cells)
};

class Locking : public ::testing::TestWithParam<Mixed> {
protected:
  Material soft = Material::neo_hookean(kYoung, GetParam().poisson);
};

TEST_P(Locking, CookTypeBendingIsThatOfRefinedAndOfMixedElements) {
  const double fine = compliance(cook(6), soft);
  EXPECT_NEAR(compliance(cook(3), soft) / fine, 1, 0.01);
  EXPECT_NEAR(fine / GetParam().cook, 1, 0.015);
}

// One element over the thickness: its mean dilatation alone would let it bend a third too far.
TEST_P(Locking, APlateOfOneLayerBendsLikeARefinedOne) {
  EXPECT_NEAR(compliance(plate(2, 1), soft) / compliance(plate(4, 2), soft), 1, 0.05);
}

// Three elements under the whole of a load are few, and a pressure that is constant in each errs on the soft side; that
// halves with the elements.
TEST_P(Locking, ConfinedCompressionClosesOnThatOfMixedElements) {
  const double coarse = compliance(confined(3), soft) / GetParam().confined - 1;
  const double fine = compliance(confined(6), soft) / GetParam().confined - 1;
  EXPECT_LT(std::abs(coarse), 0.16);
  EXPECT_LT(std::abs(fine), 0.08);
  EXPECT_LT(std::abs(fine), 0.55 * std::abs(coarse));
}

// Pressed evenly in a box that it slides in: one stretch, in closed form.
TEST_P(Locking, OedometricStressIsTheClosedForm) {
  const mesh::TetMesh mesh = test::block_mesh({0, 0.3, 1}, {0, 0.6, 1}, {0, 0.5, 1});
  const ElasticEnergy energy(mesh, {soft});
  for (const double a : {0.98, 0.9}) {
    VectorXd x = test::stacked(mesh), g = VectorXd::Zero(x.size());
    for (Eigen::Index n = 0; n < x.size() / 3; ++n) x[3 * n + 2] *= a;
    energy.gradient(x, g);
    double force = 0;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      if (mesh.nodes[n].z() > 1 - 1e-9) force += g[3 * static_cast<Eigen::Index>(n) + 2];
    }
    // mu (a - 1) + bulk (a - 1), the moduli from E and nu: the oedometric modulus times the shortening.
    const double nu = GetParam().poisson;
    EXPECT_NEAR(force / (kYoung * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) * (a - 1)), 1, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Poisson, Locking,
                         ::testing::Values(Mixed{0.45, 0.112193, 0.355810}, Mixed{0.49, 0.111211, 0.217320},
                                           Mixed{0.499, 0.110963, 0.182181}, Mixed{0.4999, 0.110938, 0.178579}));

// Refined, both elements close on one value, the plain one from below; coarse and nearly incompressible it locks.
TEST(PlainElement, ClosesOnTheSameValueAndLocks) {
  for (const double poisson : {0.45, 0.4999}) {
    const Material soft = Material::neo_hookean(kYoung, poisson);
    const double fine = compliance(cook(6), soft), coarse = compliance(cook(3), soft.plain());
    const double finer = compliance(cook(6), soft.plain());
    EXPECT_LT(finer, fine);
    EXPECT_LT(fine - finer, 0.6 * (fine - coarse));
    if (poisson > 0.499) {
      EXPECT_LT(coarse / fine, 0.8);
    }
  }
  const Material soft = Material::neo_hookean(kYoung, 0.4999);
  EXPECT_LT(compliance(confined(3), soft.plain()) / compliance(confined(6), soft), 0.8);
}

}  // namespace
}  // namespace palpate::fem::locking_test
