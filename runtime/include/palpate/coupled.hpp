// SPDX-License-Identifier: MIT
// The coupled response of one contact: energy of the sideways deflection, its part in the normal force, anchor rule.
#pragma once

#include "palpate/coupled_energy.hpp"
#include "palpate/coupled_layout.hpp"

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

/// Everything at one depth.
struct AtDepth {
  double s;       ///< min(t, 1)
  double push;    ///< F (N)
  double limit;   ///< mu
  Vec2 straight;  ///< g (N)
  Vec2 slope;     ///< dg/dt / (2 s) (N)
  Energy energy;  ///< V (N)
  Sym2 coupling;  ///< A / (2 s) (N)
  Energy rate;    ///< V' = dV/dt; only where it is needed: g, C or Q are there, or an anchor moves
};

/// A response whose coefficients are blended, ready to be evaluated. Fixed size.
class Law {
public:
  /// Forgets everything. Depth scale Z and sideways scale X in m.
  void clear(const Degrees& degrees, double depth_scale, double sideways_scale) {
    degrees_ = degrees;
    depth_scale_ = depth_scale;
    per_depth_ = 1 / depth_scale;
    ratio_ = sideways_scale / depth_scale;
    const int all = count(degrees);
    for (int k = 0; k < all; ++k) coefs_[k] = 0;
  }

  /// Adds a response's coefficients (count(degrees) of them, in the file's order), `unit` the N of one and `limit_unit`
  /// that of mu, with a weight; (cosine, sine) of the angle of its x axis in this law's frame.
  template <class Scalar>
  void add(const Scalar* coefs, double unit, double limit_unit, double weight, const Vec2& turned = {1, 0}) {
    const Vec2 second = product(turned, turned), third = product(second, turned), fourth = product(second, second);
    const double factor = weight * unit;
    double* to = coefs_;
    const auto scalars = [&](int n, double f) {
      for (int k = 0; k < n; ++k) *to++ += f * static_cast<double>(*coefs++);
    };
    const auto pair = [&](const Vec2& turn) {
      const Vec2 h = product({static_cast<double>(coefs[0]), static_cast<double>(coefs[1])}, turn);
      to[0] += factor * h.x;
      to[1] += factor * h.y;
      to += 2;
      coefs += 2;
    };
    scalars(degrees_.push - 1, factor);
    for (int k = 2; k <= degrees_.straight; ++k) pair(turned);
    for (int k = 0; k <= degrees_.stiffness + from_square(degrees_.stiffness); ++k) {  // stiffness, then coupling
      scalars(1, factor);
      pair(second);
    }
    for (int k = 0; degrees_.order > 2 && k <= degrees_.cubic; ++k) {
      pair(turned);
      pair(third);
    }
    for (int k = 0; degrees_.order > 3 && k <= degrees_.quartic; ++k) {
      scalars(1, factor);
      pair(second);
      pair(fourth);
    }
    scalars(degrees_.limit + 1, weight * limit_unit);
  }

  /// From Bernstein's basis to powers of s, once all responses are added.
  void finish() {
    double* at = coefs_;
    const auto convert = [&](int components, int first, int degree) {
      for (int k = degree; k >= first; --k) {
        for (int c = 0; c < components; ++c) {
          double sum = 0;
          for (int i = first; i <= k; ++i) {
            sum += alternating_binomial(k, i) * at[(i - first) * components + c];
          }
          at[(k - first) * components + c] = binomial(degree, k) * sum;
        }
      }
      if (degree >= first) at += components * (degree - first + 1);
    };
    convert(1, 2, degrees_.push);
    if (degrees_.straight > 0) convert(2, 2, degrees_.straight);
    convert(3, 0, degrees_.stiffness);
    convert(3, 2, degrees_.stiffness);
    if (degrees_.order > 2) convert(4, 0, degrees_.cubic);
    if (degrees_.order > 3) convert(5, 0, degrees_.quartic);
    convert(1, 0, degrees_.limit);
  }

