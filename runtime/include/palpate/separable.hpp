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
  using Curves = SidewaysCurves<(kFeatures & layout::feature_rim) != 0 ? 2 : 1>;
  static constexpr int kNear = Curves::kLayers * Curves::kSites;  // without spins there are no more

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
      if constexpr (kSpin) further_.depth = 0;
    }
  }

  /// One response of the view, by its index, with its sideways curves along x and along n(c) x x: those of a tool's
  /// vertex at the three sites of the patch, then the next vertex'. kSpun: in any order, and there may be more of them
  /// than a contact has without spins; finish_spun() is to follow.
  template <bool kSpun>
  void add(const View& view, std::uint64_t index, double weight, const Across& x) {
    const From& from = from_[responses_] = {view.normal_coefs(index), weight, x.cosine, x.sine};
    if constexpr (kFriction) {
      if (meta_->friction_coefs > 0 && (!kSpun || responses_ < kNear)) {
        curves_.template set<kSpun>(responses_ / Curves::kSites, responses_ % Curves::kSites, friction_of(from), weight,
                                    x.cosine, x.sine);
      }
    }
    ++responses_;
  }

  /// All responses have been added.
  void finish_spun() {
    if constexpr (kFriction) {
      const int last = responses_ < kNear ? responses_ % Curves::kSites : 0;
      if (meta_->friction_coefs > 0 && last > 0) curves_.leave_empty_from(last);
    }
  }

  /// Forces, limit and growths at depth z > 0 (m).
  void at_depth(double z, DepthTerms& terms) const {
    const double share = z * per_depth_;
    if (!(share < 1)) return beyond(0.5 * (share - 1), terms);
    const double s = std::sqrt(share);
    if (!(s > low_ && s < high_)) take_depth(s);
    Lanes<kCurves> t, value;
    for (int i = 0; i < t.kTwos; ++i) t.of[i] = two(s, s) * depth_intervals_.of[i];
    depth_curves_.known_values(t, value);
    terms.normal_force = value[kPush];
    if constexpr (kLateral) {
      if (meta_->lateral_coefs > 0) terms.straight = value[kStraight] * basis_x_ + value[kStraight + 1] * basis_y_;
    }
    terms.limit = HUGE_VAL;
    if constexpr (kFriction) {
      if (meta_->friction_coefs == 0) return;
      terms.limit = value[kMu] * terms.normal_force;
      curves_.growths(s * growth_intervals_, terms.growth);
    }
  }

  /// N, sideways force of the straight push to depth z > 0 (m) alone: what nobody asks for again takes no intervals.
  [[nodiscard]] Vec3 straight_once([[maybe_unused]] double z) const {
    if constexpr (kLateral) {
      const int count = static_cast<int>(meta_->lateral_coefs);
      if (count == 0) return {};
      const double share = z * per_depth_;
      if (!(share < 1)) return straight_beyond(0.5 * (share - 1));
      spline::Basis basis = spline::basis(count, std::sqrt(share));
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
    if (!(s > low_ && s < high_)) {
      low_ = 1;
      high_ = 0;
      take_push(s);
    }
    const int interval = depth_curves_.interval(kPush);
    if (interval != pushed_interval_) {
      pushed_interval_ = interval;
      pushed_before_ = moment_before(interval);
    }
    const double here = spline::first_moment(depth_curves_.cubic(kPush), interval, s * intervals - interval);
    double work = 2 * scale * (pushed_before_ + here) / (intervals * intervals);  // dz = 2 Z s ds
    if (share > 1) {
      const double further = z - scale;
      const Four last = blended(0, count - 4);
      work += further * (last.of[3] + 0.75 * further * per_depth_ * intervals * (last.of[3] - last.of[2]));
    }
    return work;
  }

  /// The share of a sideways deflection that going deeper from z0 > 0 leaves: the least of growth(z0) / growth(z1), so
  /// that no more is stored than before; 1 where none grows.
  [[nodiscard]] double share_kept(double z0, const DepthTerms& at_z1) const {
    double kept = 1;
    if constexpr (kFriction) {
      if (known_.depth != z0) {
        known_.depth = z0;
        const double share = z0 * per_depth_;
        if (share < 1) {
          curves_.growths_once(std::sqrt(share), known_.growth);
        } else {
          curves_.growths_beyond(0.5 * (share - 1), known_.growth);
        }
      }
      for (int j = 0; j < curves_.layers(); ++j) {
        for (int k = 0; k < Curves::kSites; ++k) {
          const Two ratio = known_.growth[j].of[k] / at_z1.growth[j].of[k];  // no number where there is none
          kept = ratio[0] < kept ? ratio[0] : kept;
          kept = ratio[1] < kept ? ratio[1] : kept;
        }
      }
    }
    if constexpr (kFriction && kSpin) {
      if (responses_ > kNear) return further_share_kept(z0, at_z1.depth, kept);
    }
    return kept;
  }

  /// Keeps what share_kept needs of the terms of a depth that will be its z0.
  void remember(const DepthTerms& terms) const {
    if constexpr (kFriction) {
      known_.depth = terms.depth;
      for (int j = 0; j < curves_.layers(); ++j) known_.growth[j] = terms.growth[j];
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
    Straight sum = {};
    for (int j = 0; j < responses_; ++j) {
      const From& from = from_[j];
      const float *x = from.coefs + meta_->normal_coefs + first, *y = x + meta_->lateral_coefs;
      const double cosine = from.weight * from.cosine, sine = from.weight * from.sine;
      for (int k = 0; k < 4; ++k) sum.x[k] += cosine * x[k] - sine * y[k];
      for (int k = 0; k < 4; ++k) sum.y[k] += sine * x[k] + cosine * y[k];
    }
    return sum;
  }

  /// Of the push: spline::first_moment to the start of an interval.
  [[nodiscard]] double moment_before(int interval) const {
    double sum[layout::kMaxCoefs];
    const int last = static_cast<int>(meta_->normal_coefs) - 4;
    for (int first = 0; first < interval + 3; first += 4) {
      const int from = first < last ? first : last;
      const Four four = blended(0, from);
      for (int k = 0; k < 4; ++k) sum[from + k] = four.of[k];
    }
    return spline::first_moment(sum, static_cast<int>(meta_->normal_coefs), interval);
  }

  /// kTake: the curves need not have been taken where the deflection is.
  template <bool kTake>
  [[nodiscard]] Vec3 sum_sideways(const DepthTerms& terms, const Vec3& deflection, Part part) const {
    const double x = per_sideways_ * dot(deflection, basis_x_), y = per_sideways_ * dot(deflection, basis_y_);
    Two force;
    if (!curves_.template set_force<kTake>(terms.growth, static_cast<int>(part), x, y, force)) {
      return take_sideways(terms, deflection, part);
    }
    if constexpr (kSpin) {
      if (responses_ > kNear) return with_further(terms.depth, x, y, force[0], force[1]);
    }
    return force[0] * basis_x_ + force[1] * basis_y_;
  }

  struct Further {
    double depth = 0;  ///< m; none where it is 0
    double growth[2 * kNear][2];
  };
  struct Known {
    double depth = 0;  ///< m; none where it is 0
    typename Curves::Growths growth;
  };
  [[nodiscard]] const float* friction_of(const From& from) const {
    return from.coefs + meta_->normal_coefs + 2 * meta_->lateral_coefs;
  }

  // What follows is rarely called, and long: inlined it would slow every tick.

  /// Makes the cubics of all curves of the depth those of the knot intervals at s.
  [[gnu::noinline]] void take_depth(double s) const {
    low_ = -1;
    high_ = 2;
    take_push(s);
    if constexpr (kLateral) {
      if (meta_->lateral_coefs > 0) take_straight(s);
    }
    if constexpr (kFriction) {
      if (meta_->friction_coefs == 0) return;
      take_limit(s);
      narrow(curves_.take_growths(s * growth_intervals_), meta_->growth_coefs);
    }
  }
  void take_push(double s) const {
    const int count = static_cast<int>(meta_->normal_coefs);
    const int interval = spline::interval_of(count, s * depth_intervals_[kPush]);
    narrow(interval, meta_->normal_coefs);
    if (depth_curves_.interval(kPush) == interval) return;
    depth_curves_.set(kPush, spline::cubic_of(blended(0, interval).of, count, interval), interval);
  }
  void take_straight(double s) const {
    const int count = static_cast<int>(meta_->lateral_coefs);
    const int interval = spline::interval_of(count, s * depth_intervals_[kStraight]);
    narrow(interval, meta_->lateral_coefs);
    if (depth_curves_.interval(kStraight) == interval) return;
    const Straight four = blended_straight(interval);
    depth_curves_.set(kStraight, spline::cubic_of(four.x, count, interval), interval);
    depth_curves_.set(kStraight + 1, spline::cubic_of(four.y, count, interval), interval);
  }
  void take_limit(double s) const {
    const int count = static_cast<int>(meta_->friction_coefs);
    const int interval = spline::interval_of(count, s * depth_intervals_[kMu]);
    narrow(interval, meta_->friction_coefs);
    if (depth_curves_.interval(kMu) == interval) return;
    depth_curves_.set(kMu, spline::cubic_of(blended_limit(interval).of, count, interval), interval);
  }
  void narrow(int interval, std::uint32_t count) const {
    constexpr double kSlack = Pieces<kCurves>::kSlack;
    const double low = (interval - kSlack) * detail::kReciprocals.intervals[count],
                 high = (interval + 1 + kSlack) * detail::kReciprocals.intervals[count];
    low_ = low > low_ ? low : low_;
    high_ = high < high_ ? high : high_;
  }

  /// What growths have in common at depth z > 0 (m).
  struct GrowthBasis {
    spline::Basis basis;
    double extra;  ///< s - 1 beyond the depth scale, where curves go on linearly
  };
  [[nodiscard]] GrowthBasis growth_basis(double z) const {
    const double share = z * per_depth_;
    return {spline::basis(static_cast<int>(meta_->growth_coefs), std::sqrt(share)), std::fmax(0, 0.5 * (share - 1))};
  }

  /// Weighted, along axis 0 or 1.
  [[nodiscard]] double further_growth(const From& of, int axis, const GrowthBasis& at) const {
    const int count = static_cast<int>(meta_->growth_coefs);
    const float* coefs = friction_of(of) + axis * count;
    return of.weight * std::fmax(0, spline::combine(at.basis, coefs) + at.extra * spline::slope_at_1(coefs, count));
  }

  /// What share_kept says of further responses, where the others have `kept`.
  [[nodiscard, gnu::noinline]] double further_share_kept(double z0, double z1, double kept) const {
    if (meta_->growth_coefs == 0) return kept;
    const GrowthBasis before = growth_basis(z0), now = growth_basis(z1);
    for (int k = 0; k < responses_ - kNear; ++k) {
      for (int axis = 0; axis < 2; ++axis) {
        const double ratio =
            further_growth(from_[kNear + k], axis, before) / further_growth(from_[kNear + k], axis, now);
        kept = ratio < kept ? ratio : kept;  // NaN where there is none
      }
    }
    return kept;
  }

  /// The sideways force, of which force_x and force_y (N) are known, with that of further responses.
  [[nodiscard, gnu::noinline]] Vec3 with_further(double z, double x, double y, double force_x, double force_y) const {
    const int count = static_cast<int>(meta_->sideways_coefs);
    if (further_.depth != z) set_further(z);
    for (int k = 0; k < responses_ - kNear; ++k) {
      const From& of = from_[kNear + k];
      const double r[2] = {of.cosine * x + of.sine * y, of.cosine * y - of.sine * x};
      double f[2];
      for (int axis = 0; axis < 2; ++axis) {
        const float* coefs = friction_of(of) + 2 * meta_->growth_coefs + axis * count;
        const double beyond = std::fabs(r[axis]) - 1;
        double phi = spline::value(coefs, count, 0.5 * (r[axis] + 1));
        if (beyond > 0) phi += 0.5 * beyond * Curves::outward_slope(coefs, count, r[axis] > 0);
        f[axis] = further_.growth[k][axis] * phi;
      }
      force_x += of.cosine * f[0] - of.sine * f[1];
      force_y += of.cosine * f[1] + of.sine * f[0];
    }
    return force_x * basis_x_ + force_y * basis_y_;
  }

  /// Growths of further responses at a depth at which more than one deflection is asked for.
  void set_further(double z) const {
    const GrowthBasis at = growth_basis(z);
    further_.depth = z;
    for (int k = 0; k < responses_ - kNear; ++k) {
      for (int axis = 0; axis < 2; ++axis) further_.growth[k][axis] = further_growth(from_[kNear + k], axis, at);
    }
  }

  [[nodiscard, gnu::noinline]] Vec3 take_sideways(const DepthTerms& terms, const Vec3& deflection, Part part) const {
    return sum_sideways<true>(terms, deflection, part);
  }

  /// What at_depth says at Z and deeper: linear in z, ds/dz = 1 / (2 Z); `extra` is s - 1 so.
  [[gnu::noinline]] void beyond(double extra, DepthTerms& terms) const {
    const layout::Meta& m = *meta_;
    const int count = static_cast<int>(m.normal_coefs);
    terms.normal_force = spline::beyond(blended(0, count - 4).of, 4, extra * (count - 3));
    if constexpr (kLateral) {
      if (m.lateral_coefs > 0) terms.straight = straight_beyond(extra);
    }
    terms.limit = HUGE_VAL;
    if constexpr (kFriction) {
      if (m.friction_coefs == 0) return;
      terms.limit = blended_limit(static_cast<int>(m.friction_coefs) - 4).of[3] * terms.normal_force;
      curves_.growths_beyond(extra, terms.growth);
    }
  }

  [[nodiscard]] Vec3 straight_beyond(double extra) const {
    const int count = static_cast<int>(meta_->lateral_coefs);
    const Straight last = blended_straight(count - 4);
    const double slope = 3.0 * (count - 3) * extra;
    return (last.x[3] + slope * (last.x[3] - last.x[2])) * basis_x_ +
           (last.y[3] + slope * (last.y[3] - last.y[2])) * basis_y_;
  }

  static double intervals(std::uint32_t coef_count) { return coef_count > 3 ? coef_count - 3.0 : 0.0; }

  // Curves of the depth alone, all evaluated at once; those that the file has not are never taken.
  static constexpr int kPush = 0, kMu = 1, kStraight = kFriction ? 2 : 1;
  static constexpr int kCurves = kStraight + (kLateral ? 2 : 0);

  const layout::Meta* meta_ = nullptr;
  Vec3 basis_x_, basis_y_;
  double per_depth_ = 0, per_sideways_ = 0;  ///< 1 / Z, 1 / X (1/m)
  int responses_ = 0;
  detail::If<kFriction, Curves> curves_;
  // While low_ < s < high_ the cubics are of the right intervals.
  mutable double low_ = 1, high_ = 0;
  // For the work of a straight push: that to the start of this interval, -1 where none is known.
  mutable int pushed_interval_ = -1;
  mutable double pushed_before_ = 0;
  Pieces<kCurves> depth_curves_;
  Lanes<kCurves> depth_intervals_ = {};
  detail::If<kFriction, double> growth_intervals_ = {};
  mutable detail::If<kFriction, Known> known_;
  mutable detail::If<kFriction && kSpin, Further> further_;
  From from_[kSpin ? 3 * kNear : kNear] = {};  ///< behind what every tick reads
};

}  // namespace palpate::runtime
