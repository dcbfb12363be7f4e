// SPDX-License-Identifier: MIT
// Clamped uniform cubic B-splines, of which the curves of bonded contacts are made.
#pragma once

namespace palpate::spline {

/// The four basis functions that are not zero at an abscissa: coefficients first .. first + 3.
struct Basis {
  int first = 0;
  double weight[4] = {0, 0, 0, 0};
};

namespace detail {

/// The basis functions on one interval, as cubics in the share v in [0, 1] of the interval.
struct Cubics {
  double coef[4][4] = {};  ///< [power of v][function]
};

/// Cox and de Boor's recursion up to `degree`, on an interval with `before` intervals before it and `after` after it.
/// 2 stands for two or more, because farther knots have no influence. Knots are one interval apart, clamped at the ends.
constexpr Cubics recurse(int before, int after, int degree) {
  Cubics w;
  w.coef[0][0] = 1;
  for (int j = 1; j <= degree; ++j) {
    Cubics next;
    for (int r = 0; r < j; ++r) {
      // The knots right and left of the interval's start are at `high` and -`low`. Their distance is 1, 2 or 3.
      const int high = r + 1 < after + 1 ? r + 1 : after + 1, low = j - r - 1 < before ? j - r - 1 : before;
      for (int power = 0; power < degree; ++power) {
        const double share = w.coef[power][r] / (high + low);
        next.coef[power][r] += high * share;
        next.coef[power + 1][r] -= share;
        next.coef[power][r + 1] += low * share;
        next.coef[power + 1][r + 1] += share;
      }
    }
    w = next;
  }
  return w;
}

struct CubicsTable {
  Cubics at[3][3];  ///< [intervals before][intervals after], 2 for two or more
};

constexpr CubicsTable make_table(int degree) {
  CubicsTable table;
  for (int before = 0; before < 3; ++before) {
    for (int after = 0; after < 3; ++after) table.at[before][after] = recurse(before, after, degree);
  }
  return table;
}

inline constexpr CubicsTable kValues = make_table(3);
inline constexpr CubicsTable kQuadratics = make_table(2);

/// Finds the interval of u (clamped to [0, 1]; NaN counts as 0) and evaluates its functions there.
inline Basis evaluate(const CubicsTable& table, int count, double u) {
  const double t = (u > 0 ? (u < 1 ? u : 1.0) : 0.0) * (count - 3);
  const int last = count - 4;
  Basis b;
  b.first = static_cast<int>(t) < last ? static_cast<int>(t) : last;
  const int after = last - b.first;
  const Cubics& c = table.at[b.first < 2 ? b.first : 2][after < 2 ? after : 2];
  const double v = t - b.first, v2 = v * v;
  for (int k = 0; k < 4; ++k) b.weight[k] = (c.coef[0][k] + v * c.coef[1][k]) + v2 * (c.coef[2][k] + v * c.coef[3][k]);
  return b;
}

}  // namespace detail

/// Basis of `count` >= 4 coefficients at u, clamped to [0, 1]. Weights sum to 1 and are >= 0 to round-off.
inline Basis basis(int count, double u) { return detail::evaluate(detail::kValues, count, u); }

/// Basis of the first derivative by u. Weights sum to 0.
inline Basis slope_basis(int count, double u) {
  const Basis quadratic = detail::evaluate(detail::kQuadratics, count, u);
  const auto knot = [count](int i) { return i < 3 ? 0 : i > count ? count - 3 : i - 3; };
  Basis b;
  b.first = quadratic.first;
  for (int r = 0; r < 3; ++r) {
    const int i = b.first + r + 1;  // the quadratic lies on the knots i .. i + 3
    const double share = 3.0 * (count - 3) * quadratic.weight[r] / (knot(i + 3) - knot(i));
    b.weight[r] -= share;
    b.weight[r + 1] += share;
  }
  return b;
}

/// Sum of the weights times the coefficients that they belong to.
template <class Scalar>
inline double combine(const Basis& b, const Scalar* coefs) {
  const Scalar* c = coefs + b.first;
  // Two sums of two: compilers evaluate them side by side.
  double sum[2];
  for (int k = 0; k < 2; ++k) sum[k] = b.weight[k] * c[k] + b.weight[k + 2] * c[k + 2];
  return sum[0] + sum[1];
}

/// Value at u, clamped to [0, 1].
template <class Scalar>
inline double value(const Scalar* coefs, int count, double u) {
  return combine(basis(count, u), coefs);
}

/// Abscissa of coefficient `index` (Greville). The spline with these coefficients is u itself.
inline double greville(int count, int index) {
  const int intervals = count - 3;
  int sum = 0;
  for (int j = 1; j <= 3; ++j) {
    const int knot = index + j - 3;
    sum += knot < 0 ? 0 : knot > intervals ? intervals : knot;
  }
  return sum / (3.0 * intervals);
}

}  // namespace palpate::spline
