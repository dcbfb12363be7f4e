// SPDX-License-Identifier: GPL-3.0-or-later
// Compressible laws with free sides against their stress by hand: the lateral stretch is solved for, moduli are written
// out from E and nu.
#include "precompute/fem/elastic.hpp"
#include "precompute/fem/materials/scene_material.hpp"

#include "tests/fem/deformed_block.hpp"
#include "tests/support/laws.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

namespace palpate::fem {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using test::LawChoice;

/// A law without its volume term, by hand: dW/dl of the stretch l along an axis, fibres along z; at rest that slope
/// (Pa), the shear modulus, and the missing bulk modulus, (6 W' - W'') / 9 of a stretch of all lengths together.
struct ByHand {
  const char* name;
  LawChoice law;
  double reach;  // of stretches from 1: beyond it a body of nu 0.3 falls in sideways
  std::function<void(MaterialScene&)> change;
  std::function<double(const MaterialScene&, const Vector3d&, int)> slope;
  std::function<double(const MaterialScene&)> at_rest, shear, lacking;
};

[[maybe_unused]] void PrintTo(const ByHand& law, std::ostream* out) { *out << law.name; }

class Compressible : public ::testing::TestWithParam<ByHand> {
protected:
  static MaterialScene scene(double poisson) {
    MaterialScene s = test::law_scene(GetParam().law, poisson);
    s.fibre = {0, 0, 1};
    s.dispersion = 0;
    GetParam().change(s);
    return s;
  }

  // Nominal, along an axis (Pa).
  static double stress(const MaterialScene& s, const Vector3d& stretch, int axis) {
    const ByHand& law = GetParam();
    const double young = 2 * law.shear(s) * (1 + s.poisson), bulk = young / (3 * (1 - 2 * s.poisson)) + law.lacking(s);
    const double volume = stretch.prod(), pressure = bulk * (volume - 1) - law.at_rest(s);
    return law.slope(s, stretch, axis) + pressure * volume / stretch[axis];
  }

  // With the faces across y free, followed from rest; those across x as well unless it is stretched as z is.
  static Vector3d state(const MaterialScene& s, double stretch, bool equibiaxial) {
    constexpr int kSteps = 40;
    double side = 1;
    const auto at = [&](double a, double b) { return Vector3d(equibiaxial ? a : b, b, a); };
    for (int k = 1; k <= kSteps; ++k) {
      const double a = 1 + (stretch - 1) * k / kSteps, step = 1e-6;
      for (int newton = 0; newton < 5; ++newton) {
        const double up = stress(s, at(a, side + step), 1), down = stress(s, at(a, side - step), 1);
        side -= stress(s, at(a, side), 1) * 2 * step / (up - down);
      }
    }
    return at(stretch, side);
  }

  // On the cube's face across `axis` (Pa).
  Vector3d traction(const MaterialScene& s, const Vector3d& stretch, int axis) const {
    VectorXd g = VectorXd::Zero(3 * static_cast<Eigen::Index>(mesh.nodes.size()));
    ElasticEnergy(mesh, {make_material(s)}).gradient(test::mapped(mesh, stretch.asDiagonal()), g);
    Vector3d sum = Vector3d::Zero();
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      if (mesh.nodes[n][axis] > 1 - 1e-9) sum += g.segment<3>(3 * static_cast<Eigen::Index>(n));
    }
    return sum;
  }

  void compare(bool equibiaxial) const {
    for (const double poisson : {0.3, 0.45}) {
      const MaterialScene s = scene(poisson);
      for (const double part : {-1.0, -0.5, 0.5, 1.0}) {
        const Vector3d stretch = state(s, 1 + part * GetParam().reach, equibiaxial);
        EXPECT_GT((stretch.y() - 1) * -part, 0.0);
        for (int axis = 0; axis < 3; ++axis) {
          const bool free = axis == 1 || (axis == 0 && !equibiaxial);
          const double expected = free ? 0.0 : stress(s, stretch, axis);
          EXPECT_LT((traction(s, stretch, axis) - expected * Vector3d::Unit(axis)).norm(), 1e-10 * GetParam().shear(s))
              << "nu " << poisson << " stretches " << stretch.transpose();
        }
      }
    }
  }

  mesh::TetMesh mesh = test::block_mesh({0, 0.3, 1}, {0, 0.6, 1}, {0, 0.5, 1});
};

TEST_P(Compressible, UniaxialStretch) { compare(false); }
TEST_P(Compressible, EquibiaxialStretch) { compare(true); }

