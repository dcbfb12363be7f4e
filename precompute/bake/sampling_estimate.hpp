// SPDX-License-Identifier: GPL-3.0-or-later
// How far off responses between sites are.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace palpate::bake {

struct SamplingEstimate {
  int rounds = 0;          ///< that were solved
  std::size_t places = 0;  ///< hidden pushes that were compared
  /// Of |interpolated - solved| / max(solved, 2 % of the place's peak, response.floor) at the hidden pushes.
  double median = 0.0, hidden_p95 = 0.0, worst = 0.0;
  Eigen::Vector3d worst_at{0, 0, 0};  ///< m
  double edges_p95 = 0.0;             ///< of the same over the area, predicted from the sites
  bool met = false;                   ///< p95() is within the aim of the rounds

  /// Their mean: hidden pushes are a fair sample, but a small one; edges are many, but their errors are predicted. The
  /// latter alone where no hidden push was solved.
  [[nodiscard]] double p95() const { return places > 0 ? (hidden_p95 + edges_p95) / 2 : edges_p95; }
};

}  // namespace palpate::bake
