// SPDX-License-Identifier: MIT
// The separable response of one contact: curves of the depth, and products of curves of depth and sideways deflection.
#pragma once

#include "palpate/depth_terms.hpp"
#include "palpate/triple.hpp"
#include "palpate/view.hpp"

#include <cmath>

namespace palpate::runtime {

/// Blend of the separable responses of up to three body vertices and three tool vertices (Hayward and Mahvash 2004), or
/// three spins of each of those.
/// Push, straight sideways force and friction limit are blended once; sideways forces are products, each in the frame
/// of its body vertex, and are blended as forces. Not for several threads at once (pieces.hpp).
/// Of layout::Feature those that kFeatures leaves out take neither code nor memory.
template <std::uint32_t kFeatures>
class SeparableLaw {
  static constexpr bool kLateral = (kFeatures & layout::feature_lateral) != 0;
  static constexpr bool kFriction = (kFeatures & layout::feature_friction) != 0;
  static constexpr bool kSpin = (kFeatures & layout::feature_spin) != 0;
  static constexpr int kFurther = 2 * kTriples;  // up to three spins of every tool vertex
  using Triple = runtime::Triple<(kFeatures & layout::feature_rim) != 0 ? 2 : 1>;
  using Lanes = double[Triple::kLanes];

public:
  /// Forgets all responses. The basis spans what lies across n(c).
  void clear(const layout::Meta& meta, const Vec3& basis_x, const Vec3& basis_y) {
    meta_ = &meta;
    basis_x_ = basis_x;
    basis_y_ = basis_y;
    per_depth_ = 1 / static_cast<double>(meta.depth_scale);
    per_sideways_ = meta.sideways_scale > 0 ? 1 / static_cast<double>(meta.sideways_scale) : 0;
    for (std::uint32_t k = 0; k < meta.normal_coefs; ++k) push_[k] = 0;
    responses_ = triples_ = further_ = 0;
    low_ = 1;
    high_ = 0;
    pushed_interval_ = -1;
    depth_curves_.forget();
    depth_intervals_[kPush] = intervals(meta.normal_coefs);
    if constexpr (kLateral) {
      for (std::uint32_t k = 0; k < 2 * meta.lateral_coefs; ++k) lateral_[k] = 0;
      depth_intervals_[kStraight] = depth_intervals_[kStraight + 1] = intervals(meta.lateral_coefs);
    }
    if constexpr (kFriction) {
      for (std::uint32_t k = 0; k < meta.friction_coefs; ++k) mu_[k] = 0;
      depth_intervals_[kMu] = intervals(meta.friction_coefs);
      growth_intervals_ = intervals(meta.growth_coefs);
      known_.depth = 0;
    }
  }

  /// What is added from now on has its sideways curves along x (unit, across n(c)) and along n(c) x x.
  void begin_body(const Vec3& x) {
    cosine_ = dot(x, basis_x_);
    sine_ = dot(x, basis_y_);
  }

  /// One response of the view, by its index.
  void add(const View& view, std::uint64_t index, double weight) {
    const layout::Meta& m = *meta_;
    const float* push = view.normal_coefs(index);
    for (std::uint32_t k = 0; k < m.normal_coefs; ++k) push_[k] += weight * push[k];
    if constexpr (kLateral) {
      if (view.lateral != nullptr) add_lateral(view.lateral_coefs(index), weight * cosine_, weight * sine_);
    }
    if constexpr (kFriction) {
      if (view.friction != nullptr) add_friction(view.friction_coefs(index), weight);
    }
  }

  /// Forces, limit and growths at depth z > 0 (m).
  void at_depth(double z, DepthTerms& terms) const {
    const double share = z * per_depth_;
    if (!(share < 1)) return beyond(0.5 * (share - 1), terms);
    const double s = std::sqrt(share);
    if (!(s > low_ && s < high_)) take_depth(s);
    double t[kCurves], value[kCurves];
    for (int k = 0; k < kCurves; ++k) t[k] = s * depth_intervals_[k];
    depth_curves_.known_values(t, value);
    terms.normal_force = value[kPush];
    if constexpr (kLateral) {
      if (meta_->lateral_coefs > 0) terms.straight = value[kStraight] * basis_x_ + value[kStraight + 1] * basis_y_;
    }
    terms.limit = HUGE_VAL;
    if constexpr (kFriction) {
      if (meta_->friction_coefs == 0) return;
      terms.limit = value[kMu] * terms.normal_force;
      const double at = s * growth_intervals_;
      for (int j = 0; j < triples_; ++j) triple_[j].growths(at, terms.growth[j]);
    }
  }

