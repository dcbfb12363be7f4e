// SPDX-License-Identifier: GPL-3.0-or-later
// With s the wave number times h, 1 - K(s) is how far the layer's surface falls short of the half-space's;
// phi(t) - 1/pi int_0^a (M(t - u) + M(t + u)) phi(u) du = d - t^2/R, M(v) = int_0^inf (1 - K) cos(s v) ds, phi(a) = 0,
// F = 2 E/(1 - nu^2) int_0^a phi. Lengths in thicknesses, R = 1.
#include "precompute/verify/bonded_layer.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace palpate::verify {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct LayerContact {
  double x = 0.0;           // sqrt(R d) / h
  double over_hertz = 0.0;  // force
};

// M(v), by Simpson's rule; 1 - K falls like s^2 exp(-2 s).
double kernel(double v) {
  constexpr int kSteps = 400;
  constexpr double kEnd = 20;
  double sum = 0;
  for (int k = 0; k <= kSteps; ++k) {
    const double s = kEnd * k / kSteps;
    const double given = (std::sinh(2 * s) - 2 * s) / (std::cosh(2 * s) + 2 * s * s + 1);  // nu 0.5
    sum += (k == 0 || k == kSteps ? 1 : k % 2 == 1 ? 4 : 2) * (1 - given) * std::cos(s * v);
  }
  return sum * kEnd / kSteps / 3;
}

// For the contact radius a in thicknesses.
LayerContact exact_contact(double a) {
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

}  // namespace

double bonded_layer_series(double x) { return 1 + x * (1.133 + x * (1.283 + x * (0.769 + x * 0.0975))); }

double bonded_layer_exact(double x) {
  double low = 0.1 * x, high = 2 * x;
  for (int k = 0; k < 12; ++k) {
    const double a = (low + high) / 2;
    (exact_contact(a).x < x ? low : high) = a;
  }
  return exact_contact((low + high) / 2).over_hertz;
}

}  // namespace palpate::verify
