// SPDX-License-Identifier: MIT
// Up to three separable responses side by side: what grows with the depth, what follows a sideways deflection.
#pragma once

#include "palpate/pieces.hpp"
#include "palpate/view.hpp"

namespace palpate::runtime {

/// Sideways forces g(z) phi(r) of up to three responses, each in its body vertex' frame. All that a tick asks for is
/// computed for the six curves at once (first x and y of the first response, then of the second, ...), so that
/// compilers use vectors. What was asked for last is remembered for kParts deflections, each for itself: those of a
/// contact's core and rim (rim.hpp). Not for several threads at once.
template <int kParts>
class Triple {
public:
  static constexpr int kResponses = 3, kLanes = 2 * kResponses;
  using Lanes = double[kLanes];

  /// Of which file the responses are that are set from now on.
  void begin(const layout::Meta& meta) {
    growth_count_ = static_cast<int>(meta.growth_coefs);
    sideways_count_ = static_cast<int>(meta.sideways_coefs);
  }

  /// Response k, each of them once: its coefficients (gx, gy, phix, phiy), its weight, the angle of its x axis. Where
  /// it is the one that was there before, as while c slides within a patch, what is remembered of its curves stays
  /// good.
  void set(int k, const float* coefs, double weight, double cosine, double sine) {
    if (coefs_[k] != coefs) take_over(k, coefs);
    for (int axis = 0; axis < 2; ++axis) {
      const int lane = 2 * k + axis;
      weight_[lane] = weight;
      cosine_[lane] = cosine;
      sine_[lane] = axis == 0 ? sine : -sine;
    }
  }

  /// Weighted growths where all are on the intervals taken; t: in intervals.
  void growths(double t, Lanes& growth) const {
    Lanes at, g;
    for (double& each : at) each = t;
    growth_.known_values(at, g);
    weigh(g, growth);
  }

  /// Weighted growths at s in [0, 1], where nobody asked before nor is soon to ask again: takes no intervals.
  void growths_once(double s, Lanes& growth) const {
    const spline::Basis basis = spline::basis(growth_count_, s);
    Lanes g;
    for (int lane = 0; lane < kLanes; ++lane) g[lane] = spline::combine(basis, growth_coefs(lane));
    weigh(g, growth);
  }

  /// Takes the intervals at t. All have the one that is returned.
  int take_growths(double t) const {
    const int interval = spline::interval_of(growth_count_, t);
    if (interval == growth_interval_) return interval;
    for (int lane = 0; lane < kLanes; ++lane) growth_.take(lane, growth_coefs(lane), growth_count_, interval);
    growth_interval_ = interval;
    return interval;
  }

  /// Weighted growths beyond the depth scale, where the curves go on linearly by `extra`.
  void growths_beyond(double extra, Lanes& growth) const {
    Lanes g;
    for (int lane = 0; lane < kLanes; ++lane) g[lane] = spline::beyond(growth_coefs(lane), growth_count_, extra);
    weigh(g, growth);
  }

  /// Adds the force (N) at a deflection x, y (of the sideways scale) of a part. False, and nothing added, where phi is
  /// to be taken elsewhere (kTake does).
  template <bool kTake>
  bool add_force(const Lanes& growth, int part, double x, double y, double (&force)[2]) const {
    const double along[2] = {x, y}, half = 0.5 * (sideways_count_ - 3);
    Lanes r, t, phi, f;
    for (int k = 0; k < kLanes; ++k) r[k] = cosine_[k] * along[k % 2] + sine_[k] * along[1 - k % 2];
    for (int k = 0; k < kLanes; ++k) t[k] = (r[k] + 1) * half;
    if constexpr (kTake) {
      take_phi(part, r, t, phi);
    } else {
      if (!phi_[part].values(t, phi)) return false;
    }
    for (int k = 0; k < kLanes; ++k) f[k] = growth[k] * phi[k];
    for (int k = 0; k < kLanes; ++k) force[k % 2] += cosine_[k] * f[k] - sine_[k] * f[k ^ 1];
    return true;
  }

  /// There is no response k, while there is one 0.
  void leave_empty(int k) { set(k, coefs_[0], 0, 0, 0); }

  /// Of phi with these coefficients, where it goes on along its tangent above 1 (up) or below -1.
  [[nodiscard]] static double outward_slope(const float* coefs, int count, bool up) {
    return up ? spline::slope_at_1(coefs, count) : -spline::slope_at_0(coefs, count);
  }

private:
  void take_over(int k, const float* coefs) {
    coefs_[k] = coefs;
    growth_interval_ = -1;
    for (int lane = 2 * k; lane < 2 * k + 2; ++lane) {
      growth_.forget(lane);
      for (auto& phi : phi_) phi.forget(lane);
    }
  }

  [[nodiscard]] const float* growth_coefs(int lane) const { return coefs_[lane / 2] + (lane % 2) * growth_count_; }
  [[nodiscard]] const float* phi_coefs(int lane) const {
    return coefs_[lane / 2] + 2 * growth_count_ + (lane % 2) * sideways_count_;
  }

  void weigh(const Lanes& g, Lanes& growth) const {
    for (int k = 0; k < kLanes; ++k) growth[k] = weight_[k] * (g[k] > 0 ? g[k] : 0.0);
  }

  /// phi inside [-1, 1] is the spline, outside its tangent at the end; t: r in intervals.
  void take_phi(int part, const Lanes& r, Lanes& t, Lanes& phi) const {
    const double last = sideways_count_ - 3;
    for (int k = 0; k < kLanes; ++k) {
      t[k] = t[k] > 0 ? (t[k] < last ? t[k] : last) : 0.0;
      phi_[part].take(k, phi_coefs(k), sideways_count_, t[k]);
    }
    phi_[part].known_values(t, phi);
    for (int k = 0; k < kLanes; ++k) {
      const double beyond = std::fabs(r[k]) - 1;
      if (beyond > 0) phi[k] += 0.5 * beyond * outward_slope(phi_coefs(k), sideways_count_, r[k] > 0);
    }
  }

  int growth_count_ = 0, sideways_count_ = 0;
  mutable int growth_interval_ = -1;  ///< that all growths are taken on; -1 where some are not
  const float* coefs_[kResponses] = {};
  Lanes weight_ = {}, cosine_ = {}, sine_ = {};  ///< the sine of each y is the negative
  Pieces<kLanes> growth_, phi_[kParts];
};

}  // namespace palpate::runtime
