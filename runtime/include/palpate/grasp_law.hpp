// SPDX-License-Identifier: MIT
// What a bonded contact answers to any deflection: the gradient of an energy, so that no motion gains any.
#pragma once

#include "palpate/response_layout.hpp"
#include "palpate/spline.hpp"

#include <cmath>

/// With z the depth, negative while the tool pulls, and u = (z / L + 1) / 2, L = layout::kGraspRange times the depth
/// scale, the stored energy and the force on the tool are
///
///     W = integral of Fn dz - Fx x - Fy y + (kxx x^2 + 2 kxy x y + kyy y^2) / 2,     f = (-dW/dx, -dW/dy, dW/dz).
///
/// The curves are splines over u. Beyond 0 and 1 forces go on linearly and stiffnesses keep their values, which they
/// reach without a slope: f is continuous, and the gradient of one W, everywhere.
namespace palpate::grasp {

/// x and y across the normal, n along it; of a deflection, n is the depth.
struct Triple {
  double x, y, n;
};

/// Curves of one response or of a blend, ready to be evaluated. Fixed size, no allocation.
class Law {
public:
  /// Forgets everything. `count` coefficients a curve, 4 to 32; depth scale in m.
  void clear(int count, double depth_scale) {
    count_ = count;
    range_ = layout::kGraspRange * depth_scale;
    for (int i = 0; i < kCurves * count; ++i) coefs_[i] = 0;
  }

  /// Adds a response's curves (Fx, Fy, Fn, kxx, kxy, kyy) with a weight; (cosine, sine) of the angle of its x axis in
  /// this law's frame.
  template <class Scalar>
  void add(const Scalar* curves, double weight, double cosine = 1, double sine = 0) {
    const int n = count_;
    const double c = cosine, s = sine;
    for (int i = 0; i < n; ++i) {
      const auto of = [&](int curve) { return weight * static_cast<double>(curves[curve * n + i]); };
      const double fx = of(0), fy = of(1), xx = of(3), xy = of(4), yy = of(5);
      coefs_[i] += c * fx - s * fy;
      coefs_[n + i] += s * fx + c * fy;
      coefs_[2 * n + i] += of(2);
      coefs_[3 * n + i] += c * c * xx - 2 * c * s * xy + s * s * yy;
      coefs_[4 * n + i] += c * s * (xx - yy) + (c * c - s * s) * xy;
      coefs_[5 * n + i] += s * s * xx + 2 * c * s * xy + c * c * yy;
    }
  }

  /// layout::kGraspCurves curves of `count` coefficients each.
  [[nodiscard]] const double* coefs() const { return coefs_; }

  /// Force on the tool (N) at a deflection (m).
  [[nodiscard]] Triple force(const Triple& d) const { return force(at(d.n), d.x, d.y); }

  /// Sets a deflection that answers with this force (N). False where there is none up to a depth of kGraspRange depth
  /// scales, in or out.
  [[nodiscard]] bool find(const Triple& force, Triple& deflection) const {
    double low = -range_, high = range_;
    // Less, and no less, than the force along the normal.
    if (!(excess(low, force, deflection) < 0 && excess(high, force, deflection) >= 0)) return false;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (excess(middle, force, deflection) < 0 ? low : high) = middle;
    }
    return excess(high, force, deflection) >= 0;
  }

private:
  static constexpr int kCurves = static_cast<int>(layout::kGraspCurves);

  /// All curves at one depth, and their slopes by the depth.
  struct AtDepth {
    double value[kCurves], slope[kCurves];
  };
  [[nodiscard]] AtDepth at(double z) const {
    const double u = 0.5 * (z / range_ + 1), inside = u > 0 ? (u < 1 ? u : 1) : 0;
    const spline::Basis value = spline::basis(count_, inside), slope = spline::slope_basis(count_, inside);
    AtDepth terms;
    for (int k = 0; k < kCurves; ++k) {
      const double* curve = coefs_ + k * count_;
      const double rise = spline::combine(slope, curve);
      terms.value[k] = spline::combine(value, curve) + (k < 3 ? (u - inside) * rise : 0);
      terms.slope[k] = 0.5 * rise / range_;
    }
    return terms;
  }

  [[nodiscard]] static Triple force(const AtDepth& t, double x, double y) {
    return {t.value[0] - t.value[3] * x - t.value[4] * y, t.value[1] - t.value[4] * x - t.value[5] * y,
            t.value[2] - t.slope[0] * x - t.slope[1] * y +
                0.5 * (t.slope[3] * x * x + 2 * t.slope[4] * x * y + t.slope[5] * y * y)};
  }

  /// Force along the normal, less the wanted one, where x and y, which it sets with n = z, answer with the wanted
  /// sideways force; no number where no x and y do.
  [[nodiscard]] double excess(double z, const Triple& wanted, Triple& deflection) const {
    const AtDepth t = at(z);
    const double xx = t.value[3], xy = t.value[4], yy = t.value[5], size = xx * yy - xy * xy;
    const double fx = t.value[0] - wanted.x, fy = t.value[1] - wanted.y;
    if (!(size > 1e-9 * (xx + yy) * (xx + yy))) return std::nan("");
    deflection = {(yy * fx - xy * fy) / size, (xx * fy - xy * fx) / size, z};
    return force(t, deflection.x, deflection.y).n - wanted.n;
  }

  int count_ = 0;
  double range_ = 1;  ///< m, L
  double coefs_[kCurves * layout::kMaxCoefs] = {};
};

}  // namespace palpate::grasp
