// SPDX-License-Identifier: GPL-3.0-or-later
// Every law: derivatives through degenerate states, indifference, moduli at rest.
#include "precompute/fem/materials/scene_material.hpp"

#include "precompute/algebra/spectrum.hpp"
#include "precompute/fem/materials/invariant_law.hpp"
#include "tests/support/laws.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace palpate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Choice = test::LawChoice;

Matrix3d diagonal(double a, double b, double c) { return Vector3d(a, b, c).asDiagonal(); }

class Laws : public ::testing::TestWithParam<Choice> {
protected:
  Material material = make_material(test::law_scene(GetParam(), test::usual_poisson(GetParam())));

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
  constexpr double step = 1e-5;
  for (const Matrix3d& f : states()) {
    // Fibres begin to carry where they begin to be stretched: there the stiffness jumps.
    if (GetParam() == Choice::holzapfel && std::abs(f.squaredNorm() - 3) < 1e-9) continue;
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
    const auto before = spectrum(exact), after = spectrum(convex);
    for (int k = 0; k < 9; ++k) {
      EXPECT_NEAR(after.values[k], std::max(before.values[k], 0.0), 2e-6 * (1 + exact.norm()));
    }
    EXPECT_GT(spectrum<9>(convex - exact).values[0], -1e-10 * (1 + exact.norm()));
  }
}

TEST_P(Laws, RotationsCostNothing) {
  const Matrix3d turn = Eigen::AngleAxisd(2.1, Vector3d(0.3, 1, -2).normalized()).toRotationMatrix();
  if (GetParam() == Choice::linear) {  // Hooke's law of small strains is for small rotations alone, as its header says
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
  MaterialScene s = test::law_scene(GetParam(), 0.3);
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
    if (d(2, 2) > 0) d = -d;  // fibres that shorten carry nothing
    const double hooke = shear * d.squaredNorm() + 0.5 * lambda * d.trace() * d.trace();
    const double up = energy_at(Matrix3d::Identity() + e * d), down = energy_at(Matrix3d::Identity() - e * d);
    const double second = GetParam() == Choice::holzapfel ? 2 * (up - energy_at(Matrix3d::Identity())) / (e * e)
                                                          : (up + down - 2 * energy_at(Matrix3d::Identity())) / (e * e);
    EXPECT_NEAR(0.5 * second / hooke, 1.0, GetParam() == Choice::holzapfel ? 5e-3 : 1e-4);
    if (GetParam() != Choice::holzapfel) {
      EXPECT_NEAR((up - down) / (2 * e) / shear, 0.0, 1e-4);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, Laws, ::testing::ValuesIn(test::kEveryLaw));

// The comparison element's energies, as general packages write them.
TEST(Isochoric, DistortionAndVolumeAreSeparate) {
  const Material m = Material::of(0, {std::make_shared<Isochoric>(700.0, 300.0)}, 0.45);
  EXPECT_NEAR(m.slope, 0.0, 1e-9);
  EXPECT_NEAR(m.shear_modulus(), 2000.0, 1e-6);
  EXPECT_NEAR(m.bulk / (2 * 2000.0 * 1.45 / 0.3), 1.0, 1e-12);
  for (const double s : {0.7, 1.0, 1.4}) EXPECT_NEAR(m.deviatoric(s * Matrix3d::Identity()), 0.0, 1e-9);
  const Material plain = m.plain();
  const Matrix3d f = diagonal(1.2, 0.8, 1.1);
  EXPECT_NEAR(plain.deviatoric(f), m.deviatoric(f) + m.volumetric(f.determinant()), 1e-9);
}

}  // namespace
}  // namespace palpate
