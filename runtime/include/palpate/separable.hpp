// SPDX-License-Identifier: MIT
// The separable response of one contact: curves of the depth, and products of curves of depth and sideways deflection.
#pragma once

#include "palpate/depth_terms.hpp"
#include "palpate/sideways_curves.hpp"
#include "palpate/surface.hpp"
#include "palpate/view.hpp"

#include <cmath>

namespace palpate::runtime {

namespace detail {

/// 1 / knot intervals, by the number of coefficients.
struct Reciprocals {
  double intervals[layout::kMaxCoefs + 1] = {};
  constexpr Reciprocals() {
    for (std::uint32_t count = layout::kMinCoefs; count <= layout::kMaxCoefs; ++count)
      intervals[count] = 1 / (count - 3.0);
  }
};
inline constexpr Reciprocals kReciprocals;

}  // namespace detail

/// Blend of the separable responses of up to three body vertices and three tool vertices (Hayward and Mahvash 2004), or
/// up to three spins of each of those.
/// Push, straight sideways force and friction limit are blended once; sideways forces are products, each in the frame
/// of its body vertex, and are blended as forces. Not for several threads at once (pieces.hpp).
/// Of layout::Feature those that kFeatures leaves out take neither code nor memory.
template <std::uint32_t kFeatures>
class SeparableLaw {
  static constexpr bool kLateral = (kFeatures & layout::feature_lateral) != 0;
  static constexpr bool kFriction = (kFeatures & layout::feature_friction) != 0;
  static constexpr bool kSpin = (kFeatures & layout::feature_spin) != 0;
  using Curves = SidewaysCurves<(kFeatures & layout::feature_rim) != 0 ? 2 : 1, kSpin ? kMostLayers : kLayersUnspun>;

public:
  /// Forgets all responses. The basis spans what lies across n(c).
  PALPATE_TICK_INLINE void clear(const layout::Meta& meta, const Vec3& basis_x, const Vec3& basis_y) {
    meta_ = &meta;
    basis_x_ = basis_x;
    basis_y_ = basis_y;
    per_depth_ = 1 / static_cast<double>(meta.depth_scale);
    per_sideways_ = meta.sideways_scale > 0 ? 1 / static_cast<double>(meta.sideways_scale) : 0;
    responses_ = 0;
    low_ = 1;
    high_ = 0;
    pushed_interval_ = -1;
    push_known_ = 0;
    push_four_ = -1;
    depth_curves_.forget();
    depth_intervals_.set(kPush, intervals(meta.normal_coefs));
    if constexpr (kLateral) {
      depth_intervals_.set(kStraight, intervals(meta.lateral_coefs));
      depth_intervals_.set(kStraight + 1, intervals(meta.lateral_coefs));
    }
    if constexpr (kFriction) {
      depth_intervals_.set(kMu, intervals(meta.friction_coefs));
      growth_intervals_ = intervals(meta.growth_coefs);
      known_.depth = 0;
      curves_.begin(meta);
    }
  }

  /// One response of the view, by its index, with its sideways curves along x and along n(c) x x: those of a tool's
  /// vertex (kSpun: or of one of its samples) at the three sites of the patch, then the next.
  template <bool kSpun>
  void add(const View& view, std::uint64_t index, double weight, const Across& x) {
    const From& from = from_[responses_] = {view.normal_coefs(index), weight, x.cosine, x.sine};
    if constexpr (kFriction) {
      if (meta_->friction_coefs > 0) {
        curves_.template set<kSpun>(responses_ / Curves::kSites, responses_ % Curves::kSites, friction_of(from), weight,
                                    x.cosine, x.sine);
      }
    }
    ++responses_;
  }

  /// Forces, limit and growths at depth z > 0 (m).
  void at_depth(double z, DepthTerms& terms) const {
    const double s = abscissa(z);
    if (!(s > low_ && s < high_)) take_depth(s);
    terms.root = s < 1 ? s : 1;
    Lanes<kCurves> t, value;
    unrolled<Lanes<kCurves>::kTwos>([&](int i) PALPATE_INLINE_LAMBDA { t.of[i] = two(s, s) * depth_intervals_.of[i]; });
    depth_curves_.known_values(t, value);
    terms.normal_force = value[kPush];
    if constexpr (kLateral) {
      if (meta_->lateral_coefs > 0) terms.straight = value[kStraight] * basis_x_ + value[kStraight + 1] * basis_y_;
    }
    terms.limit = HUGE_VAL;
    if constexpr (kFriction) {
      if (meta_->friction_coefs == 0) return;
      terms.limit = value[kMu] * terms.normal_force;
      if (curves_.apart()) return curves_.growths_once(s, terms.growth);
      curves_.growths(s * growth_intervals_, terms.growth);
    }
  }

