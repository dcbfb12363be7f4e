// SPDX-License-Identifier: GPL-3.0-or-later
// Every law in both elements (P2/P0, and plain P2 for comparison): derivatives of the assembled energy, the patch test,
// rigid motion, and closed forms of stretch and shear read off the elements' nodal forces.
#include "precompute/fem/elastic.hpp"
#include "precompute/fem/materials/scene_material.hpp"

#include "tests/fem/deformed_block.hpp"
#include "tests/support/laws.hpp"
#include "tests/support/loaded.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <tuple>

namespace palpate::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::LawChoice;

constexpr double kModulus = 2000;  // Pa, about the shear modulus of every law

mesh::TetMesh distorted_cube() { return test::distorted_block({0, 0.4, 1}, {0, 0.6, 1}, {0, 0.5, 1}, 0.06); }

class EveryLaw : public ::testing::TestWithParam<std::tuple<LawChoice, bool>> {
protected:
  static Material material() {
    const auto [law, plain] = GetParam();
    const Material m = make_material(test::law_scene(law, test::usual_poisson(law)));
    return plain ? m.plain() : m;
  }
};

TEST_P(EveryLaw, AssembledDerivativesMatchDifferencesAlsoWhereElementsDegenerate) {
  const mesh::TetMesh mesh = test::block_mesh({0, 0.5, 1.1}, {0, 0.9}, {0, 1.0});
  const ElasticEnergy energy(mesh, {material()});
  const test::Loaded problem(energy, VectorXd::Zero(3 * static_cast<Eigen::Index>(mesh.nodes.size())));
  std::mt19937 engine(7);
  for (const Vector3d& stretch : test::kDegenerate) {
    const VectorXd x = test::shaken(test::mapped(mesh, stretch.asDiagonal()), 0.08, engine);
    EXPECT_LT(test::gradient_error(problem, x, 1e-5), 1e-6) << "stretch " << stretch.transpose();
    EXPECT_LT(test::hessian_error(problem, mesh, x, 1e-5), 1e-6) << "stretch " << stretch.transpose();
  }
}

// A linear field must leave every inner node in balance, and the faces with the stress of its constant F.
TEST_P(EveryLaw, PatchTestOnADistortedMesh) {
  const mesh::TetMesh mesh = distorted_cube();
  const Material m = material();
  Matrix3d f, stress;
  f << 1.3, 0.2, -0.1, 0.05, 0.8, 0.1, 0.2, -0.15, 0.95;
  m.stress(f, stress);
  stress += m.volumetric_slope(f.determinant()) * f.determinant() * f.inverse().transpose();
  VectorXd g = VectorXd::Zero(3 * static_cast<Eigen::Index>(mesh.nodes.size()));
  ElasticEnergy(mesh, {m}).gradient(test::mapped(mesh, f), g);
  const double scale = g.cwiseAbs().maxCoeff();
  int inner = 0;
  Matrix3d moment = Matrix3d::Zero();  // of the nodal forces about the origin: the stress times the volume, which is 1
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Vector3d force = g.segment<3>(3 * static_cast<Eigen::Index>(n)), &at = mesh.nodes[n];
    moment += force * at.transpose();
    if (at.minCoeff() < 1e-9 || at.maxCoeff() > 1 - 1e-9) continue;
    ++inner;
    EXPECT_LT(force.norm(), 1e-12 * scale);
  }
  EXPECT_GT(inner, 10);
  EXPECT_LT((moment - stress).norm(), 1e-12 * stress.norm());
}

// Hooke's law is strained by a rotation, but neither by its linear part nor by a shift.
TEST_P(EveryLaw, RigidMotionPullsAtNoNode) {
  const mesh::TetMesh mesh = distorted_cube();
  const ElasticEnergy energy(mesh, {material()});
  const Vector3d axis(1, 2, 3);
  Matrix3d turn = Eigen::AngleAxisd(1.1, axis.normalized()).toRotationMatrix();
  if (std::get<0>(GetParam()) == LawChoice::linear) {
    for (int k = 0; k < 3; ++k) turn.col(k) = Vector3d::Unit(k) + 0.3 * axis.cross(Vector3d::Unit(k));
  }
  VectorXd x = test::mapped(mesh, turn);
  for (Eigen::Index n = 0; n < x.size() / 3; ++n) x.segment<3>(3 * n) += Vector3d(3, -2, 5);
  VectorXd g = VectorXd::Zero(x.size());
  EXPECT_NEAR(energy.gradient(x, g), energy.value(test::stacked(mesh)), 1e-11 * kModulus);
  EXPECT_LT(g.cwiseAbs().maxCoeff(), 1e-11 * kModulus);
}

