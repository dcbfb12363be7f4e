// SPDX-License-Identifier: MIT
// Curves over depths of either sign, which what a grasp answers to moves and to turns is made of.
#pragma once

#include "palpate/format/response_layout.hpp"
#include "palpate/format/spline.hpp"

namespace palpate::grasp {

/// x and y across the normal, n along it; of a deflection, n is the depth.
struct Triple {
  double x, y, n;
};

/// kCount splines over u = (z / L + 1) / 2, L = layout::kBondedRange times the depth scale. Beyond 0 and 1 the first
/// three go on linearly; the others keep their values, which they reach without a slope. Fixed size, no allocation.
template <int kCount>
class Curves {
public:
  /// Forgets everything. `count` coefficients a curve, 4 to 32; depth scale in m.
  void clear(int count, double depth_scale) {
    count_ = count;
    range_ = layout::kBondedRange * depth_scale;
    for (int i = 0; i < kCount * count; ++i) coefs_[i] = 0;
  }

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] double range() const { return range_; }  ///< m, L
  /// One curve's coefficients after the other's.
  [[nodiscard]] const double* coefs() const { return coefs_; }
  [[nodiscard]] double* coefs() { return coefs_; }

  /// All curves at one depth, and their slopes by the depth.
  struct AtDepth {
    double value[kCount], slope[kCount];
  };
  [[nodiscard]] AtDepth at(double z) const {
    const double u = 0.5 * (z / range_ + 1), inside = u > 0 ? (u < 1 ? u : 1) : 0;
    const spline::Basis value = spline::basis(count_, inside), slope = spline::slope_basis(count_, inside);
    AtDepth terms;
    for (int k = 0; k < kCount; ++k) {
      const double* curve = coefs_ + k * count_;
      const double rise = spline::combine(slope, curve);
      terms.value[k] = spline::combine(value, curve) + (k < 3 ? (u - inside) * rise : 0);
      terms.slope[k] = 0.5 * rise / range_;
    }
    return terms;
  }

private:
  int count_ = 0;
  double range_ = 1;
  double coefs_[kCount * layout::kMaxCoefs] = {};
};

}  // namespace palpate::grasp
