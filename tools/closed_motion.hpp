// SPDX-License-Identifier: GPL-3.0-or-later
// A contact of the coupled model that sticks, with the hand's work.
#pragma once

#include <cmath>

#include "palpate/coupled.hpp"

namespace palpate::cli {

/// One contact as the runtime keeps it, with the hand's work by Gauss' rule (exact for the model's polynomials).
class ClosedMotion {
public:
  /// The anchor rule's own steps err by the third power of `piece`, the longest (of t) that is asked of it.
  ClosedMotion(const coupled::Law& law, double depth_scale, double sideways_scale, double piece)
      : law_(law), ratio_(depth_scale / sideways_scale), piece_(piece) {}

  void sideways(const coupled::Vec2& by);
  void depth(double to);
  [[nodiscard]] double at() const { return t_; }
  [[nodiscard]] double work() const { return work_; }    ///< J over the sideways scale, of the hand so far
  [[nodiscard]] double gross() const { return gross_; }  ///< the same of its parts without their signs

private:
  void add(double work) {
    work_ += work;
    gross_ += work < 0 ? -work : work;
  }

  static constexpr double kAt[3] = {0.1127016653792583, 0.5, 0.8872983346207417};
  static constexpr double kWeight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};

  const coupled::Law& law_;
  double ratio_, piece_, t_ = 0, work_ = 0, gross_ = 0;
  coupled::Vec2 u_{0, 0};
};

inline void ClosedMotion::sideways(const coupled::Vec2& by) {
  if (t_ > 0) {
    const coupled::AtDepth d = law_.at(t_, true);
    constexpr int kPieces = 8;  // for what lies beyond |u| = 1
    for (int piece = 0; piece < kPieces; ++piece) {
      for (int k = 0; k < 3; ++k) {
        add(kWeight[k] / kPieces * dot(law_.push(d, u_ + ((piece + kAt[k]) / kPieces) * by), by));
      }
    }
  }
  u_ = t_ > 0 ? u_ + by : coupled::Vec2{0, 0};
}

inline void ClosedMotion::depth(double to) {
  const double pieces = std::ceil(std::abs(to - t_) / piece_), from = t_;
  for (double piece = 0; piece < pieces; ++piece) {
    const double a = from + (to - from) * piece / pieces, b = from + (to - from) * (piece + 1) / pieces;
    for (int k = 0; k < 3; ++k) {
      const double at = a + kAt[k] * (b - a);
      const coupled::Vec2 there = to > from ? law_.deepen(a, at, u_) : u_;
      const coupled::AtDepth d = law_.at(at, true);
      add(kWeight[k] * (b - a) * 2 * d.s * ratio_ * (d.push + law_.coupling(d, there)));
    }
    if (to > from) u_ = law_.deepen(a, b, u_);
    t_ = b;
  }
}

}  // namespace palpate::cli
