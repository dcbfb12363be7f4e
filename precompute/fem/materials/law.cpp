// SPDX-License-Identifier: GPL-3.0-or-later
// Shared functions of all laws.
#include "precompute/fem/materials/law.hpp"

#include "precompute/algebra/spectrum.hpp"

#include <algorithm>

namespace palpate::fem {

Tangent positive_part(const Tangent& tangent) {
  const auto eigen = algebra::spectrum(tangent);
  const double least = 1e-6 * std::max(0.0, eigen.values[8]);
  return eigen.vectors * eigen.values.cwiseMax(least).asDiagonal() * eigen.vectors.transpose();
}

}  // namespace palpate::fem