// d I2 / dl = 2 l (I1 - l^2) of I2 = sum of li^2 lj^2
double second_slope(const Vector3d& l, int i) { return 2 * l[i] * (l.squaredNorm() - l[i] * l[i]); }

double exponential_slope(const MaterialScene& s, double c2, const Vector3d& l, int i) {
  return 2 * s.c1 * s.beta * l[i] * std::exp(s.beta * (l.squaredNorm() - 3)) + c2 * second_slope(l, i);
}

double matrix_shear(const MaterialScene& s) { return s.young / (2 * (1 + s.poisson)); }

double fibred_slope(const MaterialScene& s, const Vector3d& l, int i) {
  const double kappa = s.dispersion, e = kappa * (l.squaredNorm() - 3) + (1 - 3 * kappa) * (l.z() * l.z() - 1);
  const double by_l = 2 * kappa * l[i] + (i == 2 ? 2 * (1 - 3 * kappa) * l.z() : 0);
  return matrix_shear(s) * l[i] + (e > 0 ? s.k1 * e * std::exp(s.k2 * e * e) * by_l : 0);
}

double terms(const MaterialScene& s, const std::function<double(double, double)>& of) {
  double sum = 0;
  for (const auto& t : s.terms) sum += of(t.mu, t.alpha);
  return sum;
}

const ByHand kByHand[] = {
    {"NeoHookean", LawChoice::neo_hookean, 0.3, [](MaterialScene&) {},
     [](const MaterialScene& s, const Vector3d& l, int i) { return matrix_shear(s) * l[i]; }, matrix_shear,
     matrix_shear, [](const MaterialScene& s) { return matrix_shear(s) / 3; }},
    {"MooneyRivlin", LawChoice::mooney_rivlin, 0.3, [](MaterialScene&) {},
     [](const MaterialScene& s, const Vector3d& l, int i) { return 2 * s.c10 * l[i] + s.c01 * second_slope(l, i); },
     [](const MaterialScene& s) { return 2 * s.c10 + 4 * s.c01; },
     [](const MaterialScene& s) { return 2 * (s.c10 + s.c01); },
     [](const MaterialScene& s) { return (2 * s.c10 - 4 * s.c01) / 3; }},
    {"Ogden", LawChoice::ogden, 0.25, [](MaterialScene&) {},
     [](const MaterialScene& s, const Vector3d& l, int i) {
       return terms(s, [&](double mu, double alpha) { return mu * std::pow(l[i], alpha - 1); });
     },
     [](const MaterialScene& s) { return terms(s, [](double mu, double) { return mu; }); },
     [](const MaterialScene& s) { return terms(s, [](double mu, double alpha) { return mu * alpha / 2; }); },
     [](const MaterialScene& s) { return terms(s, [](double mu, double alpha) { return mu - mu * alpha / 3; }); }},
    {"VerondaWestmann", LawChoice::veronda_westmann, 0.05, [](MaterialScene&) {},
     [](const MaterialScene& s, const Vector3d& l, int i) { return exponential_slope(s, -0.5 * s.c1 * s.beta, l, i); },
     [](const MaterialScene&) { return 0.0; }, [](const MaterialScene& s) { return s.c1 * s.beta; },
     [](const MaterialScene& s) { return (4 * s.c1 * s.beta - 12 * s.c1 * s.beta * s.beta) / 3; }},
    {"Fung", LawChoice::veronda_westmann, 0.1, [](MaterialScene& s) { s.c2 = 0; },
     [](const MaterialScene& s, const Vector3d& l, int i) { return exponential_slope(s, 0, l, i); },
     [](const MaterialScene& s) { return 2 * s.c1 * s.beta; }, [](const MaterialScene& s) { return 2 * s.c1 * s.beta; },
     [](const MaterialScene& s) { return (2 * s.c1 * s.beta - 12 * s.c1 * s.beta * s.beta) / 3; }},
    {"HolzapfelOgden", LawChoice::holzapfel, 0.3, [](MaterialScene&) {}, fibred_slope, matrix_shear, matrix_shear,
     [](const MaterialScene& s) { return matrix_shear(s) / 3; }},
    {"HolzapfelOgdenDispersed", LawChoice::holzapfel, 0.3, [](MaterialScene& s) { s.dispersion = 0.1; }, fibred_slope,
     matrix_shear, matrix_shear, [](const MaterialScene& s) { return matrix_shear(s) / 3; }},
};

INSTANTIATE_TEST_SUITE_P(Laws, Compressible, ::testing::ValuesIn(kByHand),
                         [](const auto& law) { return std::string(law.param.name); });

}  // namespace
}  // namespace palpate::fem
