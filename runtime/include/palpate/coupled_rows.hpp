// SPDX-License-Identifier: MIT
// The coefficients of a blended coupled response, laid so that all its families are summed in one go.
#pragma once

#include "palpate/coupled_energy.hpp"
#include "palpate/coupled_layout.hpp"

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

  /// Forgets everything.
  void clear(const Degrees& degrees) {
    degrees_ = degrees;
    rows_ = more_rows_ = 1;
    const auto reach = [](int& rows, int needed) { rows = rows < needed ? needed : rows; };
    reach(rows_, degrees.push - 1);
    reach(rows_, degrees.straight - 1);
    reach(rows_, degrees.stiffness + 1);
    reach(rows_, degrees.limit + 1);
    reach(more_rows_, degrees.cubic + 1);
    reach(more_rows_, degrees.quartic + 1);
    for (int k = 0; k < rows_; ++k) at_[k] = {};
    for (int k = 0; degrees.order > 2 && k < more_rows_; ++k) more_[k] = {};
  }

  /// Adds a response's coefficients (count(degrees) of them, in the file's order), `unit` the N of one and `limit_unit`
  /// that of mu, with a weight; (cosine, sine) of the angle of its x axis in this law's frame.
  template <class Scalar>
  void add(const Scalar* coefs, double unit, double limit_unit, double weight, const Vec2& turned) {
    const Vec2 second = product(turned, turned), third = product(second, turned), fourth = product(second, second);
    const double factor = weight * unit;
    const auto scalar = [&](double& to, double by) { to += by * static_cast<double>(*coefs++); };
    const auto pair = [&](double* to, const Vec2& turn) {
      const Vec2 h = product({static_cast<double>(coefs[0]), static_cast<double>(coefs[1])}, turn);
      to[0] += factor * h.x;
      to[1] += factor * h.y;
      coefs += 2;
    };
    for (int k = 0; k < from_square(degrees_.push); ++k) scalar(at_[k].of[kPush], factor);
    for (int k = 0; k < from_square(degrees_.straight); ++k) pair(at_[k].of + kStraight, turned);
    const auto square = [&](int rows, Column column) {
      for (int k = 0; k < rows; ++k) {
        scalar(at_[k].of[column], factor);
        pair(at_[k].of + column + 1, second);
      }
    };
    square(degrees_.stiffness + 1, kStiffness);
    square(from_square(degrees_.stiffness), kCoupling);
    for (int k = 0; degrees_.order > 2 && k <= degrees_.cubic; ++k) {
      pair(more_[k].of + kCubic, turned);
      pair(more_[k].of + kCubic + 2, third);
    }
    for (int k = 0; degrees_.order > 3 && k <= degrees_.quartic; ++k) {
      scalar(more_[k].of[kQuartic], factor);
      pair(more_[k].of + kQuartic + 1, second);
      pair(more_[k].of + kQuartic + 3, fourth);
    }
    for (int k = 0; k <= degrees_.limit; ++k) scalar(at_[k].of[kLimit], weight * limit_unit);
  }

  /// What was added, count(degrees()) coefficients in the file's order and basis; not after finish().
  void copy(double* to) const {
    for_each_family(*this, [&](const Row* rows, int column, int components, int first, int degree, bool /*energy*/) {
      for (int k = first; k <= degree; ++k) {
        for (int c = 0; c < components; ++c) *to++ = rows[k - first].of[column + c];
      }
    });
  }

  /// From Bernstein's basis to powers of s, once all responses are added.
  void finish() {
    for_each_family(*this, [](Row* rows, int column, int components, int first, int degree, bool energy) {
      constexpr double kIntegral[kMaxDegree + 1] = {1, 1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5, 1.0 / 6, 1.0 / 7};
      for (int k = degree; k >= first; --k) {
        const double scale = binomial(degree, k) * (energy ? kIntegral[k] : 1);
        for (int c = column; c < column + components; ++c) {
          double sum = 0;
          for (int i = first; i <= k; ++i) sum += alternating_binomial(k, i) * rows[i - first].of[c];
          rows[k - first].of[c] = scale * sum;
        }
      }
    });
  }

  /// At s, after finish().
  [[nodiscard]] auto sum(double s) const { return add_up<kSloped>(at_, rows_, s); }
  [[nodiscard]] auto sum_more(double s) const { return add_up<kColumns>(more_, more_rows_, s); }

  /// That of s^(2 + k) in F, k < degrees().push - 1, after finish().
  [[nodiscard]] double push(int k) const { return at_[k].of[kPush]; }

private:
  struct Row {
    double of[kColumns];
  };

  /// Calls each(rows, first column, components, lowest power, degree, whether an energy is made of it) in the file's
  /// order.
  template <class Self, class Each>
  static void for_each_family(Self& self, const Each& each) {
    const Degrees& d = self.degrees_;
    each(self.at_, kPush, 1, 2, d.push, false);
    if (d.straight > 0) each(self.at_, kStraight, 2, 2, d.straight, false);
    each(self.at_, kStiffness, 3, 0, d.stiffness, true);
    each(self.at_, kCoupling, 3, 2, d.stiffness, false);
    if (d.order > 2) each(self.more_, kCubic, 4, 0, d.cubic, true);
    if (d.order > 3) each(self.more_, kQuartic, 5, 0, d.quartic, true);
    each(self.at_, kLimit, 1, 0, d.limit, false);
  }

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
