// SPDX-License-Identifier: GPL-3.0-or-later
// Every law: derivatives through degenerate states, indifference, moduli at rest.
#include "precompute/fem/materials/scene_material.hpp"

#include "precompute/algebra/spectrum.hpp"
#include "tests/support/laws.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace palpate::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Choice = test::LawChoice;

Matrix3d diagonal(double a, double b, double c) { return Vector3d(a, b, c).asDiagonal(); }

// Every law, of the whole deformation and of the distortion where it has both.
std::vector<MaterialScene> every_law() {
  std::vector<MaterialScene> all;
  for (const Choice law : test::kEveryLaw) {
    all.push_back(test::law_scene(law, test::usual_poisson(law)));
    if (law == Choice::linear || law == Choice::st_venant) continue;
    all.push_back(all.back());
    all.back().volumetric = MaterialScene::Volumetric::isochoric;
  }
  return all;
}

class Laws : public ::testing::TestWithParam<MaterialScene> {
protected:
  Material material = make_material(GetParam());

  // Pa, of the modulus
  static double scale() { return 2000; }
};

// Whole and squeezed, sheared, turned inside out, flat, a needle, a point; equal stretches among them.
std::vector<Matrix3d> states() {
  std::mt19937 engine(11);
  std::uniform_real_distribution<double> noise(-0.15, 0.15);
  std::vector<Matrix3d> all;
  for (const Vector3d& s :
       {Vector3d(1, 1, 1), Vector3d(1.3, 1.3, 0.6), Vector3d(0.5, 1.1, 1.6), Vector3d(1, 1, -1),
        Vector3d(-0.7, 1.2, 1.2), Vector3d(1, 1, 0), Vector3d(1.2, 0, 0), Vector3d(0, 0, 0), Vector3d(0.05, 1, 2.2)}) {
    const Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d(1, -1, 2).normalized()).toRotationMatrix();
    all.push_back(s.asDiagonal());
    all.push_back(turn * s.asDiagonal());
    all.push_back(turn * s.asDiagonal() + Matrix3d::NullaryExpr([&] { return noise(engine); }));
  }
  return all;
}

TEST_P(Laws, DerivativesMatchDifferencesInEveryState) {
  constexpr double step = 2e-6;
  for (const Matrix3d& f : states()) {
    // Fibres begin to carry where they begin to be stretched: there the stiffness jumps.
    if (GetParam().law == Choice::holzapfel && std::abs(f.squaredNorm() - 3) < 1e-9) continue;
    Matrix3d stress;
    EXPECT_DOUBLE_EQ(material.stress(f, stress), material.deviatoric(f));
    Tangent tangent = material.law_tangent(f);
    tangent.diagonal().array() += material.mu;
    EXPECT_LT((tangent - tangent.transpose()).norm(), 1e-12 * (1 + tangent.norm()));
    for (int k = 0; k < 9; ++k) {
      Matrix3d up = f, down = f, stress_up, stress_down;
      up.data()[k] += step;
      down.data()[k] -= step;
      const double slope = (material.deviatoric(up) - material.deviatoric(down)) / (2 * step);
      EXPECT_NEAR(slope, stress.data()[k], 1e-6 * (scale() + stress.norm())) << "F\n" << f;
      material.stress(up, stress_up);
      material.stress(down, stress_down);
      const Matrix3d difference = (stress_up - stress_down) / (2 * step);
      const Eigen::Map<const Matrix3d> column(tangent.data() + 9 * k);
      EXPECT_LT((difference - column).norm(), 1e-6 * (scale() + tangent.norm())) << "F\n" << f;
    }
  }
}

TEST_P(Laws, TheConvexTangentIsTheExactOneWithoutItsNegativePart) {
  for (const Matrix3d& f : states()) {
    const Tangent exact = material.law_tangent(f), convex = positive_part(exact);
    const auto before = algebra::spectrum(exact), after = algebra::spectrum(convex);
    for (int k = 0; k < 9; ++k) {
      EXPECT_NEAR(after.values[k], std::max(before.values[k], 0.0), 2e-6 * (1 + exact.norm()));
    }
    EXPECT_GT(algebra::spectrum<9>(convex - exact).values[0], -1e-10 * (1 + exact.norm()));
  }
}

TEST_P(Laws, RotationsCostNothing) {
  const Matrix3d turn = Eigen::AngleAxisd(2.1, Vector3d(0.3, 1, -2).normalized()).toRotationMatrix();
  if (GetParam().law ==
      Choice::linear) {  // Hooke's law of small strains is for small rotations alone, as its header says
    EXPECT_GT(material.deviatoric(turn), 0.1 * scale());
    return;
  }
  for (const Matrix3d& f : states()) {
    Matrix3d stress, turned;
    const double w = material.stress(f, stress);
    EXPECT_NEAR(material.stress(turn * f, turned), w, 1e-12 * (scale() + std::abs(w)));
    EXPECT_LT((turned - turn * stress).norm(), 1e-11 * (scale() + stress.norm()));
  }
}