  [[nodiscard]] const Degrees& degrees() const { return degrees_; }
  /// count(degrees()) of them; before finish() in the file's basis.
  [[nodiscard]] const double* coefs() const { return coefs_; }

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
    const double s = t < 1 ? t : 1, beyond = t - s;
    const double* from = coefs_;
    double value[5], slope[5];
    d.s = s;
    powers<1>(from, degrees_.push - 1, s, value, slope);
    d.push = s * s * value[0] + beyond * (2 * value[0] + slope[0]);
    from += degrees_.push - 1;
    if (degrees_.straight > 0) {
      powers<2>(from, degrees_.straight - 1, s, value, slope);
      from += 2 * (degrees_.straight - 1);
      const Vec2 end{2 * value[0] + s * slope[0], 2 * value[1] + s * slope[1]};  // dg/dt / s
      d.straight = s * s * Vec2{value[0], value[1]} + beyond * end;
      d.slope = 0.5 * end;
    } else {
      d.straight = d.slope = {0, 0};
    }
    const bool more = rates || careful();
    double* const rate = slope;
    double* const integral = value;
    integrate<3>(from, degrees_.stiffness + 1, s, beyond, integral, rate);
    from += 3 * (degrees_.stiffness + 1);
    d.energy.square = {integral[0], integral[1], integral[2]};
    if (more) d.rate.square = {rate[0], rate[1], rate[2]};
    powers<3>(from, from_square(degrees_.stiffness), s, value, slope);
    from += 3 * from_square(degrees_.stiffness);
    d.coupling = {0.5 * s * value[0], 0.5 * s * value[1], 0.5 * s * value[2]};
    if (degrees_.order > 2) {
      integrate<4>(from, degrees_.cubic + 1, s, beyond, integral, rate);
      from += 4 * (degrees_.cubic + 1);
      d.energy.h1 = {integral[0], integral[1]};
      d.energy.h3 = {integral[2], integral[3]};
      d.rate.h1 = {rate[0], rate[1]};
      d.rate.h3 = {rate[2], rate[3]};
    }
    if (degrees_.order > 3) {
      integrate<5>(from, degrees_.quartic + 1, s, beyond, integral, rate);
      from += 5 * (degrees_.quartic + 1);
      d.energy.m = integral[0];
      d.energy.h2 = {integral[1], integral[2]};
      d.energy.h4 = {integral[3], integral[4]};
      d.rate.m = rate[0];
      d.rate.h2 = {rate[1], rate[2]};
      d.rate.h4 = {rate[3], rate[4]};
    }
    powers<1>(from, degrees_.limit + 1, s, value, slope);
    d.limit = value[0];
  }

  /// T (N): the hand's sideways push; the force on the tool is -T.
  [[nodiscard]] Vec2 push(const AtDepth& d, const Vec2& u) const { return d.straight + d.energy.gradient(u, order()); }

  /// f_z - F (N), without the term that only the anchor rule's loss asks for: linear in the coefficients.
  [[nodiscard]] double plain_coupling(const AtDepth& d, const Vec2& u, double lean = 1) const {
    return ratio_ * (lean * dot(d.slope, u) + 0.5 * dot(u, times(d.coupling, u)));
  }

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
    for (int k = degrees_.push - 2; k >= 0; --k) {
      sum = sum * s + coefs_[k] / (k + 4);
      slope = slope * s + value;
      value = value * s + coefs_[k];
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
    if (!careful()) return solve(to.energy.square, times(from.energy.square, u));
    constexpr double kStep = 0.05;
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

private:
  [[nodiscard]] int order() const { return degrees_.order; }
  /// The rule's own loss is not known beforehand to cover what is owed.
  [[nodiscard]] bool careful() const { return degrees_.straight > 0 || degrees_.order > 2; }

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
    const Quotient moved = quotient(d.energy.square, times(d.rate.square, u));
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

  /// Moves the anchor on until none is, along the mean of T, which errs by the step's square only.
  void give_way(const AtDepth& d, double step, const Anchor& from, Anchor& to, double lean) const {
    for (int round = 0; round < 3; ++round) {
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

  /// Sum of c[k] s^k and its derivative, of several polynomials side by side.
  template <int Components>
  static void powers(const double* c, int terms, double s, double (&value)[5], double (&slope)[5]) {
    double sum[Components] = {}, rise[Components] = {};  // in registers
    for (int k = terms - 1; k >= 0; --k) {
      for (int i = 0; i < Components; ++i) {
        rise[i] = rise[i] * s + sum[i];
        sum[i] = sum[i] * s + c[k * Components + i];
      }
    }
    for (int i = 0; i < Components; ++i) {
      value[i] = sum[i];
      slope[i] = rise[i];
    }
  }

  /// The same sum, of at least one term, as `rate`, and its integral from 0 to s, continued by `beyond` times its end.
  template <int Components>
  static void integrate(const double* c, int terms, double s, double beyond, double* integral, double* rate) {
    constexpr double kShare[kMaxDegree + 1] = {1, 1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5, 1.0 / 6, 1.0 / 7};
    double sum[Components], end[Components];  // in registers
    for (int i = 0; i < Components; ++i) {
      end[i] = c[(terms - 1) * Components + i];
      sum[i] = kShare[terms - 1] * end[i];
    }
    for (int k = terms - 2; k >= 0; --k) {
      for (int i = 0; i < Components; ++i) {
        end[i] = end[i] * s + c[k * Components + i];
        sum[i] = sum[i] * s + kShare[k] * c[k * Components + i];
      }
    }
    for (int i = 0; i < Components; ++i) {
      integral[i] = s * sum[i] + beyond * end[i];
      rate[i] = end[i];
    }
  }

  Degrees degrees_;
  double depth_scale_ = 1, per_depth_ = 1, ratio_ = 1;
  double coefs_[kMostCoefs] = {};
};

}  // namespace palpate::coupled
