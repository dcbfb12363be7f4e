// SPDX-License-Identifier: MIT
// The law of a bonded contact: the force of a deflection is the gradient of an energy, so that no closed motion does work.
#pragma once

#include "palpate/format/response_layout.hpp"
#include "palpate/format/spline.hpp"

#include <cmath>

/// With z the depth, negative while the tool pulls, and L = layout::kBondedRange times the depth scale, the stored
/// energy and the force on the tool are
///
///     W = integral of Fn dz - Fx x - Fy y + (kxx x^2 + 2 kxy x y + kyy y^2) / 2,     f = (-dW/dx, -dW/dy, dW/dz).
///
/// The curves continue beyond -L and L (Curves). f is continuous, and the gradient of one W, everywhere.
namespace palpate::bonded {

/// x and y across the normal, n along it; of a deflection, n is the depth.
struct Triple {
  double x, y, n;
};

/// kCount splines over u = (z / L + 1) / 2, with L = layout::kBondedRange times the depth scale. Beyond 0 and 1 the first
/// three continue linearly. The others keep their values, which they reach without a slope. Fixed size, no allocation.
template <int kCount>
class Curves {
public:
  /// Removes all responses. `count` coefficients a curve, 4 to 32; depth scale in m.
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

/// Curves of one response or of a blend. Fixed size, no allocation.
class Law {
public:
  using AtDepth = Curves<static_cast<int>(layout::kBondedCurves)>::AtDepth;

  /// Removes all responses. `count` coefficients a curve, 4 to 32; depth scale in m.
  void clear(int count, double depth_scale) { curves_.clear(count, depth_scale); }

  /// Adds a response's curves (Fx, Fy, Fn, kxx, kxy, kyy) with a weight; (cosine, sine) of the angle of its x axis in
  /// this law's frame.
  template <class Scalar>
  void add(const Scalar* curves, double weight, double cosine = 1, double sine = 0) {
    const int n = curves_.count();
    const double c = cosine, s = sine;
    double* const sum = curves_.coefs();
    for (int i = 0; i < n; ++i) {
      const auto of = [&](int curve) { return weight * static_cast<double>(curves[curve * n + i]); };
      const double fx = of(0), fy = of(1), xx = of(3), xy = of(4), yy = of(5);
      sum[i] += c * fx - s * fy;
      sum[n + i] += s * fx + c * fy;
      sum[2 * n + i] += of(2);
      sum[3 * n + i] += c * c * xx - 2 * c * s * xy + s * s * yy;
      sum[4 * n + i] += c * s * (xx - yy) + (c * c - s * s) * xy;
      sum[5 * n + i] += s * s * xx + 2 * c * s * xy + c * c * yy;
    }
  }

  /// layout::kBondedCurves curves of `count` coefficients each.
  [[nodiscard]] const double* coefs() const { return curves_.coefs(); }
  [[nodiscard]] double range() const { return curves_.range(); }  ///< m, L
  [[nodiscard]] AtDepth at(double z) const { return curves_.at(z); }

  /// Force on the tool (N) at a deflection (m).
  [[nodiscard]] Triple force(const Triple& d) const { return force(at(d.n), d.x, d.y); }
  [[nodiscard]] static Triple force(const AtDepth& t, double x, double y) {
    return {t.value[0] - t.value[3] * x - t.value[4] * y, t.value[1] - t.value[4] * x - t.value[5] * y,
            t.value[2] - t.slope[0] * x - t.slope[1] * y +
                0.5 * (t.slope[3] * x * x + 2 * t.slope[4] * x * y + t.slope[5] * y * y)};
  }

  /// Sets a deflection that answers with this force (N). False where there is none up to a depth of kGraspRange depth
  /// scales, in or out.
  [[nodiscard]] bool find(const Triple& force, Triple& deflection) const {
    return find_depth(range(), [&](double z) { return excess(z, force, deflection); });
  }

  /// Bisects for the depth in [-range, range] at which `excess` changes from below 0 to 0 or more, and calls it there
  /// last. False where it does not change its sign so, or is NaN there.
  template <class Excess>
  [[nodiscard]] static bool find_depth(double range, const Excess& excess) {
    double low = -range, high = range;
    if (!(excess(low) < 0 && excess(high) >= 0)) return false;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (excess(middle) < 0 ? low : high) = middle;
    }
    return excess(high) >= 0;
  }

private:
  /// Normal force less the wanted one at the x and y with the wanted tangential force, which it sets with n = z. NaN
  /// where no x and y have that force.
  [[nodiscard]] double excess(double z, const Triple& wanted, Triple& deflection) const {
    const AtDepth t = at(z);
    const double xx = t.value[3], xy = t.value[4], yy = t.value[5], size = xx * yy - xy * xy;
    const double fx = t.value[0] - wanted.x, fy = t.value[1] - wanted.y;
    if (!(size > 1e-9 * (xx + yy) * (xx + yy))) return std::nan("");
    deflection = {(yy * fx - xy * fy) / size, (xx * fy - xy * fx) / size, z};
    return force(t, deflection.x, deflection.y).n - wanted.n;
  }

  Curves<static_cast<int>(layout::kBondedCurves)> curves_;
};

}  // namespace palpate::bonded