  /// Work of a straight push to depth z > 0 (J): the integral of Fn dz, exact.
  [[nodiscard]] double pushed(double z) const {
    const int count = static_cast<int>(meta_->normal_coefs);
    const double share = z * per_depth_, s = share < 1 ? std::sqrt(share) : 1.0;
    const double intervals = depth_intervals_[kPush], scale = 1 / per_depth_;
    if (!(s > low_ && s < high_)) take_depth(s);
    const int interval = depth_curves_.interval(kPush);
    if (interval != pushed_interval_) {
      pushed_interval_ = interval;
      pushed_before_ = spline::first_moment(push_, count, interval);
    }
    const double here = spline::first_moment(depth_curves_.cubic(kPush), interval, s * intervals - interval);
    double work = 2 * scale * (pushed_before_ + here) / (intervals * intervals);  // dz = 2 Z s ds
    if (share > 1) {
      const double further = z - scale;
      work += further * (push_[count - 1] + 0.25 * further * per_depth_ * spline::slope_at_1(push_, count));
    }
    return work;
  }

  /// The share of a sideways deflection that going deeper from z0 > 0 leaves: the least of growth(z0) / growth(z1), so
  /// that no more is stored than before; 1 where none grows.
  [[nodiscard]] double share_kept(double z0, const DepthTerms& at_z1) const {
    Lanes least = {1, 1, 1, 1, 1, 1};
    if constexpr (kFriction) {
      if (known_.depth != z0) {
        DepthTerms terms;
        at_depth(z0, terms);
        terms.depth = z0;
        remember(terms);
      }
      for (int j = 0; j < triples_; ++j) take_least(known_.growth[j], at_z1.growth[j], least);
      if constexpr (kSpin) {
        for (int j = 0; j < further_; ++j) {
          Lanes before, now;
          further_growths(j, z0, before);
          further_growths(j, at_z1.depth, now);
          take_least(before, now, least);
        }
      }
    }
    double kept = least[0];
    for (const double each : least) kept = each < kept ? each : kept;
    return kept;
  }

  /// Keeps what share_kept needs of the terms of a depth that will be its z0.
  void remember(const DepthTerms& terms) const {
    if constexpr (kFriction) {
      known_.depth = terms.depth;
      for (int j = 0; j < triples_; ++j) {
        for (int k = 0; k < Triple::kLanes; ++k) known_.growth[j][k] = terms.growth[j][k];
      }
    }
  }

  /// Sideways force (N, body frame) at terms of a positive depth and a deflection (m), without that of the straight
  /// push. Of the contact's core, or its rim where there is one: what was asked for last is remembered for each.
  [[nodiscard]] Vec3 sideways(const DepthTerms& terms, const Vec3& deflection, Part part) const {
    if constexpr (kFriction) {
      if (meta_->sideways_coefs > 0) return sum_sideways<false>(terms, deflection, part);
    }
    return {};
  }

private:
  static void take_least(const Lanes& before, const Lanes& now, Lanes& least) {
    for (int k = 0; k < Triple::kLanes; ++k) {
      const double ratio = before[k] / now[k];  // NaN where there is none
      least[k] = ratio < least[k] ? ratio : least[k];
    }
  }

  /// Weighted growths of a further triple at depth z > 0 (m).
  [[gnu::noinline]] void further_growths(int j, double z, Lanes& growth) const {
    const double share = z * per_depth_;
    if (!(share < 1)) return further_triple_[j].growths_beyond(0.5 * (share - 1), growth);
    const double s = std::sqrt(share);
    if (!(s > low_ && s < high_)) take_depth(s);
    further_triple_[j].growths(s * growth_intervals_, growth);
  }

  [[gnu::noinline]] void add_further(double z, Part part, double x, double y, double (&force)[2]) const {
    for (int j = 0; j < further_; ++j) {
      Lanes growth;
      further_growths(j, z, growth);
      further_triple_[j].template add_force<true>(growth, static_cast<int>(part), x, y, force);
    }
  }

  void add_lateral(const float* x, double cosine, double sine) {
    const std::uint32_t count = meta_->lateral_coefs;
    const float* y = x + count;
    for (std::uint32_t k = 0; k < count; ++k) {
      lateral_[k] += cosine * x[k] - sine * y[k];
      lateral_[count + k] += sine * x[k] + cosine * y[k];
    }
  }

  void add_friction(const float* coefs, double weight) {
    const layout::Meta& m = *meta_;
    const int slot = responses_++ % Triple::kResponses;
    if constexpr (kSpin) {
      if (responses_ > kTriples * Triple::kResponses) {
        if (slot == 0) further_triple_[further_++].clear(m, coefs);
        further_triple_[further_ - 1].set(slot, coefs, weight, cosine_, sine_);
      }
    }
    if (!kSpin || further_ == 0) {
      if (slot == 0) triple_[triples_++].clear(m, coefs);
      triple_[triples_ - 1].set(slot, coefs, weight, cosine_, sine_);
    }
    const float* mu = coefs + 2 * m.growth_coefs + 2 * m.sideways_coefs;
    for (std::uint32_t k = 0; k < m.friction_coefs; ++k) mu_[k] += weight * mu[k];
  }

  /// kTake: the curves need not have been taken where the deflection is.
  template <bool kTake>
  [[nodiscard]] Vec3 sum_sideways(const DepthTerms& terms, const Vec3& deflection, Part part) const {
    const double x = per_sideways_ * dot(deflection, basis_x_), y = per_sideways_ * dot(deflection, basis_y_);
    double force[2] = {0, 0};
    for (int j = 0; j < triples_; ++j) {
      if (!triple_[j].template add_force<kTake>(terms.growth[j], static_cast<int>(part), x, y, force)) {
        return take_sideways(terms, deflection, part);
      }
    }
    if constexpr (kSpin) {
      if (further_ > 0) add_further(terms.depth, part, x, y, force);
    }
    return force[0] * basis_x_ + force[1] * basis_y_;
  }

