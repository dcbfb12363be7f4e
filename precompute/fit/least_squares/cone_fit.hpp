// SPDX-License-Identifier: GPL-3.0-or-later
// Linear least squares over second-order cones: one minimum, and it is found.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace palpate::fit {

/// The first of rows * x(of) is at least the length of the others; of one row alone: at least 0.
struct Cone {
  std::vector<Eigen::Index> of;
  Eigen::MatrixXd rows;  ///< as many columns as `of` has entries
};

/// Minimises |matrix x.head(matrix.cols()) - target|^2 over x inside all cones, from a start inside them: Newton's
/// method along the central path of logarithmic barriers (Boyd and Vandenberghe, Convex Optimization, section 11.3),
/// until what may be left to gain is below a millionth of the minimum. Throws Error(numerical) "what: ..." when an
/// entry is not finite, the start is not inside, or the path is lost.
Eigen::VectorXd solve_in_cones(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& target,
                               const std::vector<Cone>& cones, const Eigen::VectorXd& start, const std::string& what);

}  // namespace palpate::fit
