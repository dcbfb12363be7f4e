// SPDX-License-Identifier: GPL-3.0-or-later
// A thick-walled sphere under pressure from within: Lame's solution at small strain, and the inflation of an
// incompressible neo-Hookean shell. An octant on three sliders.
#include "precompute/fem/materials/scene_material.hpp"
#include "precompute/fem/minimiser.hpp"
#include "precompute/mesh/volume/quadratic.hpp"
#include "precompute/solve/contact/bed.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/loaded.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

namespace palpate::solve::thick_sphere_test {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kInner = 0.01, kOuter = 0.02, kYoung = 5e3;  // m, m, Pa

// The octant's triangle cut into cells^2 on every sphere of corners; prisms between them, of three tetrahedra each.
mesh::TetMesh octant(int cells, int layers) {
  mesh::LinearTets linear;
  std::vector<std::array<std::int32_t, 3>> triangles;
  const auto number = [&](int i, int j) { return i * (cells + 1) - i * (i - 1) / 2 + j; };
  const int points = number(cells, 0) + 1;
  for (int layer = 0; layer <= layers; ++layer) {
    const double radius = kInner * std::pow(kOuter / kInner, static_cast<double>(layer) / layers);
    for (int i = 0; i <= cells; ++i) {
      for (int j = 0; i + j <= cells; ++j) {
        const auto along = [&](int k) { return std::sin(std::numbers::pi / 2 * k / cells); };
        linear.points.push_back(radius * Vector3d(along(i), along(j), along(cells - i - j)).normalized());
      }
    }
  }
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; i + j < cells; ++j) {
      triangles.push_back({number(i, j), number(i, j + 1), number(i + 1, j)});
      if (i + j + 1 < cells) triangles.push_back({number(i, j + 1), number(i + 1, j), number(i + 1, j + 1)});
    }
  }
  for (int layer = 0; layer < layers; ++layer) {
    for (const auto& [a, b, c] : triangles) {  // ascending, so that the sides of neighbours are cut alike
      const std::int32_t low = layer * points, high = low + points;
      for (std::array<std::int32_t, 4> t : {std::array{low + a, low + b, low + c, high + c},
                                            {low + a, low + b, high + b, high + c},
                                            {low + a, high + a, high + b, high + c}}) {
        const auto& p = linear.points;
        if ((p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).dot(p[t[3]] - p[t[0]]) < 0) std::swap(t[2], t[3]);
        linear.tets.push_back(t);
      }
    }
  }
  linear.regions.assign(linear.tets.size(), 0);
  return mesh::make_quadratic(linear);
}

// Slides along the three planes of symmetry.
Body cut() {
  Body body;
  body.material.young = kYoung;
  body.diagonal = std::sqrt(3.0) * kOuter;
  for (int k = 0; k < 3; ++k) {
    SupportScene slider;
    slider.type = SupportScene::Type::slider;
    slider.point = 1e-9 * Vector3d::Unit(k);
    slider.normal = Vector3d::Unit(k);
    body.supports.push_back(slider);
  }
  body.support_surfaces.resize(3);
  return body;
}

struct Walls {
  double inner = 0.0, outer = 0.0;  // m, mean displacement of the corners on each
};

// Nominal stress (Pa) of a closed form, in the radial and in the hoop direction at a radius (m).
struct Hoop {
  double radial = 0.0, hoop = 0.0;
};

