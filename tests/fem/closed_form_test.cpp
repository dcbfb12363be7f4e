// SPDX-License-Identifier: GPL-3.0-or-later
// Finite strain of the compressible neo-Hookean solid against closed forms.
#include "precompute/fem/elastic.hpp"

#include "tests/support/block_mesh.hpp"
#include "tests/support/finite_difference.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::fem {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

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
Vector3d face_force(const mesh::TetMesh& mesh, const VectorXd& g, int axis, double at) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (std::abs(mesh.nodes[n][axis] - at) < 1e-9) sum += g.segment<3>(3 * static_cast<Eigen::Index>(n));
  }
  return sum;
}

class Stretch : public ::testing::TestWithParam<double> {
protected:
  mesh::TetMesh mesh = test::block_mesh({0, 0.3, 1}, {0, 0.6, 1}, {0, 0.5, 1});

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

}  // namespace
}  // namespace palpate::fem