  /// N, sideways force of the straight push to depth z > 0 (m) alone: what nobody asks for again takes no intervals.
  [[nodiscard]] Vec3 straight_once([[maybe_unused]] double z) const {
    if constexpr (kLateral) {
      const int count = static_cast<int>(meta_->lateral_coefs);
      if (count == 0) return {};
      const double s = abscissa(z), t = s * depth_intervals_[kStraight];
      const int interval = spline::interval_onwards(count, t);
      if (depth_curves_.interval(kStraight) == interval) {
        const auto force = [&](int k) { return spline::value(depth_curves_.cubic(k), t - interval); };
        return force(kStraight) * basis_x_ + force(kStraight + 1) * basis_y_;
      }
      spline::Basis basis = spline::basis_onwards(count, s);
      const Straight four = blended_straight(basis.first);
      basis.first = 0;
      return spline::combine(basis, four.x) * basis_x_ + spline::combine(basis, four.y) * basis_y_;
    }
    return {};
  }

  /// Work of a straight push to depth z > 0 (J): the integral of Fn dz, exact.
  [[nodiscard]] double pushed(double z) const {
    const int count = static_cast<int>(meta_->normal_coefs);
    const double share = z * per_depth_, s = share < 1 ? std::sqrt(share) : 1.0;
    const double intervals = depth_intervals_[kPush], scale = 1 / per_depth_;
    const int interval = spline::interval_of(count, s * intervals);
    if (interval != pushed_interval_) {
      know_push(interval);
      pushed_interval_ = interval;
      pushed_before_ = spline::first_moment(push_, count, interval);
      pushed_on_ = depth_curves_.interval(kPush) == interval ? depth_curves_.cubic(kPush)
                                                             : spline::Interval(count, interval).cubic(push_);
    }
    const double here = spline::first_moment(pushed_on_, interval, s * intervals - interval);
    double work = 2 * scale * (pushed_before_ + here) / (intervals * intervals);  // dz = 2 Z s ds
    if (share > 1) {
      const double further = z - scale;
      const double last = push_[count - 1], rise = last - push_[count - 2];
      work += further * (last + 0.75 * further * per_depth_ * intervals * rise);
    }
    return work;
  }

  /// The share of a sideways deflection that going deeper from z0 > 0 leaves: the least of growth(z0) / growth(z1), so
  /// that no more is stored than before; 1 where none grows.
  [[nodiscard]] double share_kept(double z0, const DepthTerms& at_z1) const {
    double kept = 1;
    if constexpr (kFriction) {
      know(z0);
      for (int j = 0; j < curves_.layers(); ++j) {
        for (int k = 0; k < Curves::kSites; ++k) {
          const Two ratio = known_.growth[j].of[k] / at_z1.growth[j].of[k];  // no number where there is none
          kept = ratio[0] < kept ? ratio[0] : kept;
          kept = ratio[1] < kept ? ratio[1] : kept;
        }
      }
    }
    return kept;
  }

  /// The sideways stiffness at a depth z > 0 over that at the terms' depth, or the other way round where that is less:
  /// what is nearest to 1 of the curves' growths; 1 where none grows.
  [[nodiscard]] double share_between(double z, const DepthTerms& terms) const {
    double share = 0;
    if constexpr (kFriction) {
      know(z);
      const bool deeper = terms.depth > z;
      for (int j = 0; j < curves_.layers(); ++j) {
        for (int k = 0; k < Curves::kSites; ++k) {
          const Two there = known_.growth[j].of[k], here = terms.growth[j].of[k];
          const Two ratio = deeper ? there / here : here / there;  // no number where there is none
          share = ratio[0] > share ? ratio[0] : share;
          share = ratio[1] > share ? ratio[1] : share;
        }
      }
    }
    return share > 0 && share < 1 ? share : 1;
  }

