// SPDX-License-Identifier: MIT
// The coefficients of a blended coupled response, laid so that all its families are summed in one go.
#pragma once

#include "palpate/coupled_energy.hpp"
#include "palpate/coupled_layout.hpp"
#include "palpate/lanes.hpp"

#include <type_traits>

namespace palpate::coupled {

/// What answers a power of s lies side by side: one pass from the highest power down sums every family, without a loop
/// of its own for each. Those that an energy is made of are kept as their integrals, divided by s. Fixed size.
class Rows {
public:
  using Two = runtime::Two;
  /// Of the forms of degree 2, and with the straight push; with slopes: the first kSloped. Harmonics are pairs of
  /// columns that begin at even ones, and scalars lie by twos: so they turn, and are summed, side by side.
  enum Column {
    kStraight = 0,
    kStiffness = 2,
    kStiffnessMean = 4,
    kPush = 5,
    kCoupling = 6,
    kCouplingMean = 8,
    kLimit = 9
  };
  /// Of the forms of degree 3 and 4, all with slopes: the harmonics of C, then those and the mean of Q.
  enum MoreColumn { kFirst = 0, kThird = 2, kSecond = 4, kFourth = 6, kMean = 8 };

  static constexpr int kColumns = 10, kSloped = 6, kCubic = 4;  ///< and those of C
  /// Of the first columns P, each a polynomial in s, and dP/ds; columns with slopes alone have rates and integrals.
  template <int Columns, int Sloped>
  struct Sums {
    Two value[Columns / 2], slope[Sloped / 2];

    /// Of the column that is given and the next, all of these.
    [[nodiscard]] const Two& two(int column) const { return value[column / 2]; }
    /// d(s^2 P)/ds over s.
    [[nodiscard]] Two rise(int column, const Two& s) const { return 2.0 * two(column) + s * slope[column / 2]; }
    /// d(s P)/ds.
    [[nodiscard]] Two rate(int column, const Two& s) const { return two(column) + s * slope[column / 2]; }
    /// s P, continued by `beyond` times its rate.
    [[nodiscard]] Two integral(int column, const Two& s, const Two& beyond) const {
      return s * two(column) + beyond * rate(column, s);
    }
  };

  [[nodiscard]] const Degrees& degrees() const { return degrees_; }

  /// Of coefficients in the file's order and in Bernstein's basis.
  void set(const Degrees& degrees, const double* coefs) {
    resize(degrees);
    const auto scalar = [&](Row* rows, int column, int component, int components, int first, int degree, bool energy) {
      to_powers<1>(coefs + component, components, rows->of + column, first, degree, energy);
    };
    const auto pair = [&](Row* rows, int column, int component, int components, int first, int degree, bool energy) {
      if constexpr (kAtOnce == 2) {
        to_powers<2>(coefs + component, components, rows->of + column, first, degree, energy);
      } else {
        scalar(rows, column, component, components, first, degree, energy);
        scalar(rows, column + 1, component + 1, components, first, degree, energy);
      }
    };
    const auto done = [&](int components, int first, int degree) { coefs += components * (degree + 1 - first); };
    scalar(at_, kPush, 0, 1, 2, degrees.push, false);
    done(1, 2, degrees.push);
    if (degrees.straight > 0) {
      pair(at_, kStraight, 0, 2, 2, degrees.straight, false);
      done(2, 2, degrees.straight);
    }
    scalar(at_, kStiffnessMean, 0, 3, 0, degrees.stiffness, true);
    pair(at_, kStiffness, 1, 3, 0, degrees.stiffness, true);
    done(3, 0, degrees.stiffness);
    if (degrees.stiffness > 0) {
      scalar(at_, kCouplingMean, 0, 3, 2, degrees.stiffness, false);
      pair(at_, kCoupling, 1, 3, 2, degrees.stiffness, false);
      done(3, 2, degrees.stiffness);
    }
    if (degrees.order > 2) {
      pair(more_, kFirst, 0, 4, 0, degrees.cubic, true);
      pair(more_, kThird, 2, 4, 0, degrees.cubic, true);
      done(4, 0, degrees.cubic);
    }
    if (degrees.order > 3) {
      scalar(more_, kMean, 0, 5, 0, degrees.quartic, true);
      pair(more_, kSecond, 1, 5, 0, degrees.quartic, true);
      pair(more_, kFourth, 3, 5, 0, degrees.quartic, true);
      done(5, 0, degrees.quartic);
    }
    scalar(at_, kLimit, 0, 1, 0, degrees.limit, false);
  }

