// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of the elastic energy against finite differences, through inverted, flat and collapsed states.
#include "precompute/fem/elastic.hpp"

#include "tests/fem/deformed_block.hpp"

#include <gtest/gtest.h>

#include <random>

namespace palpate::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

class Elastic : public ::testing::Test {
protected:
  mesh::TetMesh mesh = test::block_mesh({0, 0.5, 1.1}, {0, 0.9}, {0, 1.0});
  VectorXd rest = test::stacked(mesh);
};

TEST_F(Elastic, DerivativesMatchDifferencesAlsoWhereElementsDegenerate) {
  std::mt19937 engine(7);
  for (const double poisson : {0.0, 0.3, 0.49, 0.4999}) {
    const ElasticEnergy energy(mesh, {Material::neo_hookean(5e3, poisson)});
    const test::Alone problem(energy);
    for (const Vector3d& stretch : test::kDegenerate) {
      const VectorXd x = test::shaken(test::mapped(mesh, stretch.asDiagonal()), 0.08, engine);
      EXPECT_LT(test::gradient_error(problem, x, 1e-5), 1e-6) << "nu " << poisson << " stretch " << stretch.transpose();
      EXPECT_LT(test::hessian_error(problem, mesh, x, 1e-5), 1e-6) << "nu " << poisson;
    }
  }
}

TEST_F(Elastic, RigidMotionCostsNothingAndTheEnergyIsIndifferentToRotation) {
  const ElasticEnergy energy(mesh, {Material::neo_hookean(5e3, 0.49)});
  const Matrix3d turn = Eigen::AngleAxisd(1.1, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_NEAR(energy.value(test::mapped(mesh, turn)), energy.value(rest), 1e-9 * 5e3);
  VectorXd g = VectorXd::Zero(rest.size());
  energy.gradient(test::mapped(mesh, turn), g);
  EXPECT_LT(g.cwiseAbs().maxCoeff(), 1e-9 * 5e3);
  Matrix3d stretch;
  stretch << 1.2, 0.1, 0, 0, 0.9, 0.2, 0.1, 0, 1.05;
  EXPECT_NEAR(energy.value(test::mapped(mesh, turn * stretch)), energy.value(test::mapped(mesh, stretch)), 1e-9 * 5e3);
}

TEST_F(Elastic, SmallStrainIsHookesLaw) {
  const double young = 5e3, poisson = 0.3, strain = 1e-5;
  const ElasticEnergy energy(mesh, {Material::neo_hookean(young, poisson)});
  const Matrix3d f = Matrix3d::Identity() + strain * Vector3d(1, -poisson, -poisson).asDiagonal().toDenseMatrix();
  const double volume = 1.1 * 0.9;
  EXPECT_NEAR((energy.value(test::mapped(mesh, f)) - energy.value(rest)) / (0.5 * young * strain * strain * volume),
              1.0, 1e-3);
}

}  // namespace
}  // namespace palpate::fem