// The facets leave the spheres, where there would be a pressure or none. Loaded by the closed form's own stress where
// they stand, they have the closed form for their exact solution: no geometric error is left.
template <class Stress>
Walls inflate(int cells, const fem::Material& material, Stress&& stress) {
  const mesh::TetMesh mesh = octant(cells, std::max(2, cells / 2));
  const VectorXd force =
      test::face_loads(mesh, [&](const Vector3d& middle, const Vector3d& at, const Vector3d& normal) -> Vector3d {
        if (middle.minCoeff() < 1e-9) return {0, 0, 0};
        const Hoop s = stress(at.norm());
        const Vector3d out = at.normalized();
        return s.hoop * normal + (s.radial - s.hoop) * out.dot(normal) * out;
      });
  const fem::ElasticEnergy elastic(mesh, {material});
  const BedEnergy bed(cut(), mesh);
  fem::Minimiser minimiser(mesh, std::vector<char>(mesh.nodes.size(), 0));
  VectorXd x = test::stacked(mesh);
  const VectorXd rest = x;
  fem::MinimiserOptions options;
  options.energy_tolerance = 1e-8 * force.squaredNorm() / (kYoung * kInner);
  options.residual_tolerance = 1e-5;
  const fem::MinimiserResult r = minimiser.minimise(test::Loaded(elastic, force, &bed), x, options);
  EXPECT_TRUE(r.converged) << r.cause;
  Walls sum;
  int inner = 0, outer = 0;
  for (std::int32_t n = 0; n < mesh.corner_count; ++n) {
    const double radius = mesh.nodes[n].norm(), moved = x.segment<3>(3 * n).norm() - rest.segment<3>(3 * n).norm();
    if (radius < kInner * (1 + 1e-9)) sum.inner += moved, ++inner;
    if (radius > kOuter * (1 - 1e-9)) sum.outer += moved, ++outer;
  }
  return {sum.inner / inner, sum.outer / outer};
}

struct LameCase {
  const char* name;
  MaterialScene::Law law;
  double poisson;
};

// For the test's output; otherwise the bytes of the case are printed.
[[maybe_unused]] void PrintTo(const LameCase& c, std::ostream* out) { *out << c.name; }

class Lame : public ::testing::TestWithParam<LameCase> {};

TEST_P(Lame, DisplacementOfAThickWalledSphere) {
  const double nu = GetParam().poisson, pressure = 1e-4 * kYoung;
  const double a3 = std::pow(kInner, 3), b3 = std::pow(kOuter, 3), share = pressure * a3 / (b3 - a3);
  const auto exact = [&](double r) { return share / kYoung * ((1 - 2 * nu) * r + (1 + nu) * b3 / (2 * r * r)); };
  MaterialScene scene;
  scene.law = GetParam().law;
  scene.young = kYoung;
  scene.poisson = nu;
  const Walls walls = inflate(6, fem::make_material(scene), [&](double r) {
    return Hoop{share * (1 - b3 / (r * r * r)), share * (1 + b3 / (2 * r * r * r))};
  });
  EXPECT_NEAR(walls.inner / exact(kInner), 1, 0.01);
  EXPECT_NEAR(walls.outer / exact(kOuter), 1, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Laws, Lame,
                         ::testing::Values(LameCase{"Linear", MaterialScene::Law::linear, 0.3},
                                           LameCase{"NeoHookean", MaterialScene::Law::neo_hookean, 0.3},
                                           LameCase{"NearlyIncompressible", MaterialScene::Law::neo_hookean, 0.4999}),
                         [](const auto& c) { return std::string(c.param.name); });

// Green and Zerna's solution: r^3 = R^3 + const, and of the true stresses t_theta - t_r = mu (l^2 - l^-4) with l the
// hoop stretch, whose integral over the wall is the pressure 2 mu (1/l + 1/(4 l^4)) from the inner to the outer one.
TEST(NeoHookeanShell, InflationIsTheClosedForm) {
  const double mu = kYoung / 3, grown = (std::pow(1.3, 3) - 1) * std::pow(kInner, 3);
  const auto stretch = [&](double r) { return std::cbrt(1 + grown / (r * r * r)); };
  const auto primitive = [](double l) { return 1 / l + 1 / (4 * std::pow(l, 4)); };
  const fem::Material material = fem::Material::neo_hookean(2 * mu * 1.4999, 0.4999);
  const Walls walls = inflate(6, material, [&](double r) {
    const double l = stretch(r), radial = 2 * mu * (primitive(l) - primitive(stretch(kOuter)));
    return Hoop{l * l * radial, (radial + mu * (l * l - std::pow(l, -4))) / l};
  });
  EXPECT_NEAR(walls.inner / (0.3 * kInner), 1, 0.01);
  EXPECT_NEAR(walls.outer / ((stretch(kOuter) - 1) * kOuter), 1, 0.01);
}

}  // namespace
}  // namespace palpate::solve::thick_sphere_test
