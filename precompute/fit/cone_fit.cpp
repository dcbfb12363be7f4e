// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/cone_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "formats/error.hpp"

namespace palpate::fit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// By how much each stage weighs the residual more against the barriers.
constexpr double kSharper = 20;
constexpr int kMostStages = 60, kMostSteps = 200;
// Of the minimum, and of |target|^2 where the minimum is none.
constexpr double kGap = 1e-6, kNoResidual = 1e-16;
// A stage ends with a Newton decrement of the square root of this, or with steps shorter than that share of Newton's.
constexpr double kCentred = 1e-6, kShortest = 1e-10;

/// -log(y0), or -log(y0^2 - |v|^2), of y = (y0, v) = rows * x(of); infinite outside.
class Barriers {
public:
  explicit Barriers(const std::vector<Cone>& cones) : cones_(cones) {}

  /// The sum of their degrees: by as much over the weight of the residual the path's point is off the minimum.
  [[nodiscard]] double degree() const {
    double sum = 0;
    for (const Cone& cone : cones_) sum += cone.rows.rows() > 1 ? 2 : 1;
    return sum;
  }

  [[nodiscard]] double value(const VectorXd& x) const {
    double sum = 0;
    for (const Cone& cone : cones_) {
      const VectorXd y = cone.rows * x(cone.of);
      const double room = inside(y);
      if (!(room > 0)) return HUGE_VAL;
      sum -= std::log(room);
    }
    return sum;
  }

  void add_slopes(const VectorXd& x, VectorXd& gradient, MatrixXd& hessian) const {
    for (const Cone& cone : cones_) {
      const VectorXd y = cone.rows * x(cone.of);
      const double room = inside(y);
      VectorXd g(y.size());
      MatrixXd h(y.size(), y.size());
      if (y.size() == 1) {
        g[0] = -1 / room;
        h(0, 0) = g[0] * g[0];
      } else {
        g = y;
        g[0] = -g[0];
        g *= 2 / room;
        h = g * g.transpose();
        h.diagonal().array() += 2 / room;
        h(0, 0) -= 4 / room;
      }
      gradient(cone.of) += cone.rows.transpose() * g;
      hessian(cone.of, cone.of) += cone.rows.transpose() * h * cone.rows;
    }
  }

private:
  static double inside(const VectorXd& y) {
    if (y.size() == 1 || !(y[0] > 0)) return y[0];
    const double size = y.tail(y.size() - 1).norm();
    return (y[0] - size) * (y[0] + size);
  }

  const std::vector<Cone>& cones_;
};

}  // namespace

VectorXd solve_in_cones(const MatrixXd& matrix, const VectorXd& target, const std::vector<Cone>& cones,
                        const VectorXd& start, const std::string& what) {
  if (!matrix.allFinite() || !target.allFinite() || !start.allFinite()) {
    throw Error(ExitCode::numerical, what + ": a sample is not a finite number");
  }
  const Barriers barriers(cones);
  // As many rows as columns say the same: |A x - b|^2 = |R x - Q' b|^2 + what no x changes.
  const Index n = matrix.cols();
  MatrixXd rows = MatrixXd::Zero(n, n);
  VectorXd right = VectorXd::Zero(n);
  const Index most = std::min(n, matrix.rows());
  const Eigen::HouseholderQR<MatrixXd> qr(matrix);
  rows.topRows(most) = qr.matrixQR().topRows(most).triangularView<Eigen::Upper>();
  right.head(most) = (qr.householderQ().adjoint() * target).head(most);
  const MatrixXd square = rows.transpose() * rows;
  const double rest = 0.5 * std::max(target.squaredNorm() - right.squaredNorm(), 0.0);
  const auto residual = [&](const VectorXd& x) { return rest + 0.5 * (rows * x.head(n) - right).squaredNorm(); };
  VectorXd x = start;
  if (!std::isfinite(barriers.value(x))) throw Error(ExitCode::numerical, what + ": no start inside the constraints");
  const double floor = kNoResidual * target.squaredNorm();
  double weight = barriers.degree() / std::max(residual(x), floor);
  for (int stage = 0; stage < kMostStages; ++stage, weight *= kSharper) {
    for (int step = 0;; ++step) {
      if (step == kMostSteps) throw Error(ExitCode::numerical, what + ": the fit did not converge");
      VectorXd gradient = VectorXd::Zero(x.size());
      MatrixXd hessian = MatrixXd::Zero(x.size(), x.size());
      gradient.head(n) = weight * (rows.transpose() * (rows * x.head(n) - right));
      hessian.topLeftCorner(n, n) = weight * square;
      const VectorXd pull = gradient;
      barriers.add_slopes(x, gradient, hessian);
      const VectorXd way = -hessian.ldlt().solve(gradient);
      const double fall = -gradient.dot(way);
      if (!(fall > kCentred)) break;
      // As a difference: the residual itself is so much larger that rounding would hide what it falls by.
      const double slope = pull.dot(way), bend = weight * (rows * way.head(n)).squaredNorm(), here = barriers.value(x);
      double share = 1;
      const auto rise = [&] { return share * (slope + 0.5 * share * bend) + barriers.value(x + share * way) - here; };
      while (share > kShortest && !(rise() <= -0.1 * share * fall)) share *= 0.5;
      if (!(share > kShortest)) break;  // nothing but rounding is left
      x += share * way;
    }
    if (barriers.degree() / weight <= std::max(kGap * residual(x), floor)) return x;
  }
  throw Error(ExitCode::numerical, what + ": the fit did not converge");
}

}  // namespace palpate::fit