INSTANTIATE_TEST_SUITE_P(Each, EveryLaw, ::testing::Combine(::testing::ValuesIn(test::kEveryLaw), ::testing::Bool()));

// Nominal stress (Pa) along z, the direction of the fibres; of shear along x on the faces across z. Incompressible
// where the law is used so, else with the moduli that the scene gives.
struct Closed {
  const char* name;
  LawChoice law;
  double poisson;
  double tolerance;  // relative, of the stretches: the volume still changes a little at nu 0.4999
  std::function<double(const MaterialScene&, double)> uniaxial, equibiaxial, shear;
};

// For the test's output; otherwise the bytes of the case are printed.
[[maybe_unused]] void PrintTo(const Closed& closed, std::ostream* out) { *out << closed.name; }

class ClosedForm : public ::testing::TestWithParam<Closed> {
protected:
  // Traction (Pa) on the cube's face across `axis`.
  Vector3d traction(const Matrix3d& f, int axis) const {
    VectorXd g = VectorXd::Zero(3 * static_cast<Eigen::Index>(mesh.nodes.size()));
    energy.gradient(test::mapped(mesh, f), g);
    Vector3d sum = Vector3d::Zero();
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      if (mesh.nodes[n][axis] > 1 - 1e-9) sum += g.segment<3>(3 * static_cast<Eigen::Index>(n));
    }
    return sum;
  }

  // Traction along z of the stretches (x, y, z) = (b or a, b, a) where b leaves the faces across y free.
  double free_stretch(double a, bool equibiaxial) const {
    const auto state = [&](double b) { return Vector3d(equibiaxial ? a : b, b, a); };
    const double guess = equibiaxial ? 1 / (a * a) : 1 / std::sqrt(a);
    double low = 0.5 * guess, high = 2 * guess;
    for (int k = 0; k < 60; ++k) {
      const double b = (low + high) / 2;
      (traction(state(b).asDiagonal(), 1).y() < 0 ? low : high) = b;
    }
    return traction(state(low).asDiagonal(), 2).z();
  }

  static MaterialScene fibres_along_z() {
    MaterialScene s = test::law_scene(GetParam().law, GetParam().poisson);
    s.fibre = {0, 0, 1};
    s.dispersion = 0;
    return s;
  }

  mesh::TetMesh mesh = test::block_mesh({0, 0.3, 1}, {0, 1}, {0, 0.5, 1});
  MaterialScene scene = fibres_along_z();
  ElasticEnergy energy{mesh, {make_material(scene)}};
};

TEST_P(ClosedForm, UniaxialStretch) {
  for (const double a : {0.6, 0.8, 1.2, 1.6}) {
    EXPECT_NEAR(free_stretch(a, false) / GetParam().uniaxial(scene, a), 1, GetParam().tolerance) << "stretch " << a;
  }
}

TEST_P(ClosedForm, EquibiaxialStretch) {
  for (const double a : {0.9, 1.1, 1.2}) {
    EXPECT_NEAR(free_stretch(a, true) / GetParam().equibiaxial(scene, a), 1, GetParam().tolerance) << "stretch " << a;
  }
}

// It keeps the volume: no tolerance for that.
TEST_P(ClosedForm, SimpleShear) {
  for (const double k : {-0.4, 0.2, 0.7}) {
    Matrix3d f = Matrix3d::Identity();
    f(0, 2) = k;
    EXPECT_NEAR(traction(f, 2).x() / GetParam().shear(scene, k), 1, 1e-10) << "shear " << k;
  }
}

double shear_modulus(const MaterialScene& s) { return s.young / (2 * (1 + s.poisson)); }
double lame(const MaterialScene& s) { return 2 * shear_modulus(s) * s.poisson / (1 - 2 * s.poisson); }
double green(double a) { return (a * a - 1) / 2; }

double ogden(const MaterialScene& s, double a, double side) {
  double sum = 0;
  for (const auto& t : s.terms) sum += t.mu * (std::pow(a, t.alpha - 1) - std::pow(a, side * t.alpha - 1));
  return sum;
}

