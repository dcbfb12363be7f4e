// SPDX-License-Identifier: MIT
// The part of a contact that was never let go, while a hand trembles.
#pragma once

#include "palpate/field.hpp"

#include <cmath>

namespace palpate::runtime {

/// New area of a contact that goes deeper is anchored unstressed, and area that a lift lets go takes along what it bore
/// (Mindlin and Deresiewicz 1953). So what a lift and a push of a trembling hand let go and take up again bears nothing
/// the second time, and the force stays what the rest bears. A single sideways deflection cannot say so: it shrinks
/// with every push and would be kept by every lift. This knows, of a contact that was lifted and went deeper again, the
/// part below where it turned: which share of the sideways stiffness is its, and by how much it is deflected more. The
/// deflection of the rest follows, and with it what a lift leaves. Sideways motion moves both alike.
/// What a lift gives back this way is at most what was lost since the turn, so nothing is won in any cycle.
class InnerPart {
public:
  void forget() { known_ = false; }
  [[nodiscard]] bool known() const { return known_; }

  /// A lift ends here. A part that bears most of the force already goes on as it is.
  void turn() {
    constexpr double kMost = 0.9;
    if (known_ && share_ >= kMost) return;
    known_ = true;
    share_ = 1;
    lead_ = {};
    lost_ = 0;
  }

  /// The contact went deeper from `depth` (m, above 0) to that of the terms, and keeps so much of its sideways
  /// deflection (m). `lean` as in BasicField::couple().
  template <class Field>
  [[gnu::noinline]] void deepened(const Field& field, double depth, const Vec3& deflection, const DepthTerms& terms,
                                  const Vec3& kept, double lean) {
    share_ *= field.share_between(depth, terms);
    lead_ = lead_ + deflection - kept;
    lost_ += field.released(depth, deflection, terms, kept, lean);
  }

  /// It was lifted: returns the deflection that it has then.
  template <class Field>
  [[nodiscard]] Vec3 lifted(const Field& field, double depth, const DepthTerms& terms, const Vec3& deflection,
                            double lean) {
    if (!known()) return deflection;
    const double share = std::fmin(1, share_ / field.share_between(depth, terms));
    const double left = share_ < 1 ? (1 - share) / (1 - share_) : 0;
    Vec3 back = (1 - left) * lead_;
    const double lost = lost_ + field.released(depth, deflection, terms, deflection + back, lean);
    if (lost < 0) {
      const double rise = -field.released(terms.depth, deflection, terms, deflection + back, lean);
      back = (rise > 0 ? std::fmax(0, 1 + lost / rise) : 0) * back;
    }
    lost_ = std::fmax(0, lost);
    lead_ = left * lead_;
    share_ = share;
    known_ = share < 1;
    return deflection + back;
  }

private:
  bool known_ = false;
  double share_ = 0;  ///< of the sideways stiffness
  Vec3 lead_;         ///< m, by which it is deflected more than the whole
  double lost_ = 0;   ///< J since the turn, of a coupled file
};

}  // namespace palpate::runtime
