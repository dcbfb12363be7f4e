// SPDX-License-Identifier: GPL-3.0-or-later
// Weight and cavity pressure: derivatives, exact volumes, what a load must not do.
#include "precompute/fem/pressure.hpp"
#include "precompute/fem/weight.hpp"
#include "tests/fem/deformed_block.hpp"
#include "tests/fem/hollow_block.hpp"

#include <gtest/gtest.h>

#include <random>

namespace palpate::fem {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

class Pressure final : public EnergyProblem {
public:
  explicit Pressure(const mesh::TetMesh& mesh, double factor)
      : energy_(mesh, cavity_walls(mesh).at(0), 700), factor_(factor) {}
  double value(const VectorXd& x) const override { return factor_ * energy_.value(x); }
  double gradient(const VectorXd& x, VectorXd& g) const override {
    g.setZero();
    return factor_ * energy_.gradient(x, factor_, g);
  }
  void hessian(const VectorXd& x, HessianKind kind, BlockMatrix& m) const override {
    energy_.hessian(x, kind, factor_, m);
  }
  double load(const VectorXd&) const override { return 1; }
  [[nodiscard]] double volume(const VectorXd& x) const { return energy_.volume(x); }

private:
  PressureEnergy energy_;
  double factor_;
};

template <class Map>
VectorXd mapped(const mesh::TetMesh& mesh, Map map) {
  VectorXd x = test::stacked(mesh);
  for (Eigen::Index k = 0; k < x.size(); k += 3) x.segment<3>(k) = Vector3d(map(Vector3d(x.segment<3>(k))));
  return x;
}

TEST(CavityWalls, AreTheClosedPartsRoundAVoid) {
  EXPECT_TRUE(cavity_walls(test::block_mesh(test::kHollowLines, test::kHollowLines, test::kHollowLines)).empty());
  const auto walls = cavity_walls(test::hollow_block());
  ASSERT_EQ(walls.size(), 1U);
  EXPECT_EQ(walls[0].size(), 12U);
}

TEST(CavityPressure, VolumeIsExactForQuadraticFaces) {
  const mesh::TetMesh mesh = test::hollow_block();
  const Pressure pressure(mesh, 1);
  const double side = 1.1;
  EXPECT_NEAR(pressure.volume(test::stacked(mesh)), side * side * side, 1e-13);
  Eigen::Matrix3d f;
  f << 1.2, 0.1, -0.3, 0.05, 0.8, 0.2, 0, 0.4, 1.1;
  EXPECT_NEAR(pressure.volume(mapped(mesh, [&](const Vector3d& p) { return Vector3d(f * p); })),
              f.determinant() * side * side * side, 1e-12);
  // det of the gradient is 1 + 0.4 x: the void's mean of x is 1.45.
  const VectorXd bent = mapped(mesh, [](const Vector3d& p) {
    return Vector3d(p.x() + 0.2 * p.x() * p.x(), p.y() + 0.3 * p.x() * p.x(), p.z());
  });
  EXPECT_NEAR(pressure.volume(bent), (1 + 0.4 * 1.45) * side * side * side, 1e-12);
}

TEST(CavityPressure, DerivativesMatchDifferencesAlsoWhereTheVoidDegenerates) {
  const mesh::TetMesh mesh = test::hollow_block();
  const Pressure pressure(mesh, 0.6);
  std::mt19937 engine(3);
  for (const Vector3d& stretch : test::kDegenerate) {
    const VectorXd x = test::shaken(test::mapped(mesh, stretch.asDiagonal()), 0.2, engine);
    EXPECT_LT(test::gradient_error(pressure, x, 1e-5), 1e-8) << "stretch " << stretch.transpose();
    EXPECT_LT(test::hessian_error(pressure, mesh, x, 1e-5), 1e-8) << "stretch " << stretch.transpose();
  }
}

// A closed surface under pressure is pushed nowhere and turned nowhere, however it is deformed.
TEST(CavityPressure, IsInBalanceWithItself) {
  const mesh::TetMesh mesh = test::hollow_block();
  const Pressure pressure(mesh, 1);
  std::mt19937 engine(4);
  std::uniform_real_distribution<double> noise(-0.2, 0.2);
  VectorXd x = test::stacked(mesh), g(x.size());
  for (auto& v : x) v += noise(engine);
  pressure.gradient(x, g);
  Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();
  for (Eigen::Index k = 0; k < x.size(); k += 3) {
    force += g.segment<3>(k);
    moment += Vector3d(x.segment<3>(k)).cross(Vector3d(g.segment<3>(k)));
  }
  EXPECT_GT(g.norm(), 100);
  EXPECT_LT(force.norm(), 1e-10);
  EXPECT_LT(moment.norm(), 1e-10);
}

TEST(Weight, IsDensityTimesVolumeAndActsAtTheCentre) {
  const mesh::TetMesh mesh = test::block_mesh(test::kHollowLines, {0, 1, 2}, {0, 0.4, 1});
  const Vector3d density(10, -20, 30);
  const WeightEnergy weight(mesh, density);
  const VectorXd x = mapped(mesh, [](const Vector3d& p) { return Vector3d(1.3 * p + Vector3d(0.1, 0.2, p.x())); });
  VectorXd g = VectorXd::Zero(x.size());
  const double energy = weight.gradient(x, 1, g);
  Vector3d force = Vector3d::Zero();
  for (Eigen::Index k = 0; k < x.size(); k += 3) force -= g.segment<3>(k);
  EXPECT_LT((force - 6 * density).norm(), 1e-11);
  // The centre (1.5, 1, 0.5) goes to (2.05, 1.5, 2.15).
  EXPECT_NEAR(energy, -6 * density.dot(Vector3d(2.05 - 1.5, 1.5 - 1, 2.15 - 0.5)), 1e-11);
  EXPECT_EQ(weight.value(test::stacked(mesh)), 0.0);
  EXPECT_TRUE(WeightEnergy(mesh, Vector3d::Zero()).empty());
}

}  // namespace
}  // namespace palpate::fem
