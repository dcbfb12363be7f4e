// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a contact whose points let go comes to an equilibrium or peels.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

namespace palpate::solve {

/// The points of a sticking contact that let go in each round of a search for equilibrium. They become fewer towards an
/// equilibrium, as a geometric series. If there is none, they are fewest near the place where it is missing, and more
/// from there on.
class LettingGo {
public:
  /// A contact peels if its points come to less than this share: without cohesion the search would end in a few points,
  /// after all its rounds. Random contacts that hold keep at least 0.54, and no series of theirs leaves less than 0.53
  /// (palpate verify --battery random, 1730 moves of 63 contacts).
  static constexpr double kPeeled = 0.25;

  /// `stuck`: points at the start.
  explicit LettingGo(std::size_t stuck) : first_(static_cast<double>(stuck)), stuck_(first_) {}

  /// Whether the contact peels in the `left` rounds after this one, which ended with `stuck` points. The series begins
  /// at the fewest points of a round; its ratio is that of this round's to the fewest of those before, at most 1.
  bool peels(std::size_t stuck, int left) {
    const double let_go = std::exchange(stuck_, static_cast<double>(stuck)) - static_cast<double>(stuck);
    const double ratio = let_go < fewest_ ? let_go / fewest_ : 1.0;
    fewest_ = std::min(fewest_, let_go);
    double end = stuck_, next = fewest_;
    for (int round = 0; round < left; ++round) end -= next *= ratio;
    return end < kPeeled * first_;
  }

private:
  double first_, stuck_;
  double fewest_ = std::numeric_limits<double>::infinity();  // of a round; none yet
};

}  // namespace palpate::solve
