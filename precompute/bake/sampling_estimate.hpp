// SPDX-License-Identifier: GPL-3.0-or-later
// How far off responses between sites are, by pushes that no response is made of.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace palpate::bake {

struct SamplingEstimate {
  int rounds = 0;          ///< that were solved
  std::size_t places = 0;  ///< hidden pushes that were compared
  /// Of |interpolated - solved| / max(solved, 2 % of the place's peak, response.floor).
  double median = 0.0, p95 = 0.0, worst = 0.0;
  Eigen::Vector3d worst_at{0, 0, 0};  ///< m
  bool met = false;                   ///< p95 is within the aim of the rounds
};

}  // namespace palpate::bake
