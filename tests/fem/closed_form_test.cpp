// SPDX-License-Identifier: GPL-3.0-or-later
// Finite strain and near incompressibility against closed forms, through the minimiser that the bake uses.
#include "precompute/fem/minimiser.hpp"

#include "tests/support/block_mesh.hpp"
#include "tests/support/finite_difference.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

// Elastic energy plus a dead force on each node.
class Loaded final : public EnergyProblem {
public:
  Loaded(const ElasticEnergy& e, VectorXd force) : e_(e), force_(std::move(force)) {}
  double value(const VectorXd& x) const override { return e_.value(x) - force_.dot(x); }
  double gradient(const VectorXd& x, VectorXd& g) const override {
    g = -force_;
    return e_.gradient(x, g) - force_.dot(x);
  }
  void hessian(const VectorXd& x, HessianKind kind, BlockMatrix& m) const override { e_.hessian(x, kind, m); }
  double load(const VectorXd&) const override { return force_.norm(); }

private:
  const ElasticEnergy& e_;
  VectorXd force_;
};

// Lateral stretch b under the axial stretch a where the sides are free: dpsi/db = 0.
double lateral_stretch(const Material& m, double a) {
  double b = 1 / std::sqrt(a);
  for (int k = 0; k < 60; ++k) {
    const double residual = m.mu + m.volumetric_slope(a * b * b) * a;
    b -= residual / (m.volumetric_curvature() * 2 * a * a * b);
  }
  return b;
}

// Force of the body on the nodes of a plane (N), summed.
Vector3d face_force(const TetMesh& mesh, const VectorXd& g, int axis, double at) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (std::abs(mesh.nodes[n][axis] - at) < 1e-9) sum += g.segment<3>(3 * static_cast<Eigen::Index>(n));
  }
  return sum;
}

class Stretch : public ::testing::TestWithParam<double> {
protected:
  TetMesh mesh = test::block_mesh({0, 0.3, 1}, {0, 0.6, 1}, {0, 0.5, 1});

  VectorXd forces(const Material& material, const Eigen::Matrix3d& f) const {
    VectorXd x = test::stacked(mesh), g = VectorXd::Zero(x.size());
    for (Eigen::Index n = 0; n < x.size() / 3; ++n) x.segment<3>(3 * n) = (f * x.segment<3>(3 * n)).eval();
    ElasticEnergy(mesh, {material}).gradient(x, g);
    return g;
  }
};

TEST_P(Stretch, UniaxialStressIsTheClosedForm) {
  const Material m = Material::neo_hookean(5e3, GetParam());
  for (const double a : {0.6, 0.9, 1.3, 2.0}) {
    const double b = lateral_stretch(m, a);
    const VectorXd g = forces(m, Vector3d(b, b, a).asDiagonal());
    const double stress = m.mu * a + m.volumetric_slope(a * b * b) * b * b;
    EXPECT_NEAR(face_force(mesh, g, 2, 1.0).z(), stress, 1e-9 * 5e3) << "stretch " << a;
    EXPECT_NEAR(face_force(mesh, g, 0, 1.0).x(), 0.0, 1e-7 * 5e3) << "stretch " << a;
    // Nearly incompressible: the classical mu (a - 1/a^2).
    if (GetParam() > 0.4998) {
      EXPECT_NEAR(stress / (m.mu * (a - 1 / (a * a))), 1.0, 2e-3);
    }
  }
}

TEST_P(Stretch, SimpleShearStressIsMuTimesShear) {
  const Material m = Material::neo_hookean(5e3, GetParam());
  Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
  f(0, 2) = 0.7;
  EXPECT_NEAR(face_force(mesh, forces(m, f), 2, 1.0).x(), m.mu * 0.7, 1e-9 * 5e3);
}
INSTANTIATE_TEST_SUITE_P(Poisson, Stretch, ::testing::Values(0.0, 0.3, 0.49, 0.4999));

// Cook-type bending: a clamped block sheared at its end. A locking element answers far too stiffly near nu 0.5
// and on coarse meshes; here neither may change the deflection much.
double cook_deflection(double poisson, int cells) {
  std::vector<double> lines;
  for (int k = 0; k <= cells; ++k) lines.push_back(static_cast<double>(k) / cells);
  std::vector<double> lengths = lines;
  for (double& l : lengths) l *= 3;
  const TetMesh mesh = test::block_mesh(lengths, lines, lines);
  std::vector<char> fixed(mesh.nodes.size(), 0);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) fixed[n] = mesh.nodes[n].x() < 1e-9;
  VectorXd force = VectorXd::Zero(3 * static_cast<Eigen::Index>(mesh.nodes.size()));
  for (const auto& f : mesh.faces) {
    const Vector3d a = mesh.nodes[f[0]], b = mesh.nodes[f[1]], c = mesh.nodes[f[2]];
    if (a.x() + b.x() + c.x() < 9 - 1e-9) continue;
    for (int k = 3; k < 6; ++k) force[3 * f[k] + 2] += 1.0 * 0.5 * (b - a).cross(c - a).norm() / 3;
  }
  const ElasticEnergy energy(mesh, {Material::neo_hookean(1e3, poisson)});
  VectorXd x = test::stacked(mesh);
  const VectorXd rest = x;
  Minimiser minimiser(mesh, fixed);
  MinimiserOptions options;
  options.energy_tolerance = 1e-10;
  options.residual_tolerance = 1e-5;
  const MinimiserResult r = minimiser.minimise(Loaded(energy, force), x, options);
  EXPECT_TRUE(r.converged) << r.cause;
  double sum = 0;
  int count = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.nodes[n].x() > 3 - 1e-9) sum += (x - rest)[3 * static_cast<Eigen::Index>(n) + 2], ++count;
  }
  return sum / count;
}

TEST(Cook, DoesNotLock) {
  for (const double poisson : {0.45, 0.49, 0.4999}) {
    EXPECT_NEAR(cook_deflection(poisson, 3) / cook_deflection(poisson, 5), 1.0, 0.025) << "nu " << poisson;
  }
  // The bending stiffness changes by less than E's plane-strain factor towards incompressibility.
  EXPECT_NEAR(cook_deflection(0.4999, 3) / cook_deflection(0.45, 3), 1.0, 0.08);
}

}  // namespace
}  // namespace palpate
