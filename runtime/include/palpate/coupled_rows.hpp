// SPDX-License-Identifier: MIT
// The coefficients of a blended coupled response, laid so that all its families are summed in one go.
#pragma once

#include "palpate/coupled_energy.hpp"
#include "palpate/coupled_layout.hpp"

#include <type_traits>

namespace palpate::coupled {

/// What answers a power of s lies side by side: one pass from the highest power down sums every family, without a loop
/// of its own for each. Those that an energy is made of are kept as their integrals, divided by s. Fixed size.
class Rows {
public:
  /// Of the forms of degree 2, and with the straight push; with slopes: the first kSloped.
  enum Column { kStraight = 0, kStiffness = 2, kPush = 5, kCoupling = 6, kLimit = 9 };
  /// Of the forms of degree 3 and 4, all with slopes.
  enum MoreColumn { kCubic = 0, kQuartic = 4 };

  static constexpr int kColumns = 10, kSloped = 6;
  /// Of each column P, a polynomial in s, and dP/ds; columns with slopes alone have rates and integrals.
  template <int Sloped>
  struct Sums {
    double value[kColumns], slope[Sloped];

    /// d(s^2 P)/ds over s.
    [[nodiscard]] double rise(int column, double s) const { return 2 * value[column] + s * slope[column]; }
    /// d(s P)/ds.
    [[nodiscard]] double rate(int column, double s) const { return value[column] + s * slope[column]; }
    /// s P, continued by `beyond` times its rate.
    [[nodiscard]] double integral(int column, double s, double beyond) const {
      return s * value[column] + beyond * rate(column, s);
    }
  };

  [[nodiscard]] const Degrees& degrees() const { return degrees_; }

  /// Of coefficients in the file's order and in Bernstein's basis.
  void set(const Degrees& degrees, const double* coefs) {
    degrees_ = degrees;
    rows_ = more_rows_ = 1;
    const auto reach = [](int& rows, int needed) { rows = rows < needed ? needed : rows; };
    reach(rows_, degrees.push - 1);
    reach(rows_, degrees.straight - 1);
    reach(rows_, degrees.stiffness + 1);
    reach(rows_, degrees.limit + 1);
    for (int k = 0; k < rows_; ++k) at_[k] = {};
    const auto take = [&](Row* rows, int column, int components, int first, int degree, bool energy) {
      int c = 0;
      for (; c + kAtOnce <= components; c += kAtOnce) {
        to_powers<kAtOnce>(coefs + c, components, rows->of + column + c, first, degree, energy);
      }
      for (; c < components; ++c) {
        to_powers<1>(coefs + c, components, rows->of + column + c, first, degree, energy);
      }
      coefs += components * (degree + 1 - first);
    };
    take(at_, kPush, 1, 2, degrees.push, false);
    if (degrees.straight > 0) take(at_, kStraight, 2, 2, degrees.straight, false);
    take(at_, kStiffness, 3, 0, degrees.stiffness, true);
    if (degrees.stiffness > 0) take(at_, kCoupling, 3, 2, degrees.stiffness, false);
    if (degrees.order > 2) {
      reach(more_rows_, degrees.cubic + 1);
      reach(more_rows_, degrees.quartic + 1);
      for (int k = 0; k < more_rows_; ++k) more_[k] = {};
      take(more_, kCubic, 4, 0, degrees.cubic, true);
      if (degrees.order > 3) take(more_, kQuartic, 5, 0, degrees.quartic, true);
    }
    take(at_, kLimit, 1, 0, degrees.limit, false);
  }

  /// At s.
  [[nodiscard]] auto sum(double s) const { return add_up<kSloped>(at_, rows_, s); }
  [[nodiscard]] auto sum_more(double s) const { return add_up<kColumns>(more_, more_rows_, s); }

  /// That of s^(2 + k) in F, k < degrees().push - 1.
  [[nodiscard]] double push(int k) const { return at_[k].of[kPush]; }

private:
  struct Row {
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

  /// Horner's rule, and of the first columns the derivative's.
  template <int Sloped>
  static Sums<Sloped> add_up(const Row* rows, int count, double s) {
    Sums<Sloped> sums{};  // in registers until all are added
    for (int c = 0; c < kColumns; ++c) sums.value[c] = rows[count - 1].of[c];
    for (int k = count - 2; k >= 0; --k) {
      for (int c = 0; c < Sloped; ++c) sums.slope[c] = sums.slope[c] * s + sums.value[c];
      for (int c = 0; c < kColumns; ++c) sums.value[c] = sums.value[c] * s + rows[k].of[c];
    }
    return sums;
  }

  Degrees degrees_;
  int rows_ = 1, more_rows_ = 1;
  Row at_[kMaxDegree + 1] = {}, more_[kMaxDegree + 1] = {};
};

}  // namespace palpate::coupled