  /// A part of a blend: rows times a factor; (cosine, sine) of the angle of their x axis in the frame of the blend.
  struct Share {
    const Rows* rows;
    double factor;
    Vec2 turned;
  };
  /// The sum of rows of the same degrees.
  void blend(const Share (&shares)[3]) {
    const Rows& first = *shares[0].rows;
    degrees_ = first.degrees_;
    rows_ = first.rows_;
    more_rows_ = first.more_rows_;
    const Row *from[3], *more_from[3];
    Turns by[3], more_by[3];
    for (int i = 0; i < 3; ++i) {
      const Vec2 one = shares[i].turned, two = product(one, one);
      const double factor = shares[i].factor;
      from[i] = shares[i].rows->at_;
      by[i] = {{factor * one, factor * two, {factor, 0}, factor * two, {factor, 0}}};
      if (degrees_.order == 2) continue;
      more_from[i] = shares[i].rows->more_;
      more_by[i] = {{factor * one, factor * product(two, one), factor * two, factor * product(two, two), {factor, 0}}};
    }
    add_turned<false>(from, by, rows_, at_);
    if (degrees_.order > 2) add_turned<true>(more_from, more_by, more_rows_, more_);
  }

  /// At s.
  [[nodiscard]] auto sum(double s) const { return add_up<kColumns, kSloped>(at_, rows_, s); }
  [[nodiscard]] auto sum_cubic(double s) const { return add_up<kCubic, kCubic>(more_, more_rows_, s); }
  [[nodiscard]] auto sum_more(double s) const { return add_up<kColumns, kColumns>(more_, more_rows_, s); }

  /// That of s^(2 + k) in F, k < degrees().push - 1.
  [[nodiscard]] double push(int k) const { return at_[k].of[kPush]; }

private:
  struct alignas(16) Row {
    double of[kColumns];
  };

#ifdef __OPTIMIZE_SIZE__
  static constexpr int kAtOnce = 1;
#else
  static constexpr int kAtOnce = 2;
#endif
  /// Components of a family, of Bernstein's basis (n over k) s^k (1 - s)^(n - k) with n = `degree` and k from `first`
  /// (0 or 2) on, as powers s^(k - first), or where an energy is made of it, these integrated over s. Not inlined:
  /// loops over components that only run time knows are slower than all this.
  template <int components>
  [[gnu::noinline]] static void to_powers(const double* from, int stride, double* to, int first, int degree,
                                          bool energy) {
    const auto of_degree = [&](auto n) {
      if (first == 0) return to_powers<components, n, 0>(from, stride, to, energy);
      to_powers<components, n, 2>(from, stride, to, energy);
    };
    switch (degree) {  // known to the compiler, all is in registers
      case 0:
        return of_degree(std::integral_constant<int, 0>());
      case 1:
        return of_degree(std::integral_constant<int, 1>());
      case 2:
        return of_degree(std::integral_constant<int, 2>());
      case 3:
        return of_degree(std::integral_constant<int, 3>());
      case 4:
        return of_degree(std::integral_constant<int, 4>());
      case 5:
        return of_degree(std::integral_constant<int, 5>());
      default:
        return of_degree(std::integral_constant<int, kMaxDegree>());
    }
  }
  template <int components, int degree, int first>
  static void to_powers(const double* from, int stride, double* to, bool energy) {
    constexpr PowerScales<degree> kScales;
    double b[degree + 1][components] = {};
#pragma GCC unroll 8
    for (int k = first; k <= degree; ++k) {
#pragma GCC unroll 8
      for (int c = 0; c < components; ++c) b[k][c] = from[(k - first) * stride + c];
    }
#pragma GCC unroll 8
    for (int order = 1; order <= degree; ++order) {  // of differences
#pragma GCC unroll 8
      for (int k = degree; k >= order; --k) {
#pragma GCC unroll 8
        for (int c = 0; c < components; ++c) b[k][c] -= b[k - 1][c];
      }
    }
#pragma GCC unroll 8
    for (int k = first; k <= degree; ++k) {
      const double scale = kScales.of[energy ? 1 : 0][k];
#pragma GCC unroll 8
      for (int c = 0; c < components; ++c) to[(k - first) * kColumns + c] = scale * b[k][c];
    }
  }
  template <int degree>
  struct PowerScales {
    double of[2][degree + 1] = {};
    constexpr PowerScales() {
      for (int k = 0; k <= degree; ++k) {
        of[0][k] = binomial(degree, k);
        of[1][k] = binomial(degree, k) / (k + 1);
      }
    }
  };

