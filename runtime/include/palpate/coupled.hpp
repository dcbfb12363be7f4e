// SPDX-License-Identifier: MIT
// The coupled response of one contact: energy of the sideways deflection, its part in the normal force, anchor rule.
#pragma once

#include "palpate/coupled_blend.hpp"
#include "palpate/coupled_rows.hpp"
#include "palpate/coupled_square.hpp"

#include <cmath>

/// With z the depth, t = sqrt(z / Z) up to t = 1 and t = 1 + (z / Z - 1) / 2 beyond, and u = e / X the effective
/// sideways deflection, the hand does the work f_z dz + T . dx on the body. T and f_z follow from the stored energy
///
///     W(u, z) = integral of F dz + X U(u, t),      U = g(t) . u + V(u, t),      V = u K(t) u / 2 + C(u, t) + Q(u, t),
///
/// C and Q of degree 3 and 4 in u: T = grad_u U, a gradient at every depth, and with K' = dK/dt (beyond t = 1
/// everything but f_z's coupling goes on linearly in z)
///
///     f_z = F + (X/Z) (dg/dt . u + u A u / 2) / (2 s) + (X/Z) max(0, r - |T| h) / (2 s),         s = min(t, 1),
///     r = u (K' - A) u / 2 + C' + Q',       h = |K^-1 K' u|.
///
/// The linear coupling is dg/dz: no other is passive. r dt is what a lift that keeps e dissipates, less than nothing
/// where A <= K' and C, Q are small. **Anchor rule.** Sideways motion adds to e; lifting keeps it; deepening by dt
/// moves the anchor by dq, e by -dq, such that T - g stays: dq = (grad^2 V)^-1 grad V' dt, new area being anchored
/// unstressed. What is dissipated is (f_z - dW/dz) dz + T . dq. Where g = 0 and C = Q = 0 that is u (K' + A) u / 2 dt
/// >= 0. Elsewhere T . dq may fall short of r dt, and at T = 0, where no motion of the anchor dissipates anything, f_z
/// must be dW/dz: therefore r is replaced by min(r, |T| h), the last term of f_z, and dq takes the shortest addition
/// (along T) that makes T . dq = min(r, |T| h) dt, which never needs more than h dt. So
///
///     work of the hand = change of W + something >= 0
///
/// on any path, and any path from no contact to no contact takes work >= 0, for W(u, 0) = 0.
namespace palpate::coupled {

/// A response whose coefficients are blended, ready to be evaluated. Fixed size.
class Law {
public:
  /// Depth scale Z and sideways scale X in m.
  void set(const Blend& blend, double depth_scale, double sideways_scale) {
    rows_.set(blend.degrees(), blend.coefs());
    set_scales(depth_scale, sideways_scale);
  }
  /// Of rows instead.
  void set(const Rows::Share (&shares)[3], double depth_scale, double sideways_scale) {
    rows_.blend(shares);
    set_scales(depth_scale, sideways_scale);
  }

  [[nodiscard]] const Degrees& degrees() const { return rows_.degrees(); }

  /// t of a depth z > 0 (m).
  [[nodiscard]] double abscissa(double z) const {
    const double share = z * per_depth_;
    return share < 1 ? std::sqrt(share) : 0.5 * (share + 1);
  }

