// SPDX-License-Identifier: GPL-3.0-or-later
// A sphere on a thin incompressible layer bonded to its bed, through the entry point that the bake uses: Dimitriadis'
// series, and the exact contact of linear elasticity, from which the series strays as the contact grows wide.
#include "precompute/geometry/solids.hpp"
#include "tests/solve/two_domains.hpp"
#include "tests/support/press.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <vector>

namespace palpate::thin_layer_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Over Hertz' force at the same depth, x = sqrt(R d) / h (Dimitriadis et al. 2002, equation 14 at nu 0.5).
double dimitriadis(double x) { return 1 + x * (1.133 + x * (1.283 + x * (0.769 + x * 0.0975))); }

struct LayerContact {
  double x = 0.0;           // sqrt(R d) / h
  double over_hertz = 0.0;  // force
};

// Exact at small strain for the contact radius a in thicknesses: the Fredholm equation of the paraboloid on a bonded
// layer (Lebedev and Ufliand 1958). With s the wave number times h, 1 - K(s) is how far the layer's surface falls short
// of the half-space's; phi(t) - 1/pi int_0^a (M(t - u) + M(t + u)) phi(u) du = d - t^2/R, M(v) = int_0^inf (1 - K)
// cos(s v) ds, phi(a) = 0, F = 2 E/(1 - nu^2) int_0^a phi. Lengths in thicknesses, R = 1.
LayerContact exact_contact(double a) {
  const auto kernel = [](double v) {  // Simpson's rule; 1 - K falls like s^2 exp(-2 s)
    constexpr int kSteps = 400;
    constexpr double kEnd = 20;
    double sum = 0;
    for (int k = 0; k <= kSteps; ++k) {
      const double s = kEnd * k / kSteps;
      const double given = (std::sinh(2 * s) - 2 * s) / (std::cosh(2 * s) + 2 * s * s + 1);  // nu 0.5
      sum += (k == 0 || k == kSteps ? 1 : k % 2 == 1 ? 4 : 2) * (1 - given) * std::cos(s * v);
    }
    return sum * kEnd / kSteps / 3;
  };
  constexpr int kPoints = 24;  // Gauss-Legendre would need a table; the midpoint rule is as good at 0.1 %
  MatrixXd system = MatrixXd::Zero(kPoints + 1, kPoints + 1);
  VectorXd right(kPoints + 1);
  const double width = a / kPoints;
  for (int i = 0; i <= kPoints; ++i) {
    const double t = i < kPoints ? (i + 0.5) * width : a;
    for (int j = 0; j < kPoints; ++j) {
      const double u = (j + 0.5) * width;
      system(i, j) = (i == j ? 1.0 : 0.0) - width / std::numbers::pi * (kernel(t - u) + kernel(t + u));
    }
    system(i, kPoints) = -1;  // of the depth
    right[i] = -t * t;
  }
  const VectorXd phi = Eigen::FullPivLU<MatrixXd>(system).solve(right);
  const double depth = phi[kPoints];
  return {std::sqrt(depth), 2 * width * phi.head(kPoints).sum() / (4.0 / 3 * std::pow(depth, 1.5))};
}

// The same at a given x.
double exact(double x) {
  double low = 0.1 * x, high = 2 * x;
  for (int k = 0; k < 12; ++k) {
    const double a = (low + high) / 2;
    (exact_contact(a).x < x ? low : high) = a;
  }
  return exact_contact((low + high) / 2).over_hertz;
}

// Beyond a narrow contact the series falls short of what it approximates.
TEST(ThinLayer, TheSeriesIsTheExactContactWhereItIsNarrow) {
  EXPECT_NEAR(exact(0.1) / dimitriadis(0.1), 1, 0.005);
  EXPECT_NEAR(exact(0.5) / dimitriadis(0.5), 1.084, 0.01);
  EXPECT_GT(exact(1.0) / dimitriadis(1.0), 1.1);
}

// A sphere of ten thicknesses, pressed a tenth of one deep, on layers of twelve and sixteen thicknesses square.
TEST(ThinLayer, SphereForce) {
  constexpr double kYoung = 5e3, kThickness = 0.001, kRadius = 10 * kThickness, kDepth = 0.1 * kThickness;
  Scene scene;
  scene.material.young = kYoung;
  scene.material.poisson = 0.4999;
  SupportScene bed;
  bed.point = {0, 0, -kThickness * (1 - 1e-6)};
  scene.supports = {bed};
  PairPath path;
  path.normal_depths = {0.1 * kDepth, 0.25 * kDepth, 0.5 * kDepth, kDepth};
  PairOptions options;
  options.mesh_size = 0.25;
  ToolScene sphere;
  sphere.radius = kRadius;
  const test::TwoDomains two = test::on_two_domains(6, 8, [&](double size) {
    const double half = size * kThickness;
    const Surface layer = box_solid({-half, -half, -kThickness}, {half, half, 0}, kThickness, "layer");
    const PairResult r = test::press(prepare_body(scene, layer), sphere, path, options);
    EXPECT_TRUE(r.outcome.accepted) << r.outcome.cause;
    std::vector<double> over_law;
    for (const Sample& s : r.samples) {
      const double d = s.deflection.z(), x = std::sqrt(kRadius * d) / kThickness;
      const double over_hertz = s.force.z() / (16.0 / 9 * kYoung * std::sqrt(kRadius) * std::pow(d, 1.5));
      over_law.push_back(over_hertz / exact(x));
      if (x < 0.35) {
        EXPECT_NEAR(over_hertz / dimitriadis(x), 1, 0.05) << "sqrt(R d) / h " << x;
      }
    }
    return over_law;
  });
  EXPECT_EQ(two.endless.size(), path.normal_depths.size());
  test::expect_law(two, 0.05);
}

}  // namespace
}  // namespace palpate::thin_layer_test
