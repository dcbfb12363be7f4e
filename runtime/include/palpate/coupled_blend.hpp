// SPDX-License-Identifier: MIT
// Coefficients of coupled responses, weighted, turned into one frame and added up.
#pragma once

#include "palpate/coupled_energy.hpp"
#include "palpate/coupled_layout.hpp"

namespace palpate::coupled {

/// A sum of responses in the file's order and basis: they are closed under turning and blending. Fixed size; holds
/// nothing before clear().
class Blend {
public:
  /// Forgets everything.
  void clear(const Degrees& degrees) {
    degrees_ = degrees;
    places_ = coupled::places(degrees);
    for (int k = 0; k < places_.end; ++k) sum_[k] = 0;
  }

  /// Adds coefficients in the frame of the sum, as below.
  template <class Scalar, class LimitScalar>
  void add(const Scalar* coefs, const LimitScalar* limits, double unit, double limit_unit, double weight) {
    const double factor = weight * unit, limit_factor = weight * limit_unit;
    for (int k = 0; k < places_.limit; ++k) sum_[k] += factor * static_cast<double>(coefs[k]);
    for (int k = places_.limit; k < places_.end; ++k) sum_[k] += limit_factor * static_cast<double>(*limits++);
  }
  /// Adds a response's coefficients (count(degrees) of them), `unit` the N of one and `limit_unit` that of mu, with a
  /// weight; (cosine, sine) of the angle of its x axis in the frame of the sum.
  template <class Scalar>
  void add(const Scalar* coefs, double unit, double limit_unit, double weight, const Vec2& turned = {1, 0}) {
    add(coefs, coefs + places_.limit, unit, limit_unit, weight, turned);
  }
  /// The same where those of the friction limit lie elsewhere.
  template <class Scalar, class LimitScalar>
  void add(const Scalar* coefs, const LimitScalar* limits, double unit, double limit_unit, double weight,
           const Vec2& turned) {
    const Vec2 second = product(turned, turned), third = product(second, turned), fourth = product(second, second);
    const double factor = weight * unit, limit_factor = weight * limit_unit;
    int at = 0;
    const auto scalar = [&](double by) {
      sum_[at] += by * static_cast<double>(coefs[at]);
      ++at;
    };
    const auto pair = [&](const Vec2& by) {
      const Vec2 h = product({static_cast<double>(coefs[at]), static_cast<double>(coefs[at + 1])}, by);
      sum_[at] += h.x;
      sum_[at + 1] += h.y;
      at += 2;
    };
    const Vec2 by_first = factor * turned, by_second = factor * second;
    while (at < places_.straight) scalar(factor);
    while (at < places_.stiffness) pair(by_first);
    while (at < places_.cubic) {
      scalar(factor);
      pair(by_second);
    }
    if (degrees_.order > 2) {
      const Vec2 by_third = factor * third, by_fourth = factor * fourth;
      while (at < places_.quartic) {
        pair(by_first);
        pair(by_third);
      }
      while (at < places_.limit) {
        scalar(factor);
        pair(by_second);
        pair(by_fourth);
      }
    }
    for (; at < places_.end; ++at) sum_[at] += limit_factor * static_cast<double>(*limits++);
  }

  [[nodiscard]] const Degrees& degrees() const { return degrees_; }
  [[nodiscard]] const Places& places() const { return places_; }
  /// What was added, count(degrees()) coefficients.
  [[nodiscard]] const double* coefs() const { return sum_; }

private:
  Degrees degrees_{};
  Places places_{};
  double sum_[kMostCoefs];
};

}  // namespace palpate::coupled