  /// `rates`: also what only the anchor rule needs.
  [[nodiscard]] AtDepth at(double t, bool rates) const {
    AtDepth d;
    set_at(t, rates, d);
    return d;
  }
  /// The same in place. What the degrees have not is left as it is.
  void set_at(double t, bool rates, AtDepth& d) const {
    using runtime::Two;
    const double s = t < 1 ? t : 1;
    const Two at = runtime::two(s, s), beyond = runtime::two(t - s, t - s);
    const auto sums = rows_.sum(s);
    constexpr int kG = Rows::kStraight, kK = Rows::kStiffness, kA = Rows::kCoupling;
    constexpr int kScalars = Rows::kStiffnessMean, kMore = Rows::kCouplingMean;
    static_assert(Rows::kPush == kScalars + 1 && Rows::kLimit == kMore + 1);
    const Two rise = sums.rise(kG, at), straight = at * at * sums.two(kG) + beyond * rise;
    const Two rate = sums.rate(kK, at), stiffness = at * sums.two(kK) + beyond * rate;
    const Two scalars = sums.two(kScalars), scalar_rates = sums.rate(kScalars, at);
    const Two coupling = 0.5 * at * sums.two(kA);
    d.s = s;
    d.push = s * s * scalars[1] + beyond[0] * (scalars[1] + scalar_rates[1]);
    d.straight = {straight[0], straight[1]};
    d.slope = {0.5 * rise[0], 0.5 * rise[1]};
    d.energy.square = {s * scalars[0] + beyond[0] * scalar_rates[0], stiffness[0], stiffness[1]};
    if (rates || careful()) d.rate.square = {scalar_rates[0], rate[0], rate[1]};
    d.coupling = {0.5 * s * sums.two(kMore)[0], coupling[0], coupling[1]};
    d.limit = sums.two(kMore)[1];
    if (order() > 2) set_forms(s, at, beyond, d);
  }

  /// T (N): the hand's sideways push; the force on the tool is -T.
  [[nodiscard]] Vec2 push(const AtDepth& d, const Vec2& u) const { return d.straight + d.energy.gradient(u, order()); }

  /// f_z - F (N), without the term that only the anchor rule's loss asks for: linear in the coefficients.
  [[nodiscard]] double plain_coupling(const AtDepth& d, const Vec2& u) const { return plain_coupling(d, u, 1.0); }

  /// f_z - F (N).
  [[nodiscard]] double coupling(const AtDepth& d, const Vec2& u) const {
    return coupling(d, u, [&] { return push(d, u); });
  }
  /// The same for a caller that has T, which it gives by a call where it is needed. Of a part of the contact that bears
  /// `lean` times the straight push's sideways force.
  template <class Push>
  [[nodiscard]] double coupling(const AtDepth& d, const Vec2& u, const Push& push, double lean = 1) const {
    const double plain = plain_coupling(d, u, lean);
    if (!careful() || (u.x == 0 && u.y == 0)) return plain;
    const double all = loss(d, u);
    const LeastLoss least = least_loss(d, u, push());
    // Mostly r is a half of |T| h: seen without a root or a division.
    return least.covers(all) ? plain : plain + ratio_ * (all - least.value()) / (2 * d.s);
  }

  /// W less the integral of F (N, times X it is J).
  [[nodiscard]] double energy(const AtDepth& d, const Vec2& u) const {
    return dot(d.straight, u) + d.energy.value(u, order());
  }

  /// Integral of F dz from no depth to the abscissa t (J).
  [[nodiscard]] double pushed(double t) const {
    const double s = t < 1 ? t : 1, further = 2 * depth_scale_ * (t - s);  // dz = 2 Z s ds, and 2 Z dt beyond
    double sum = 0, value = 0, slope = 0;
    for (int k = degrees().push - 2; k >= 0; --k) {
      sum = sum * s + rows_.push(k) / (k + 4);
      slope = slope * s + value;
      value = value * s + rows_.push(k);
    }
    const double s2 = s * s;
    return 2 * depth_scale_ * s2 * s2 * sum + further * (value + 0.5 * (t - s) * (2 * value + slope));
  }

  /// u after the tool went deeper from t0 to t1 > t0 without moving sideways.
  [[nodiscard]] Vec2 deepen(double t0, double t1, const Vec2& u) const {
    return deepen(t0, at(t0, true), t1, at(t1, true), u);
  }