  /// Keeps what share_kept needs of the terms of a depth that will be its z0.
  void remember(const DepthTerms& terms) const {
    if constexpr (kFriction) {
      known_.depth = terms.depth;
      for (int j = 0; j < curves_.layers(); ++j) known_.growth[j] = terms.growth[j];
    }
  }

  /// Sideways force (N) at terms of a positive depth and a deflection (m), both in the basis, without that of the
  /// straight push. Of the contact's core, or its rim where there is one: what was asked for last is remembered for
  /// each.
  [[nodiscard]] PALPATE_TICK_INLINE coupled::Vec2 sideways(const DepthTerms& terms, const coupled::Vec2& deflection,
                                                           Part part) const {
    if constexpr (kFriction) {
      if (meta_->sideways_coefs > 0) {
        const coupled::Vec2 r = per_sideways_ * deflection;
        const Two force = curves_.force(terms.growth, static_cast<int>(part), r.x, r.y);
        return {force[0], force[1]};
      }
    }
    return {};
  }

private:
  /// Of curves of the depth z > 0 (m): s = sqrt(z / Z); deeper than Z they go on linearly in z, ds/dz = 1 / (2 Z).
  [[nodiscard]] double abscissa(double z) const {
    const double share = z * per_depth_;
    return __builtin_expect(share < 1, true) ? std::sqrt(share) : 1 + 0.5 * (share - 1);
  }

  /// A response: its coefficients, its weight, the angle of its x axis.
  struct From {
    const float* coefs;
    double weight, cosine, sine;
  };

  /// Of a curve that lies `at` coefficients behind a response's first: four coefficients from `first` on, blended.
  struct Four {
    double of[4];
  };
  [[nodiscard, gnu::noinline]] Four blended(std::uint32_t at, int first) const {
    Four sum = {};
    for (int j = 0; j < responses_; ++j) {
      const float* four = from_[j].coefs + at + first;
      for (int k = 0; k < 4; ++k) sum.of[k] += from_[j].weight * four[k];
    }
    return sum;
  }
  [[nodiscard]] Four blended_limit(int first) const {
    const layout::Meta& m = *meta_;
    return blended(m.normal_coefs + 2 * (m.lateral_coefs + m.growth_coefs + m.sideways_coefs), first);
  }

  /// The same of the straight push's sideways forces, along basis_x_ and basis_y_.
  struct Straight {
    double x[4], y[4];
  };
  [[nodiscard, gnu::noinline]] Straight blended_straight(int first) const {
    double sum[8] = {0, 0, 0, 0, 0, 0, 0, 0};
    for (int j = 0; j < responses_; ++j) {
      const From& from = from_[j];
      const float *x = from.coefs + meta_->normal_coefs + first, *y = x + meta_->lateral_coefs;
      const double cosine = from.weight * from.cosine, sine = from.weight * from.sine;
      for (int k = 0; k < 4; ++k) {
        sum[k] = sum[k] + cosine * x[k] - sine * y[k];  // in this order a multiplication and an addition are one
        sum[4 + k] = sum[4 + k] + sine * x[k] + cosine * y[k];
      }
    }
    return {{sum[0], sum[1], sum[2], sum[3]}, {sum[4], sum[5], sum[6], sum[7]}};
  }

  void blend_push(int first) const {
    const Four four = blended(0, first);
    for (int k = 0; k < 4; ++k) push_[first + k] = four.of[k];
  }
  /// Has the four coefficients of the push from `first` on blended.
  void know_four(int first) const {
    if (push_four_ != first) blend_push(first);
    push_four_ = first;
  }
  /// And all before them, too.
  void know_push(int first) const {
    for (; push_known_ < first; push_known_ += 4) blend_push(push_known_);
    know_four(first);
  }

  struct Known {
    double depth = 0;  ///< m; none where it is 0
    typename Curves::Growths growth;
  };
  void know(double z) const {
    if (known_.depth == z) return;
    known_.depth = z;
    curves_.growths_once(abscissa(z), known_.growth);
  }
  [[nodiscard]] const float* friction_of(const From& from) const {
    return from.coefs + meta_->normal_coefs + 2 * meta_->lateral_coefs;
  }

