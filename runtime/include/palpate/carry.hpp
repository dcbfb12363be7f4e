// SPDX-License-Identifier: MIT
// What a contact that leapt to another place goes on pushing with: no force steps, it fades as the tool moves.
#pragma once

#include "palpate/tick.hpp"

#include <cmath>

namespace palpate::runtime {

/// c goes with the tool, a few times as fast. Where it cannot (round a ridge thinner than it is pressed, from one wall
/// of a groove to the other) it leaps, and its force turns at once. What is missing then to force and torque of the
/// tick before is carried, and fades over the way on which the contact would have let go there; it is gone with the
/// depth.
class Carry {
public:
  /// Of a contact that begins.
  void reset() { *this = Carry(); }

  /// J that the hand gets if the tool goes `way` (m) before the next tick.
  [[nodiscard]] double work(const Vec3& way) const { return share_ > 0 ? share_ * dot(force_, way) : 0; }

  /// Completes what the present place answers with after the tool went `way` (m). True where c leapt.
  bool add(Tick& tick, const Vec3& way) {
    const Vec3 gone = tick.body_point - last_.body_point;
    const bool far = last_.depth > 0 && dot(gone, gone) > kFar * kFar * dot(way, way);
    if (share_ > 0) share_ = std::fmax(0, std::fmin(share_ - rate_ * length(way), per_depth_ * tick.depth));
    const bool leapt = far && leap(tick, length(way));
    answer_ = tick.force;
    if (share_ > 0) {
      tick.force = tick.force + share_ * force_;
      tick.torque = tick.torque + share_ * torque_;
    }
    last_ = {tick.force, tick.torque, tick.body_point, tick.depth};
    return leapt;
  }

  /// Forces of the tick before count as turned by `by`.
  void rebase(const Pose& by) {
    Vec3* const turned[] = {&force_, &torque_, &answer_, &last_.force, &last_.torque};
    for (Vec3* v : turned) *v = by.rotate(*v);
  }

private:
  /// c went far: carries what is missing if the force turned by more than such a place answers with.
  [[gnu::noinline]] bool leap(const Tick& tick, double moved) {
    const double stiffness = std::fmax(length(tick.force) / tick.depth, length(answer_) / last_.depth);
    if (!(length(tick.force - answer_) > kSteep * stiffness * moved)) return false;
    const Vec3 missing = last_.force - tick.force;
    // Of a place that is hardly touched no more than lets go as steeply.
    const double all = length(missing), most = std::fmin(1, kMost * stiffness * tick.depth / all);
    force_ = most * missing;
    torque_ = most * (last_.torque - tick.torque);
    share_ = 1;
    rate_ = stiffness / (most * all);
    per_depth_ = 1 / tick.depth;
    return true;
  }

  // c leapt where it went so many times as far as the tool and the force changed so many times as much as over its way.
  static constexpr double kFar = 3, kSteep = 4;
  static constexpr double kMost = 3;  ///< carried at most, of what the stiffness makes of the new depth

  struct Last {
    Vec3 force, torque, body_point;
    double depth = 0;
  };
  Last last_;             ///< with what was carried
  Vec3 answer_;           ///< N, without
  Vec3 force_, torque_;   ///< N, N m, carried, if all of it is
  double share_ = 0;      ///< of it
  double rate_ = 0;       ///< 1/m
  double per_depth_ = 0;  ///< 1/m
};

}  // namespace palpate::runtime