  /// By what every two columns are multiplied, as complex numbers.
  struct Turns {
    Vec2 of[kColumns / 2];
  };
  template <bool more>
  static void add_turned(const Row* const (&from)[3], const Turns (&by)[3], int rows, Row* to) {
    for (int k = 0; k < rows; ++k) {
#pragma GCC unroll 8
      for (int c = 0; c < kColumns; c += 2) {
        const bool turns = more ? c != kMean : c != kStiffnessMean && c != kCouplingMean;
        double x = 0, y = 0;
#pragma GCC unroll 8
        for (int i = 0; i < 3; ++i) {
          const double fx = from[i][k].of[c], fy = from[i][k].of[c + 1];
          const Vec2& turn = by[i].of[c / 2];
          x += turns ? turn.x * fx - turn.y * fy : turn.x * fx;
          y += turns ? turn.x * fy + turn.y * fx : turn.x * fy;
        }
        to[k].of[c] = x;
        to[k].of[c + 1] = y;
      }
    }
  }

  /// Rows of no coefficients yet.
  void resize(const Degrees& degrees) {
    degrees_ = degrees;
    rows_ = more_rows_ = 1;
    const auto reach = [](int& rows, int needed) { rows = rows < needed ? needed : rows; };
    reach(rows_, degrees.push - 1);
    reach(rows_, degrees.straight - 1);
    reach(rows_, degrees.stiffness + 1);
    reach(rows_, degrees.limit + 1);
    for (int k = 0; k < rows_; ++k) at_[k] = {};
    if (degrees.order == 2) return;
    reach(more_rows_, degrees.cubic + 1);
    reach(more_rows_, degrees.quartic + 1);
    for (int k = 0; k < more_rows_; ++k) more_[k] = {};
  }

  /// Horner's rule, and of the first columns the derivative's.
  template <int Columns, int Sloped>
  static Sums<Columns, Sloped> add_up(const Row* rows, int count, double s) {
    const Two at = runtime::two(s, s);
    const auto column = [](const Row& row, int i) { return runtime::two(row.of[2 * i], row.of[2 * i + 1]); };
    Sums<Columns, Sloped> sums{};  // in registers until all are added
    for (int i = 0; i < Columns / 2; ++i) sums.value[i] = column(rows[count - 1], i);
    for (int k = count - 2; k >= 0; --k) {
      for (int i = 0; i < Sloped / 2; ++i) sums.slope[i] = sums.slope[i] * at + sums.value[i];
      for (int i = 0; i < Columns / 2; ++i) sums.value[i] = sums.value[i] * at + column(rows[k], i);
    }
    return sums;
  }

  Degrees degrees_;
  int rows_ = 1, more_rows_ = 1;
  Row at_[kMaxDegree + 1] = {}, more_[kMaxDegree + 1] = {};
};

}  // namespace palpate::coupled
