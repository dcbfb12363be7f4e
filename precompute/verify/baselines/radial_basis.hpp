// SPDX-License-Identifier: GPL-3.0-or-later
// A network of radial basis functions on the samples of one pair: a baseline of `palpate bench --models`.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "formats/journal/samples.hpp"

namespace palpate::verify {

/// Force = sum of weights w[k] phi(|q - c[k]|), phi(r) = sqrt(r^2 + h^2) (Hardy 1971, the multiquadric), q the
/// deflection over (X, X, Z), its depth by the root, in which contact forces are smooth. Neither passive nor a
/// gradient, so that no file has it.
struct RadialBasis {
  Eigen::MatrixX3d centres;            ///< q at samples
  Eigen::MatrixX3d weights;            ///< N
  double breadth = 0.0;                ///< h
  double depth = 0.0, tangential = 0.0;  ///< m, Z and X

  /// N, at a deflection in [-X, X] x [-X, X] x [0, Z] (m).
  [[nodiscard]] Eigen::Vector3d force(const Eigen::Vector3d& deflection) const;
  /// In a file, centres and weights as 32-bit numbers.
  [[nodiscard]] static double bytes(int centres) { return 4.0 * 6 * centres; }
};

/// At most `centres` (> 0) of the samples' places, each the farthest from those before it, and the weights of least
/// squares, every sample by 1 / max(|force|, 2 % of the peak). Throws Error(numerical) as sort_samples does.
/// `depth`, `tangential`: Z and X (m).
RadialBasis fit_radial_basis(const std::vector<Sample>& samples, double depth, double tangential, int centres,
                             const std::string& what);

}  // namespace palpate::verify
