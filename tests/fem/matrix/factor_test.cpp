// SPDX-License-Identifier: GPL-3.0-or-later
// Solves with the sparse factor, in single and in double precision, and what it refuses.
#include "precompute/fem/matrix/factor.hpp"

#include "precompute/fem/elastic.hpp"
#include "tests/support/block_mesh.hpp"
#include "tests/support/finite_difference.hpp"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <csignal>
#include <random>

namespace palpate::fem {
namespace {

using Eigen::VectorXd;

// Stiffness of a block that stands on its bottom.
class Stiffness : public ::testing::Test {
protected:
  mesh::TetMesh mesh = test::block_mesh({0, 0.2, 0.5, 1}, {0, 0.4, 0.7, 1}, {0, 0.3, 0.6, 1});
  VectorXd rest = test::stacked(mesh);

  [[nodiscard]] Eigen::SparseMatrix<double> at(double poisson, const VectorXd& x) const {
    std::vector<char> fixed(mesh.nodes.size(), 0);
    for (std::size_t n = 0; n < fixed.size(); ++n) fixed[n] = mesh.nodes[n].z() < 1e-9;
    BlockMatrix matrix(mesh, fixed);
    matrix.set_zero();
    ElasticEnergy(mesh, {Material::neo_hookean(5e3, poisson)}).hessian(x, HessianKind::exact, matrix);
    return matrix.matrix();
  }
  static VectorXd load(Eigen::Index size) {
    std::mt19937 engine(4);
    std::uniform_real_distribution<double> unit(-1e-6, 1e-6);
    return VectorXd::NullaryExpr(size, [&] { return unit(engine); });
  }
};

TEST_F(Stiffness, ItsOwnFactorIsRightToSinglePrecision) {
  for (const double poisson : {0.0, 0.49, 0.4999}) {
    const auto k = at(poisson, rest);
    Factor factor(k);
    const VectorXd b = load(k.rows());
    ASSERT_TRUE(factor.factorise(k, b));
    EXPECT_TRUE(factor.single()) << poisson;
    const VectorXd x = Eigen::SimplicialLDLT<Factor::Matrix>(k).solve(b);
    const double error = (factor.solve(b) - x).norm() / x.norm();
    EXPECT_LT(error, poisson > 0.49 ? 1e-2 : 1e-3) << poisson;
    EXPECT_GT(error, 1e-9) << "it is in single precision";
    EXPECT_EQ(factor.solve(0 * b).norm(), 0);
  }
}

// A block that all but floats: moved as a whole it meets a millionth of a millionth of its own stiffness.
TEST_F(Stiffness, WhatSinglePrecisionCannotHoldIsFactorisedInDouble) {
  BlockMatrix floating(mesh, std::vector<char>(mesh.nodes.size(), 0));
  floating.set_zero();
  ElasticEnergy(mesh, {Material::neo_hookean(5e3, 0.49)}).hessian(rest, HessianKind::exact, floating);
  Factor::Matrix k = floating.matrix();
  const double spring = 1e-12 * k.coeffs().maxCoeff();
  for (int row = 0; row < k.rows(); ++row) k.coeffRef(row, row) += spring;
  Factor factor(k);
  const VectorXd b = load(k.rows());
  ASSERT_TRUE(factor.factorise(k, b));
  EXPECT_FALSE(factor.single());
  EXPECT_LT((k.selfadjointView<Eigen::Lower>() * factor.solve(b) - b).norm(), 1e-2 * b.norm());
}

TEST_F(Stiffness, ANewFactorReplacesTheOld) {
  const auto soft = at(0.3, rest);
  const Eigen::SparseMatrix<double> stiff = 1e6 * soft;
  Factor factor(soft);
  const VectorXd b = load(soft.rows());
  ASSERT_TRUE(factor.factorise(soft, b));
  const VectorXd x = factor.solve(b);
  ASSERT_TRUE(factor.factorise(stiff, b));
  EXPECT_LT((1e6 * factor.solve(b) - x).norm(), 1e-5 * x.norm());
}

// Pressed flat, a block buckles: its Hessian is indefinite, and no factor is made of it.
TEST_F(Stiffness, AnIndefiniteMatrixHasNoFactor) {
  VectorXd flat = rest;
  for (Eigen::Index n = 0; n < flat.size() / 3; ++n) flat[3 * n + 2] *= 0.2;
  const auto k = at(0.49, flat);
  Factor factor(k);
  const VectorXd b = load(k.rows());
  EXPECT_FALSE(factor.factorise(k, b));
  const auto good = at(0.49, rest);
  EXPECT_TRUE(factor.factorise(good, b)) << "the next one is not spoilt by it";
  EXPECT_LT((good.selfadjointView<Eigen::Lower>() * factor.solve(b) - b).norm(), 1e-3 * b.norm());
}

TEST_F(Stiffness, OrderingLeavesSignalHandlersAsTheyAre) {
  struct sigaction ours = {}, before = {}, after = {};
  ours.sa_handler = [](int) {};
  ours.sa_flags = SA_RESTART;
  for (const int signal : {SIGTERM, SIGABRT}) {
    ASSERT_EQ(sigaction(signal, &ours, &before), 0);
    const Factor factor(at(0.3, rest));
    ASSERT_EQ(sigaction(signal, &before, &after), 0);
    EXPECT_EQ(after.sa_handler, ours.sa_handler);
    EXPECT_EQ(after.sa_flags & (SA_RESTART | SA_NODEFER | SA_RESETHAND), SA_RESTART) << "it was installed again";
  }
}

}  // namespace
}  // namespace palpate::fem