  /// The same for a caller that has everything at t0 and t1. In one step where the rule's own loss covers what is owed,
  /// else in steps of kStep t0, kMostSteps of them at most. Of a part of the contact that bears `lean` times the
  /// straight push's sideways force.
  [[nodiscard]] Vec2 deepen(double t0, const AtDepth& from, double t1, const AtDepth& to, const Vec2& u,
                            double lean = 1) const {
    if (u.x == 0 && u.y == 0) return u;
    if (Vec2 once = u; deepen_at_once(t0, from, t1, to, once, lean)) return once;
    constexpr int kMostSteps = 3;
    const double wanted = (t1 - t0) / (kStep * t0);
    const int steps = wanted < kMostSteps ? 1 + static_cast<int>(wanted) : kMostSteps;
    const double step = (t1 - t0) / steps;
    Anchor last{u, load_at(from, u, lean)};
    if (steps > 1 && settled(from, last)) {
      const Anchor end = held(from, to, last, lean);
      if (!(missing(t1 - t0, last, end) > 0) && settled(to, end)) return end.u;
    }
    AtDepth between[2];
    const AtDepth* before = &from;
    for (int k = 1; k <= steps; ++k) {
      if (k < steps) set_at(t0 + k * step, true, between[k % 2]);
      const AtDepth& d = k < steps ? between[k % 2] : to;
      Anchor next = held(*before, d, last, lean);
      give_way(d, step, last, next, lean);
      last = next;
      before = &d;
    }
    return last.u;
  }

  /// The same of one part or of two side by side (Two), where the law and what is owed are so simple, as they mostly
  /// are, that it takes no more than that. Else false, and u is as it was.
  template <class Number>
  [[nodiscard]] bool deepen_at_once(double t0, const AtDepth& from, double t1, const AtDepth& to, Vec2Of<Number>& u,
                                    const Number& lean) const {
    if (order() > 2) return false;
    if (careful()) return t1 - t0 < kStep * t0 && square::deepen(t1 - t0, from, to, u, lean);
    u = square::held(from, to, u);
    return true;
  }
  /// coupling() likewise.
  template <class Number>
  [[nodiscard]] bool couple_at_once(const AtDepth& d, const Vec2Of<Number>& u, const Number& lean,
                                    Number& coupling) const {
    if (order() > 2 || (careful() && !square::load(d, u, lean).covered())) return false;
    coupling = plain_coupling(d, u, lean);
    return true;
  }

private:
  static constexpr double kStep = 0.05;  ///< of the abscissa, in which an anchor is moved at once

  template <class Number>
  [[nodiscard]] Number plain_coupling(const AtDepth& d, const Vec2Of<Number>& u, const Number& lean) const {
    return ratio_ * (lean * dot(d.slope, u) + 0.5 * dot(u, times(d.coupling, u)));
  }

  void set_scales(double depth_scale, double sideways_scale) {
    depth_scale_ = depth_scale;
    per_depth_ = 1 / depth_scale;
    ratio_ = sideways_scale / depth_scale;
  }

  [[nodiscard]] int order() const { return degrees().order; }
  /// The rule's own loss is not known beforehand to cover what is owed.
  [[nodiscard]] bool careful() const { return degrees().straight > 0 || order() > 2; }

  /// What is of degree 3 and 4 in u.
  void set_forms(double s, const runtime::Two& at, const runtime::Two& beyond, AtDepth& d) const {
    if (order() == 3) return set_cubic(rows_.sum_cubic(s), at, beyond, d);
    const auto sums = rows_.sum_more(s);
    set_cubic(sums, at, beyond, d);
    d.energy.m = sums.integral(Rows::kMean, at, beyond)[0], d.rate.m = sums.rate(Rows::kMean, at)[0];
    set_pair(sums, Rows::kSecond, at, beyond, d.energy.h2, d.rate.h2);
    set_pair(sums, Rows::kFourth, at, beyond, d.energy.h4, d.rate.h4);
  }
  template <class Sums>
  static void set_cubic(const Sums& sums, const runtime::Two& at, const runtime::Two& beyond, AtDepth& d) {
    set_pair(sums, Rows::kFirst, at, beyond, d.energy.h1, d.rate.h1);
    set_pair(sums, Rows::kThird, at, beyond, d.energy.h3, d.rate.h3);
  }
  template <class Sums>
  static void set_pair(const Sums& sums, int column, const runtime::Two& at, const runtime::Two& beyond, Vec2& integral,
                       Vec2& rate) {
    const runtime::Two of = sums.integral(column, at, beyond), by = sums.rate(column, at);
    integral = {of[0], of[1]};
    rate = {by[0], by[1]};
  }

