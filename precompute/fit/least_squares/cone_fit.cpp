// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/least_squares/cone_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "formats/io/error.hpp"

namespace palpate::fit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// By how much each stage weighs the residual more against the barriers.
constexpr double kSharper = 20;
constexpr int kMostStages = 60, kMostSteps = 200;
// Largest duality gap: kGap of the minimum, and kNoResidual of |target|^2 where the minimum vanishes.
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
      const VectorXd y = image(cone, x);
      const double room = inside(y);
      if (!(room > 0)) return HUGE_VAL;
      sum -= std::log(room);
    }
    return sum;
  }

  void add_slopes(const VectorXd& x, VectorXd& gradient, MatrixXd& hessian) const {
    for (const Cone& cone : cones_) {
      const VectorXd y = image(cone, x);
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
      const MatrixXd turned = h * cone.rows;
      for (std::size_t j = 0; j < cone.of.size(); ++j) {
        const auto column = static_cast<Index>(j);
        gradient[cone.of[j]] += cone.rows.col(column).dot(g);
        for (std::size_t i = 0; i < cone.of.size(); ++i) {
          hessian(cone.of[i], cone.of[j]) += cone.rows.col(static_cast<Index>(i)).dot(turned.col(column));
        }
      }
    }
  }

private:
  // Loops in place of Eigen's indexed views, which take ten seconds to compile.
  static VectorXd image(const Cone& cone, const VectorXd& x) {
    VectorXd y = VectorXd::Zero(cone.rows.rows());
    for (std::size_t j = 0; j < cone.of.size(); ++j) y += x[cone.of[j]] * cone.rows.col(static_cast<Index>(j));
    return y;
  }

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
  const Index n = matrix.cols();
  const MatrixXd square = matrix.transpose() * matrix;
  const auto residual = [&](const VectorXd& x) { return 0.5 * (matrix * x.head(n) - target).squaredNorm(); };
  VectorXd x = start;
  if (!std::isfinite(barriers.value(x))) throw Error(ExitCode::numerical, what + ": no start inside the constraints");
  const double floor = kNoResidual * target.squaredNorm();
  double weight = barriers.degree() / std::max(residual(x), floor);
  for (int stage = 0; stage < kMostStages; ++stage, weight *= kSharper) {
    for (int step = 0;; ++step) {
      if (step == kMostSteps) throw Error(ExitCode::numerical, what + ": the fit did not converge");
      VectorXd gradient = VectorXd::Zero(x.size());
      MatrixXd hessian = MatrixXd::Zero(x.size(), x.size());
      gradient.head(n) = weight * (matrix.transpose() * (matrix * x.head(n) - target));
      hessian.topLeftCorner(n, n) = weight * square;
      const VectorXd pull = gradient;
      barriers.add_slopes(x, gradient, hessian);
      const VectorXd way = -hessian.ldlt().solve(gradient);
      const double fall = -gradient.dot(way);
      if (!(fall > kCentred)) break;
      // As a difference: the residual itself is so much larger that rounding would hide what it falls by.
      const double slope = pull.dot(way), bend = weight * (matrix * way.head(n)).squaredNorm(),
                   here = barriers.value(x);
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