  struct Known {
    double depth = 0;  ///< m; none where it is 0
    Lanes growth[kTriples];
  };

  // What follows is rarely called, and long: inlined it would slow every tick.

  /// Makes the cubics of all curves of the depth those of the knot intervals at s.
  [[gnu::noinline]] void take_depth(double s) const {
    low_ = -1;
    high_ = 2;
    take(kPush, push_, meta_->normal_coefs, s);
    if constexpr (kLateral) {
      const std::uint32_t count = meta_->lateral_coefs;
      for (int axis = 0; count > 0 && axis < 2; ++axis) take(kStraight + axis, lateral_ + axis * count, count, s);
    }
    if constexpr (kFriction) {
      if (meta_->friction_coefs == 0) return;
      take(kMu, mu_, meta_->friction_coefs, s);
      for (int j = 0; j < triples_; ++j) {
        narrow(triple_[j].take_growths(s * growth_intervals_), static_cast<int>(meta_->growth_coefs));
      }
      if constexpr (kSpin) {  // on the same intervals
        for (int j = 0; j < further_; ++j) further_triple_[j].take_growths(s * growth_intervals_);
      }
    }
  }
  void take(int curve, const double* coefs, std::uint32_t coef_count, double s) const {
    const int count = static_cast<int>(coef_count);
    narrow(depth_curves_.take(curve, coefs, count, s * depth_intervals_[curve]), count);
  }
  void narrow(int interval, int count) const {
    constexpr double kSlack = Pieces<kCurves>::kSlack;
    low_ = std::fmax(low_, (interval - kSlack) / (count - 3));
    high_ = std::fmin(high_, (interval + 1 + kSlack) / (count - 3));
  }

  [[nodiscard, gnu::noinline]] Vec3 take_sideways(const DepthTerms& terms, const Vec3& deflection, Part part) const {
    return sum_sideways<true>(terms, deflection, part);
  }

  /// What at_depth says at Z and deeper: linear in z, ds/dz = 1 / (2 Z); `extra` is s - 1 so.
  [[gnu::noinline]] void beyond(double extra, DepthTerms& terms) const {
    const auto on = [extra](const auto* coefs, std::uint32_t coef_count) {
      return spline::beyond(coefs, static_cast<int>(coef_count), extra);
    };
    const layout::Meta& m = *meta_;
    terms.normal_force = on(push_, m.normal_coefs);
    if constexpr (kLateral) {
      const std::uint32_t count = m.lateral_coefs;
      if (count > 0) terms.straight = on(lateral_, count) * basis_x_ + on(lateral_ + count, count) * basis_y_;
    }
    terms.limit = HUGE_VAL;
    if constexpr (kFriction) {
      if (m.friction_coefs == 0) return;
      terms.limit = mu_[m.friction_coefs - 1] * terms.normal_force;
      for (int j = 0; j < triples_; ++j) triple_[j].growths_beyond(extra, terms.growth[j]);
    }
  }

  static double intervals(std::uint32_t coef_count) { return coef_count > 3 ? coef_count - 3.0 : 0.0; }

  // Curves of the depth alone, all evaluated at once; those that the file has not are never taken.
  static constexpr int kPush = 0, kMu = 1, kStraight = kFriction ? 2 : 1;
  static constexpr int kCurves = kStraight + (kLateral ? 2 : 0);

  const layout::Meta* meta_ = nullptr;
  Vec3 basis_x_, basis_y_;
  double per_depth_ = 0, per_sideways_ = 0;  ///< 1 / Z, 1 / X (1/m)
  double cosine_ = 1, sine_ = 0;             ///< of the angle of the present body vertex' frame against the basis
  int responses_ = 0, triples_ = 0;
  detail::If<kFriction, Triple[kTriples]> triple_;
  double push_[layout::kMaxCoefs] = {};
  detail::If<kLateral, double[2 * layout::kMaxCoefs]> lateral_ = {};  ///< along basis_x_, then along basis_y_
  detail::If<kFriction, double[layout::kMaxCoefs]> mu_ = {};
  // While low_ < s < high_ the cubics are of the right intervals.
  mutable double low_ = 1, high_ = 0;
  // For the work of a straight push: that to the start of this interval, -1 where none is known.
  mutable int pushed_interval_ = -1;
  mutable double pushed_before_ = 0;
  Pieces<kCurves> depth_curves_;
  double depth_intervals_[kCurves] = {};
  detail::If<kFriction, double> growth_intervals_ = {};
  mutable detail::If<kFriction, Known> known_;
  // Of further spins; behind what every tick reads. Their growths are made when asked for.
  int further_ = 0;
  detail::If<kFriction && kSpin, Triple[kFurther]> further_triple_;
};

}  // namespace palpate::runtime
