// SPDX-License-Identifier: MIT
// The way of a tool between two ticks: where it was, and which stretch of it no search has seen.
#pragma once

#include "palpate/math3.hpp"

#include <cmath>

namespace palpate::runtime {

/// Where a tool is at a share of its way that goes straight and turns evenly (nearly, where it turns far).
inline Pose between(const Pose& from, const Pose& to, double share) {
  const Pose turn = to * inverse(from);
  const double* r = turn.rotation;
  const double twice = std::sqrt(std::fmax(0, 1 + r[0] + r[4] + r[8]));  // the cosine of half the angle
  Pose pose = to;
  if (twice > 1e-3) {  // else there are two ways to turn
    const Vec3 v = (share / twice) * small_turn(turn);
    pose = Pose::from_quaternion(1 - share + 0.5 * share * twice, v.x, v.y, v.z, {}) * from;
  }
  pose.translation = (1 - share) * from.translation + share * to.translation;
  return pose;
}

/// A stretch of a way on which nothing is known, in shares of it; none where both ends are one.
struct Stretch {
  double free = 0;           ///< the last place before it where the tool was seen to be free
  double low = 0, high = 0;  ///< its ends
  int after = 0;             ///< places that were seen before it
};

/// Of which stretches of a way no search knows, with up to so many searches on it.
template <int kLooks>
class Unseen {
public:
  /// In shares of the way: as far from its first and from its last end nothing is to be looked for.
  Unseen(double first, double last) : seen_{{0, first}, {1, last}} {}

  [[nodiscard]] Stretch longest() const {
    constexpr double kLeast = 1e-9;
    Stretch longest;
    for (int k = 1; k < count_; ++k) {
      const Stretch s{seen_[k - 1].at, seen_[k - 1].at + seen_[k - 1].about, seen_[k].at - seen_[k].about, k};
      if (s.high - s.low > longest.high - longest.low + kLeast) longest = s;
    }
    return longest;
  }
  /// At a place in a stretch the tool is free, and so it is as far about it.
  void add(const Stretch& stretch, double at, double about) {
    for (int k = count_++; k > stretch.after; --k) seen_[k] = seen_[k - 1];
    seen_[stretch.after] = {at, about};
  }

private:
  struct Seen {
    double at, about;
  };
  Seen seen_[kLooks + 2];  ///< from end to end
  int count_ = 2;
};

}  // namespace palpate::runtime
