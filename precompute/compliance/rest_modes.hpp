// SPDX-License-Identifier: GPL-3.0-or-later
// Few modes that stand for a smooth symmetric matrix of which some columns are known.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::compliance {

/// R = vectors * diag(signs) * vectors^T; positive signs first.
struct SignedModes {
  Eigen::MatrixXd vectors;
  Eigen::Index negative = 0;

  /// Columns `rows` of R, for all its rows.
  [[nodiscard]] Eigen::MatrixXd columns(const std::vector<Eigen::Index>& rows) const;
};

/// The `count` modes of R that its columns `known` (values: all rows of them) determine: with the first left singular
/// vectors Q of the values, R is Q M Q^T with the M of least squares (generalised Nystroem method, Nakatsukasa 2020).
/// `count`: at most a column's number of values and the number of columns.
SignedModes rest_modes(const Eigen::MatrixXd& values, const std::vector<Eigen::Index>& known, Eigen::Index count);

}  // namespace palpate::compliance