// Derivative of the fibres' energy by their stretch.
double fibres(const MaterialScene& s, double a) {
  const double e = a * a - 1;
  return e > 0 ? 2 * s.k1 * e * std::exp(s.k2 * e * e) * a : 0;
}

const Closed kClosed[] = {
    {"NeoHookean", LawChoice::neo_hookean, 0.4999, 3e-3,
     [](const MaterialScene& s, double a) { return shear_modulus(s) * (a - std::pow(a, -2)); },
     [](const MaterialScene& s, double a) { return shear_modulus(s) * (a - std::pow(a, -5)); },
     [](const MaterialScene& s, double k) { return shear_modulus(s) * k; }},
    {"MooneyRivlin", LawChoice::mooney_rivlin, 0.4999, 3e-3,
     [](const MaterialScene& s, double a) { return 2 * (s.c10 + s.c01 / a) * (a - std::pow(a, -2)); },
     [](const MaterialScene& s, double a) { return 2 * (s.c10 + s.c01 * a * a) * (a - std::pow(a, -5)); },
     [](const MaterialScene& s, double k) { return 2 * (s.c10 + s.c01) * k; }},
    {"Ogden", LawChoice::ogden, 0.4999, 3e-3, [](const MaterialScene& s, double a) { return ogden(s, a, -0.5); },
     [](const MaterialScene& s, double a) { return ogden(s, a, -2); },
     [](const MaterialScene& s, double k) {
       const double a = k / 2 + std::sqrt(1 + k * k / 4);  // the larger principal stretch, the other is 1 / a
       double sum = 0;
       for (const auto& t : s.terms) sum += t.mu * (std::pow(a, t.alpha) - std::pow(a, -t.alpha)) / (a + 1 / a);
       return sum;
     }},
    {"VerondaWestmann", LawChoice::veronda_westmann, 0.4999, 0.02,  // a stiff exponential answers most to the volume
     [](const MaterialScene& s, double a) {
       const double i1 = a * a + 2 / a, c2 = -0.5 * s.c1 * s.beta;
       return 2 * (s.c1 * s.beta * std::exp(s.beta * (i1 - 3)) + c2 / a) * (a - std::pow(a, -2));
     },
     [](const MaterialScene& s, double a) {
       const double i1 = 2 * a * a + std::pow(a, -4), c2 = -0.5 * s.c1 * s.beta;
       return 2 * (s.c1 * s.beta * std::exp(s.beta * (i1 - 3)) + c2 * a * a) * (a - std::pow(a, -5));
     },
     [](const MaterialScene& s, double k) {
       return 2 * (s.c1 * s.beta * std::exp(s.beta * k * k) - 0.5 * s.c1 * s.beta) * k;
     }},
    {"HolzapfelOgden", LawChoice::holzapfel, 0.4999, 3e-3,
     [](const MaterialScene& s, double a) { return shear_modulus(s) * (a - std::pow(a, -2)) + fibres(s, a); },
     [](const MaterialScene& s, double a) { return shear_modulus(s) * (a - std::pow(a, -5)) + fibres(s, a); },
     [](const MaterialScene& s, double k) {  // the fibres are stretched to sqrt(1 + k^2)
       const double a = std::sqrt(1 + k * k);
       return shear_modulus(s) * k + fibres(s, a) * k / a;
     }},
    {"StVenantKirchhoff", LawChoice::st_venant, 0.3, 1e-9,
     [](const MaterialScene& s, double a) { return a * s.young * green(a); },
     [](const MaterialScene& s, double a) { return a * s.young / (1 - s.poisson) * green(a); },
     [](const MaterialScene& s, double k) { return shear_modulus(s) * (k + k * k * k) + lame(s) * k * k * k / 2; }},
    {"Linear", LawChoice::linear, 0.3, 1e-9, [](const MaterialScene& s, double a) { return s.young * (a - 1); },
     [](const MaterialScene& s, double a) { return s.young / (1 - s.poisson) * (a - 1); },
     [](const MaterialScene& s, double k) { return shear_modulus(s) * k; }},
};

INSTANTIATE_TEST_SUITE_P(Laws, ClosedForm, ::testing::ValuesIn(kClosed),
                         [](const auto& closed) { return std::string(closed.param.name); });

}  // namespace
}  // namespace palpate::fem