  /// r.
  [[nodiscard]] double loss(const AtDepth& d, const Vec2& u) const {
    return d.rate.value(u, order()) - d.s * dot(u, times(d.coupling, u));
  }
  /// |T| h.
  struct LeastLoss {
    double square, by;  // (|T| h by)^2, and what to divide by (> 0)
    [[nodiscard]] bool covers(double loss) const { return !(loss > 0) || loss * by * (loss * by) <= square; }
    [[nodiscard]] double value() const { return std::sqrt(square) / by; }
  };
  [[nodiscard]] LeastLoss least_loss(const AtDepth& d, const Vec2& u, const Vec2& force) const {
    const Quotient<double> moved = quotient(d.energy.square, times(d.rate.square, u));
    return {dot(force, force) * dot(moved.of, moved.of), moved.by};
  }

  /// What the anchor rule asks for at one depth and deflection.
  struct Load {
    Vec2 force;     ///< T (N)
    double energy;  ///< W less the integral of F (N)
    double power;   ///< what the hand does on the way without F, by t (N)
    double owed;    ///< min(r, |T| h) (N)
  };
  struct Anchor {
    Vec2 u;
    Load load;
  };

  [[nodiscard]] Load load_at(const AtDepth& d, const Vec2& u, double lean) const {
    const Vec2 force = lean * d.straight + d.energy.gradient(u, order());
    const double all = loss(d, u);
    const LeastLoss least = least_loss(d, u, force);
    const double more = least.covers(all) ? 0 : all - least.value();
    const double power = d.s * (2 * lean * dot(d.slope, u) + dot(u, times(d.coupling, u))) + more;
    return {force, lean * dot(d.straight, u) + d.energy.value(u, order()), power, all - more};
  }

  /// The rule's own loss covers what is owed here.
  [[nodiscard]] bool settled(const AtDepth& d, const Anchor& a) const {
    return dot(a.load.force, solve(d.energy.hessian(a.u, order()), d.rate.gradient(a.u, order()))) >= a.load.owed;
  }

  /// The anchor at another depth such that T - g stays.
  [[nodiscard]] Anchor held(const AtDepth& from, const AtDepth& to, Anchor a, double lean) const {
    const Vec2 force = a.load.force - lean * from.straight;
    for (int round = 0; round < 2; ++round) {
      a.u = a.u - solve(to.energy.hessian(a.u, order()), to.energy.gradient(a.u, order()) - force);
    }
    a.load = load_at(to, a.u, lean);
    return a;
  }

  /// The energy (N) at the end of a step that the hand did not give, by the trapezoidal rule.
  [[nodiscard]] static double missing(double step, const Anchor& from, const Anchor& to) {
    return to.load.energy - from.load.energy - 0.5 * step * (from.load.power + to.load.power);
  }

  /// Moves the anchor on until next to none is, along the mean of T, which errs by the step's square only.
  void give_way(const AtDepth& d, double step, const Anchor& from, Anchor& to, double lean) const {
    for (int round = 0; round < kMostGivings; ++round) {
      const double lacks = missing(step, from, to), size = dot(to.load.force, to.load.force);
      if (!(lacks > 0 && size > 0)) return;
      const Vec2 mean = 0.5 * (from.load.force + to.load.force);
      const Vec2 along = dot(mean, to.load.force) > 0.5 * size ? mean : to.load.force;
      // Where the energy of K alone has fallen by what is missing, or is least.
      const double slope = dot(along, to.load.force), bend = dot(along, times(d.energy.square, along));
      const double rest = slope * slope - 2 * bend * lacks;
      to.u = to.u - (rest > 0 ? 2 * lacks / (slope + std::sqrt(rest)) : slope / bend) * along;
      to.load = load_at(d, to.u, lean);
    }
  }

  Rows rows_;
  double depth_scale_ = 1, per_depth_ = 1, ratio_ = 1;
};

}  // namespace palpate::coupled
