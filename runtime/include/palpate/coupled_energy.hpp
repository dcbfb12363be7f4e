// SPDX-License-Identifier: MIT
// Energy of a sideways deflection at one depth: forms of degree 2 to 4 by their harmonics; all else of that depth.
#pragma once

#include <cmath>

namespace palpate::coupled {

// These are trivial types: what is not asked for costs no instruction.
/// Of one deflection, or of several side by side (Two).
template <class Number>
struct Vec2Of {
  Number x, y;
};
using Vec2 = Vec2Of<double>;

template <class Number>
inline Vec2Of<Number> operator+(const Vec2Of<Number>& a, const Vec2Of<Number>& b) {
  return {a.x + b.x, a.y + b.y};
}
template <class Number>
inline Vec2Of<Number> operator-(const Vec2Of<Number>& a, const Vec2Of<Number>& b) {
  return {a.x - b.x, a.y - b.y};
}
template <class Number>
inline Vec2Of<Number> operator*(double s, const Vec2Of<Number>& a) {
  return {s * a.x, s * a.y};
}
/// `a` of the same numbers as b, or of one number for all of them.
template <class Each, class Number>
inline Number dot(const Vec2Of<Each>& a, const Vec2Of<Number>& b) {
  return a.x * b.x + a.y * b.y;
}
/// As complex numbers.
inline Vec2 product(const Vec2& a, const Vec2& b) { return {a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x}; }
inline Vec2 conjugate(const Vec2& a) { return {a.x, -a.y}; }

/// m I + [[x, y], [y, -x]].
struct Sym2 {
  double m, x, y;
};
template <class Number>
inline Vec2Of<Number> times(const Sym2& k, const Vec2Of<Number>& u) {
  return {(k.m + k.x) * u.x + k.y * u.y, k.y * u.x + (k.m - k.x) * u.y};
}
/// A vector that is still to be divided.
template <class Number>
struct Quotient {
  Vec2Of<Number> of;
  double by;  ///< above 0
};
/// k^-1 b, k positive; where k resists along one line only, as good as, what lies on that line (k is 2 m v v then).
template <class Number>
inline Quotient<Number> quotient(const Sym2& k, const Vec2Of<Number>& b) {
  const double det = k.m * k.m - k.x * k.x - k.y * k.y;
  if (!(k.m > 0)) return {Vec2Of<Number>{}, 1};
  if (!(det > 1e-12 * k.m * k.m)) return {times(k, b), 4 * k.m * k.m};
  return {{(k.m - k.x) * b.x - k.y * b.y, (k.m + k.x) * b.y - k.y * b.x}, det};
}
inline Vec2 solve(const Sym2& k, const Vec2& b) {
  const Quotient<double> q = quotient(k, b);
  return {q.of.x / q.by, q.of.y / q.by};
}

/// Forms of degree 2 to 4 in u, by harmonics: Re(conj(h) u^n) |u|^(degree - n).
struct Energy {
  Sym2 square;  ///< K: u K u / 2
  Vec2 h1, h3;  ///< C
  double m;     ///< Q
  Vec2 h2, h4;

  [[nodiscard]] double value(const Vec2& u, int order) const {
    const double quadratic = 0.5 * dot(u, times(square, u));
    return order < 3 ? quadratic : quadratic + forms(u, order);
  }
  [[nodiscard]] Vec2 gradient(const Vec2& u, int order) const {
    const Vec2 linear = times(square, u);
    return order < 3 ? linear : linear + forms_gradient(u, order);
  }

  /// Of all forms inside |u| <= 1, of the square alone outside.
  [[nodiscard]] Sym2 hessian(const Vec2& u, int order) const {
    Sym2 sum = square;
    if (order < 3 || dot(u, u) > 1) return sum;
    const auto outer = [&](double scale, const Vec2& a, const Vec2& b) {  // scale (a b + b a)
      sum.m += scale * (a.x * b.x + a.y * b.y);
      sum.x += scale * (a.x * b.x - a.y * b.y);
      sum.y += scale * (a.x * b.y + a.y * b.x);
    };
    const auto turn = [&](double scale, const Vec2& w) {
      sum.x += scale * w.x;
      sum.y += scale * w.y;
    };
    const Vec2 c = conjugate(u);
    sum.m += 2 * dot(h1, u);
    outer(2, h1, u);
    turn(6, product(h3, c));
    if (order < 4) return sum;
    const double r2 = dot(u, u);
    const Vec2 p = product(h2, c);
    sum.m += 4 * m * r2 + 2 * dot(p, u);
    outer(4 * m, u, u);
    outer(4, u, p);
    turn(2 * r2, h2);
    turn(12, product(h4, product(c, c)));
    return sum;
  }

private:
  /// Those of degree 3 and 4, which beyond |u| = 1 go on linearly along the ray. Out of line: most files have none.
  [[nodiscard, gnu::noinline]] double forms(const Vec2& u, int order) const {
    const double r2 = dot(u, u);
    if (!(r2 > 1)) return cubic(u) + (order > 3 ? quartic(u) : 0);
    const double r = std::sqrt(r2);
    const Vec2 on = (1 / r) * u;
    return (3 * r - 2) * cubic(on) + (order > 3 ? (4 * r - 3) * quartic(on) : 0);
  }
  [[nodiscard, gnu::noinline]] Vec2 forms_gradient(const Vec2& u, int order) const {
    const double r2 = dot(u, u);
    if (!(r2 > 1)) return order > 3 ? cubic_gradient(u) + quartic_gradient(u) : cubic_gradient(u);
    const double r = std::sqrt(r2);
    const Vec2 on = (1 / r) * u;
    const auto outside = [&](double degree, double form, const Vec2& slope) {
      const Vec2 radial = degree * form * on;
      return radial + ((degree * r - degree + 1) / r) * (slope - radial);
    };
    const Vec2 sum = outside(3, cubic(on), cubic_gradient(on));
    return order > 3 ? sum + outside(4, quartic(on), quartic_gradient(on)) : sum;
  }

  [[nodiscard]] double cubic(const Vec2& u) const {
    return dot(h1, u) * dot(u, u) + dot(h3, product(u, product(u, u)));
  }
  [[nodiscard]] Vec2 cubic_gradient(const Vec2& u) const {
    const Vec2 c = conjugate(u);
    return dot(u, u) * h1 + 2 * dot(h1, u) * u + 3 * product(h3, product(c, c));
  }
  [[nodiscard]] double quartic(const Vec2& u) const {
    const double r2 = dot(u, u);
    const Vec2 square2 = product(u, u);
    return r2 * (m * r2 + dot(h2, square2)) + dot(h4, product(square2, square2));
  }
  [[nodiscard]] Vec2 quartic_gradient(const Vec2& u) const {
    const double r2 = dot(u, u);
    const Vec2 c = conjugate(u), p = product(h2, c);
    return (4 * m * r2 + 2 * dot(p, u)) * u + 2 * r2 * p + 4 * product(h4, product(c, product(c, c)));
  }
};

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

}  // namespace palpate::coupled