  // What follows is rarely called, and long: inlined it would slow every tick.

  /// Makes the cubics of all curves of the depth those of the knot intervals at s.
  [[gnu::noinline]] void take_depth(double s) const {
    low_ = -1;
    high_ = HUGE_VAL;
    take_push(s);
    if constexpr (kLateral) {
      if (meta_->lateral_coefs > 0) take_straight(s);
    }
    if constexpr (kFriction) {
      if (meta_->friction_coefs == 0) return;
      take_limit(s);
      if (curves_.apart()) return;
      narrow(curves_.take_growths(s * growth_intervals_), meta_->growth_coefs);
    }
  }
  void take_push(double s) const {
    const int count = static_cast<int>(meta_->normal_coefs);
    const int interval = spline::interval_onwards(count, s * depth_intervals_[kPush]);
    narrow(interval, meta_->normal_coefs);
    if (depth_curves_.interval(kPush) == interval) return;
    const spline::Interval at(count, interval);
    know_four(at.first());
    depth_curves_.set(kPush, at.cubic(push_), interval);
  }
  void take_straight(double s) const {
    const int count = static_cast<int>(meta_->lateral_coefs);
    const int interval = spline::interval_onwards(count, s * depth_intervals_[kStraight]);
    narrow(interval, meta_->lateral_coefs);
    if (depth_curves_.interval(kStraight) == interval) return;
    const spline::Interval at(count, interval);
    const Straight four = blended_straight(at.first());
    depth_curves_.set(kStraight, at.of_four(four.x), interval);
    depth_curves_.set(kStraight + 1, at.of_four(four.y), interval);
  }
  void take_limit(double s) const {
    const int count = static_cast<int>(meta_->friction_coefs);
    const int interval = spline::interval_onwards(count, s * depth_intervals_[kMu]);
    narrow(interval, meta_->friction_coefs);
    if (depth_curves_.interval(kMu) == interval) return;
    const spline::Interval at(count, interval);
    spline::Cubic mu = at.of_four(blended_limit(at.first()).of);
    if (interval == count - 3) mu.power[1] = 0;  // beyond it stays as it is
    depth_curves_.set(kMu, mu, interval);
  }
  void narrow(int interval, std::uint32_t count) const {
    constexpr double kSlack = Pieces<kCurves>::kSlack;
    const double low = (interval - kSlack) * detail::kReciprocals.intervals[count],
                 high = (interval + 1 + kSlack) * detail::kReciprocals.intervals[count];
    low_ = low > low_ ? low : low_;
    if (interval == static_cast<int>(count) - 3) return;
    high_ = high < high_ ? high : high_;
  }

  static double intervals(std::uint32_t coef_count) { return coef_count > 3 ? coef_count - 3.0 : 0.0; }

  // Curves of the depth alone, all evaluated at once; those that the file has not are never taken.
  static constexpr int kPush = 0, kMu = 1, kStraight = kFriction ? 2 : 1;
  static constexpr int kCurves = kStraight + (kLateral ? 2 : 0);

  const layout::Meta* meta_ = nullptr;
  Vec3 basis_x_, basis_y_;
  double per_depth_ = 0, per_sideways_ = 0;  ///< 1 / Z, 1 / X (1/m)
  int responses_ = 0;
  // While low_ < s < high_ the cubics are of the right intervals.
  mutable double low_ = 1, high_ = 0;
  Pieces<kCurves> depth_curves_;
  Lanes<kCurves> depth_intervals_ = {};
  detail::If<kFriction, double> growth_intervals_ = {};
  detail::If<kFriction, Curves> curves_;
  // What not every tick reads. Of the push: the blended coefficients of which the first so many are known, and four
  // from one on (-1: none); for its work, of one interval (-1: none), the moment up to there and the cubic.
  mutable int push_known_ = 0, push_four_ = -1, pushed_interval_ = -1;
  mutable double push_[layout::kMaxCoefs] = {};
  mutable double pushed_before_ = 0;
  mutable spline::Cubic pushed_on_ = {};
  mutable detail::If<kFriction, Known> known_;
  From from_[(kSpin ? kMostLayers : kLayersUnspun) * Curves::kSites] = {};
};

}  // namespace palpate::runtime
