// SPDX-License-Identifier: MIT
// Stiffness that a contact has now, for the steps of a joint solve.
#pragma once

#include "palpate/contact/contact.hpp"

#include <cmath>

namespace palpate::runtime {

/// Slope of a contact's force: `normal` along n, `across` across it, as square roots (sqrt(N/m)); 0 without contact.
struct ContactSlope {
  /// Least share of the tangential stiffness that a contact counts with; 0 would never grow again.
  static constexpr double kLeastGrip = 1e-3;

  Vec3 n{0, 0, 1}, axis{1, 0, 0};
  double normal = 0, across = 0;

  ContactSlope() = default;
  /// `grip`: share of the tangential stiffness that does not slip.
  template <std::uint32_t kFeatures>
  ContactSlope(const BasicContact<kFeatures>& contact, double grip) {
    const ContactState& state = contact.state();
    if (!state.touching) return;
    n = state.place.normal;
    axis = state.place.axis;
    normal = std::sqrt(larger(0, state.applied.normal_slope));
    across = std::sqrt(grip * larger(0, state.applied.tangential_slope));
  }

  /// The slope K times a vector.
  [[nodiscard]] Vec3 times(const Vec3& v) const {
    const double square = across * across;
    return square * v + ((normal * normal - square) * dot(n, v)) * n;
  }

  /// The slope of f / h' over h, for the force f (N) and a stretched depth h of which `stretch` is h' and `bend` (1/m)
  /// h''.
  [[nodiscard]] ContactSlope over_stretched(double force, double stretch, double bend) const {
    ContactSlope slope = *this;
    slope.normal = std::sqrt(larger(0, normal * normal - force * bend / stretch)) / stretch;
    slope.across = across / stretch;
    return slope;
  }

  /// R with K = R R^T has so many columns: none without contact, one without friction.
  [[nodiscard]] int columns() const { return !(normal > 0) ? 0 : across > 0 ? 3 : 1; }
  /// sqrt(N/m), column `i` of R.
  [[nodiscard]] Vec3 column(int i) const {
    if (i == 0) return normal * n;
    return across * (i == 1 ? axis : cross(n, axis));
  }

  /// Learns `grip`, with which this slope was made, from a motion `way` (m) of the tool that changed the force by
  /// `change` (N): less where the contact slips.
  void learn_grip(const Vec3& way, const Vec3& change, double& grip) const {
    const Vec3 aside = tangential(way, n);
    const double square = dot(aside, aside), stiffness = across * across / grip;
    if (stiffness * square > 0) grip = clamped(-dot(change, aside) / (stiffness * square), kLeastGrip, 1);
  }
};

}  // namespace palpate::runtime
