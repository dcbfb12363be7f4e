// SPDX-License-Identifier: MIT
// Clamped uniform cubic B-splines: the one basis that the fit and the runtime share.
#pragma once

#include <cmath>

namespace palpate::spline {

/// The four basis functions that are not zero at an abscissa: coefficients first .. first + 3.
struct Basis {
  int first = 0;
  double weight[4] = {0, 0, 0, 0};
};

namespace detail {

/// The four basis functions on one interval, as cubics in the share v in [0, 1] of the interval.
struct Cubics {
  double coef[4][4] = {};  ///< [power of v][function]
};

/// Cox and de Boor's recursion up to `degree` on an interval with `before` intervals before it and `after` behind
/// (2 stands for more, too: farther knots do not matter). Knots are one interval apart, clamped at the ends.
constexpr Cubics recurse(int before, int after, int degree) {
  Cubics w;
  w.coef[0][0] = 1;
  for (int j = 1; j <= degree; ++j) {
    Cubics next;
    for (int r = 0; r < j; ++r) {
      // Knots right and left of the interval's start: at `high` and -`low`; their distance is 1, 2 or 3.
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

/// The same function by function.
struct Columns {
  double of[4][4] = {};  ///< [function][power of v]
};

struct ColumnsTable {
  Columns at[3][3];
};

constexpr ColumnsTable turned(const CubicsTable& table) {
  ColumnsTable turned;
  for (int k = 0; k < 3 * 3 * 4 * 4; ++k) {
    const int before = k / 48, after = k / 16 % 3, function = k / 4 % 4, power = k % 4;
    turned.at[before][after].of[function][power] = table.at[before][after].coef[power][function];
  }
  return turned;
}

inline constexpr CubicsTable kValues = make_table(3);
inline constexpr ColumnsTable kColumns = turned(kValues);
inline constexpr CubicsTable kQuadratics = make_table(2);

/// Integrals of the four functions over their interval: of themselves, and times the share v.
struct Moments {
  double area[4] = {}, moment[4] = {};
};

struct MomentsTable {
  Moments at[3][3];
};

constexpr MomentsTable make_moments(const CubicsTable& of) {
  MomentsTable table;
  for (int before = 0; before < 3; ++before) {
    for (int after = 0; after < 3; ++after) {
      Moments& to = table.at[before][after];
      for (int k = 0; k < 4; ++k) {
        for (int p = 0; p < 4; ++p) {
          to.area[k] += of.at[before][after].coef[p][k] / (p + 1);
          to.moment[k] += of.at[before][after].coef[p][k] / (p + 2);
        }
      }
    }
  }
  return table;
}

inline constexpr MomentsTable kMoments = make_moments(kValues);

template <class Table>
inline const auto& on_interval(const Table& table, int count, int interval) {
  const int after = count - 4 - interval;
  return table.at[interval < 2 ? interval : 2][after < 2 ? after : 2];
}

}  // namespace detail

/// u in [0, 1] (clamped into it; a NaN lands at 0) in knot intervals of a spline of `count` >= 4 coefficients.
inline double in_intervals(int count, double u) { return (u > 0 ? (u < 1 ? u : 1.0) : 0.0) * (count - 3); }

/// The knot interval of t = in_intervals(count, u).
inline int interval_of(int count, double t) {
  const int interval = static_cast<int>(t), last = count - 4;
  return interval < last ? interval : last;
}

/// The same of a spline that goes on along its tangents: before u = 0 (and where t is no number) it is -1, beyond u = 1
/// the one after the last.
inline int interval_onwards(int count, double t) {
#if defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'M' && (__ARM_FP & 8) != 0
  // One instruction each on a microcontroller, where a branch takes three. The very end counts as beyond: what goes on
  // there is the same.
  return static_cast<int>(std::fmin(std::fmax(std::floor(t), -1.0), count - 3.0));
#else
  return !(t >= 0) ? -1 : t > count - 3 ? count - 3 : interval_of(count, t);
#endif
}

/// The first of the four coefficients that take part on such an interval.
inline int first_on(int count, int interval) { return interval < 0 ? 0 : interval < count - 3 ? interval : count - 4; }

/// What splines are on one knot interval, by powers of the share of the interval.
template <class Number>
struct CubicOf {
  Number power[4];
};
using Cubic = CubicOf<double>;

/// A knot interval (interval_onwards) of splines of `count` coefficients, looked up once for all that are asked there.
class Interval {
public:
  Interval(int count, int number)
      : first_(first_on(count, number)),
        beyond_(number < 0           ? -1
                : number < count - 3 ? 0
                                     : 1),
        of_(beyond_ == 0 ? &detail::on_interval(detail::kColumns, count, number) : nullptr) {}

  /// Of four coefficients that take part there, or of as many numbers side by side.
  template <class Number>
  [[nodiscard]] CubicOf<Number> of_four(const Number (&four)[4]) const {
    if (beyond_ > 0) return {{four[3], 3.0 * (four[3] - four[2]), 0.0 * four[3], 0.0 * four[3]}};
    if (beyond_ < 0) {
      const Number rise = 3.0 * (four[1] - four[0]);
      return {{four[0] - rise, rise, 0.0 * rise, 0.0 * rise}};
    }
    CubicOf<Number> c;
    for (int p = 0; p < 4; ++p) c.power[p] = of_->of[0][p] * four[0];
    for (int k = 1; k < 3; ++k) {
      for (int p = 0; p < 4; ++p) c.power[p] = c.power[p] + of_->of[k][p] * four[k];
    }
    c.power[3] = c.power[3] + of_->of[3][3] * four[3];  // the last function starts like a cube
    return c;
  }
  /// Of all coefficients.
  template <class Scalar>
  [[nodiscard]] Cubic cubic(const Scalar* coefs) const {
    const Scalar* from = coefs + first_;
    const double four[4] = {from[0], from[1], from[2], from[3]};
    return of_four(four);
  }
  /// Of the coefficients that take part.
  [[nodiscard]] int first() const { return first_; }
  /// One of the intervals: what each of those adds there, by powers. Beyond there are no such columns.
  [[nodiscard]] bool inside() const { return beyond_ == 0; }
  [[nodiscard]] const double (&columns() const)[4][4] { return of_->of; }

private:
  int first_, beyond_;  ///< -1 before the first interval, 1 behind the last
  const detail::Columns* of_;
};

/// At a share v of the interval.
inline double value(const Cubic& f, double v) {
  return (f.power[0] + v * f.power[1]) + v * v * (f.power[2] + v * f.power[3]);
}

/// Integral of t f(t) dt, in knot intervals, of the spline f with these coefficients: from 0 to the start of an
/// interval.
template <class Scalar>
inline double first_moment(const Scalar* coefs, int count, int interval) {
  double sum = 0;
  for (int i = 0; i < interval; ++i) {
    const int after = count - 4 - i;
    const detail::Moments& of = detail::kMoments.at[i < 2 ? i : 2][after < 2 ? after : 2];
    for (int k = 0; k < 4; ++k) sum += (i * of.area[k] + of.moment[k]) * coefs[i + k];
  }
  return sum;
}

/// The same from there to a share v of the interval, on which f is this cubic.
inline double first_moment(const Cubic& f, int interval, double v) {
  double sum = 0;
  for (int p = 3; p >= 0; --p) sum = sum * v + f.power[p] * (interval / (p + 1.0) + v / (p + 2.0));
  return sum * v;
}

namespace detail {

/// Sets the interval and evaluates its functions there.
inline Basis evaluate(const CubicsTable& table, int count, double u) {
  const double t = in_intervals(count, u);
  Basis b;
  b.first = interval_of(count, t);
  const double v = t - b.first;
  const Cubics& c = on_interval(table, count, b.first);
  const double v2 = v * v;
  for (int k = 0; k < 4; ++k) b.weight[k] = (c.coef[0][k] + v * c.coef[1][k]) + v2 * (c.coef[2][k] + v * c.coef[3][k]);
  return b;
}

}  // namespace detail

/// Basis of `count` >= 4 coefficients at u in [0, 1] (clamped into it). Weights sum to 1 and are >= 0 to round-off.
inline Basis basis(int count, double u) { return detail::evaluate(detail::kValues, count, u); }

/// The same of a spline that goes on along its tangent beyond u = 1.
inline Basis basis_onwards(int count, double u) {
  if (!(u > 1)) return basis(count, u);
  const double rise = 3.0 * (count - 3) * (u - 1);
  return {count - 4, {0, 0, -rise, 1 + rise}};
}

/// Basis of the first derivative with respect to u. Weights sum to 0.
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

template <class Scalar>
inline double combine(const Basis& b, const Scalar* coefs) {
  const Scalar* c = coefs + b.first;
  // Two sums of two: compilers put them side by side.
  double sum[2];
  for (int k = 0; k < 2; ++k) sum[k] = b.weight[k] * c[k] + b.weight[k + 2] * c[k + 2];
  return sum[0] + sum[1];
}

/// Value at u in [0, 1].
template <class Scalar>
inline double value(const Scalar* coefs, int count, double u) {
  return combine(basis(count, u), coefs);
}

/// Abscissa of coefficient `index` (Greville): the spline with these coefficients reproduces u itself.
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