// Energy of small strains against Hooke's law with the scene's moduli.
TEST_P(Laws, SmallStrainsAreHookes) {
  MaterialScene s = GetParam();
  s.poisson = 0.3;
  s.fibre = {0, 0, 1};
  s.dispersion = 0;
  const Material m = make_material(s);
  const double shear = m.shear_modulus(), lambda = 2 * shear * 0.3 / 0.4, e = 1e-4;
  const auto energy_at = [&](const Matrix3d& f) { return m.deviatoric(f) + m.volumetric(f.determinant()); };
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 20; ++k) {
    Matrix3d d = Matrix3d::NullaryExpr([&] { return unit(engine); });
    d = (d + d.transpose()).eval();
    // Fibres that shorten, of a distortion relative to the mean, carry nothing.
    const bool isochoric = s.volumetric == MaterialScene::Volumetric::isochoric;
    if (d(2, 2) > (isochoric ? d.trace() / 3 : 0)) d = -d;
    const double hooke = shear * d.squaredNorm() + 0.5 * lambda * d.trace() * d.trace();
    const double up = energy_at(Matrix3d::Identity() + e * d), down = energy_at(Matrix3d::Identity() - e * d);
    const double second = GetParam().law == Choice::holzapfel
                              ? 2 * (up - energy_at(Matrix3d::Identity())) / (e * e)
                              : (up + down - 2 * energy_at(Matrix3d::Identity())) / (e * e);
    EXPECT_NEAR(0.5 * second / hooke, 1.0, GetParam().law == Choice::holzapfel ? 5e-3 : 1e-4);
    if (GetParam().law != Choice::holzapfel) {
      EXPECT_NEAR((up - down) / (2 * e) / shear, 0.0, 1e-4);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, Laws, ::testing::ValuesIn(every_law()));

// The comparison element's energies, as general packages write them.
TEST(Distortion, DistortionAndVolumeAreSeparate) {
  MaterialScene s = test::law_scene(Choice::mooney_rivlin, 0.45);
  s.volumetric = MaterialScene::Volumetric::isochoric;
  const Material m = make_material(s);
  EXPECT_NEAR(m.slope, 0.0, 1e-9);
  EXPECT_NEAR(m.shear_modulus(), 2000.0, 1e-6);
  EXPECT_NEAR(m.bulk / (2 * 2000.0 * 1.45 / 0.3), 1.0, 1e-12);
  for (const double l : {0.7, 1.0, 1.4}) EXPECT_NEAR(m.deviatoric(l * Matrix3d::Identity()), 0.0, 1e-9);
  const Material plain = m.plain();
  const Matrix3d f = diagonal(1.2, 0.8, 1.1);
  EXPECT_NEAR(plain.deviatoric(f), m.deviatoric(f) + m.volumetric(f.determinant()), 1e-9);
}

// Closed forms of the split: stretches (l, t, t) whose sides are free, and simple shear, of
// c10 (J^(-2/3) I1 - 3) + c01 (J^(-4/3) I2 - 3) + K/2 (J - 1)^2.
TEST(Distortion, UniaxialStretchAndSimpleShearAsTheFormulaSays) {
  MaterialScene s = test::law_scene(Choice::mooney_rivlin, 0.4);
  s.volumetric = MaterialScene::Volumetric::isochoric;
  const Material m = make_material(s);
  const double c10 = s.c10, c01 = s.c01, bulk = 2 * 2 * (c10 + c01) * 1.4 / (3 * 0.2);
  const auto energy = [&](double l, double t) {
    const double j = l * t * t, i1 = l * l + 2 * t * t, i2 = 2 * l * l * t * t + t * t * t * t;
    return c10 * (std::pow(j, -2.0 / 3) * i1 - 3) + c01 * (std::pow(j, -4.0 / 3) * i2 - 3) +
           bulk / 2 * (j - 1) * (j - 1);
  };
  const auto stress = [&](const Matrix3d& f) {
    Matrix3d p;
    m.stress(f, p);
    const double j = f.determinant();
    return Matrix3d(p + m.volumetric_slope(j) * j * f.inverse().transpose());
  };
  for (const double l : {0.6, 0.9, 1.3, 2.0}) {
    double t = 1;
    const double e = 1e-5;
    for (int k = 0; k < 50; ++k) {  // dW/dt = 0
      const double up = energy(l, t + e), down = energy(l, t - e);
      t -= (up - down) / (2 * e) / ((up - 2 * energy(l, t) + down) / (e * e));
    }
    const Matrix3d p = stress(diagonal(l, t, t));
    EXPECT_NEAR(p(0, 0), (energy(l + e, t) - energy(l - e, t)) / (2 * e), 1e-3) << l;
    EXPECT_NEAR(p(1, 1), 0, 1e-2) << l;
  }
  for (const double k : {0.1, 0.5, 1.5}) {
    Matrix3d f = Matrix3d::Identity();
    f(0, 1) = k;  // J = 1, I1 = I2 = 3 + k^2
    EXPECT_NEAR(stress(f)(0, 1), 2 * (c10 + c01) * k, 1e-9) << k;
  }
}

}  // namespace
}  // namespace palpate::fem
