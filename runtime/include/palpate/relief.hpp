// SPDX-License-Identifier: MIT
// How much less a contact pushes once it slips.
#pragma once

#include "palpate/view.hpp"

#include <cmath>

namespace palpate::runtime {

/// Of the sideways deflection that friction holds: by so much a contact slips to be relieved of all but 1 / e. In
/// solved pushes of thick bodies two fifths are gone when no more than the rim has slipped.
inline constexpr double kReliefReach = 0.45;

/// The square of a depth (m), from the depth `scale` (m) on straight on.
inline double bent_square(double scale, double depth) {
  const double bent = depth < scale ? depth : scale;
  return bent * (2 * depth - bent);
}
/// m, that counts of a depth (m) where `give` (1/m) of that square is lost; the depth of which that counts; the slope.
inline double counted_depth(double give, double scale, double depth) {
  return depth > 0 ? depth - give * bent_square(scale, depth) : depth;
}
inline double uncounted_depth(double give, double scale, double counted) {
  if (!(counted > 0)) return counted;
  const double beyond = counted - counted_depth(give, scale, scale);
  if (beyond > 0) return scale + beyond / (1 - 2 * give * scale);
  return 2 * counted / (1 + std::sqrt(std::fmax(0, 1 - 4 * give * counted)));
}
inline double counted_slope(double give, double scale, double depth) {
  return 1 - 2 * give * (depth < scale ? std::fmax(0, depth) : scale);
}

/// A straight push is solved sticking, and tissue between surfaces that hold it is stiffer than where one of them
/// slips: by a percent or two of the force on a thick body, several times that on a thin layer. So a contact that slips
/// gives up some of its depth: of z it counts z - r k z^2 / Z (beyond the depth scale Z what goes on straight from
/// there), with k of its responses and r from 0 at the first touch to 1 where all of it has slipped. The depth that
/// counts is what the field is asked for; the normal force is the field's times the slope of the one by the other: at
/// any r it is the gradient of what is stored. r rises, which only loses, as the tool moves on, so that a hand at rest
/// feels nothing of it. It falls as the contact goes deeper, for what is new of it sticks: the depth that was lost
/// stays what it was, and what the hand did not give of that is owed (EnergyAccount). Without layout::feature_relief
/// all depth counts: no code, no memory.
template <std::uint32_t kFeatures>
class BasicRelief {
  static constexpr bool kRelief = (kFeatures & layout::feature_relief) != 0;

public:
  explicit BasicRelief(const View& view) {
    if constexpr (kRelief) {
      if (view.meta->relief_count > 0) state_.scale = view.meta->depth_scale;
    }
  }

  /// The file's responses have one.
  [[nodiscard]] bool present() const {
    if constexpr (kRelief) return state_.scale > 0;
    return false;
  }

  void begin() {
    if constexpr (kRelief) state_.reached = state_.coming = 0;
  }

  /// The contact slipped by a `way` (m, the mean over all of it) where friction holds a deflection of `held` (m).
  void slip([[maybe_unused]] double way, [[maybe_unused]] double held) {
    if constexpr (kRelief) {
      if (way > 0) state_.coming += way / std::fmax(kReliefReach * held, kLeast * state_.scale);
    }
  }
  /// The tool moves by a `way` (m) from one depth (m, as it is) to another, where the responses' relief is k: what
  /// slipped before is relieved, no faster than at half a lift's rate, and what is new of a deeper contact sticks.
  /// Returns the depth (m) that counts more for that.
  double move([[maybe_unused]] double k, [[maybe_unused]] double way, [[maybe_unused]] double from,
              [[maybe_unused]] double to) {
    if constexpr (kRelief) {
      const double wanted = (1 - state_.reached) * state_.coming / (1 + state_.coming);
      const double lost = wanted * k * bent_square(state_.scale, std::fmax(from, 0)) / state_.scale;
      const double share = lost > 0.5 * way ? 0.5 * way / lost : 1;
      state_.reached += share * wanted;
      const double left = share < 1 ? (1 - share) * wanted / (1 - state_.reached) : 0;
      state_.coming = left / (1 - left);
      if (to > from && to > 0 && state_.reached > 0) {
        const double before = counted(k, to);
        state_.reached *= from > 0 ? bent_square(state_.scale, from) / bent_square(state_.scale, to) : 0;
        return counted(k, to) - before;
      }
    }
    return 0;
  }

  /// m, of a depth (m) as it is, where the responses' relief is k.
  [[nodiscard]] double counted([[maybe_unused]] double k, double depth) const {
    if constexpr (kRelief) return counted_depth(give(k), state_.scale, depth);
    return depth;
  }
  /// m, of which that counts.
  [[nodiscard]] double uncounted([[maybe_unused]] double k, double depth) const {
    if constexpr (kRelief) return uncounted_depth(give(k), state_.scale, depth);
    return depth;
  }
  /// The slope of what counts.
  [[nodiscard]] double slope([[maybe_unused]] double k, [[maybe_unused]] double depth) const {
    if constexpr (kRelief) return counted_slope(give(k), state_.scale, depth);
    return 1;
  }

private:
  static constexpr double kLeast = 1e-4;  // of the depth scale, where next to nothing is held

  struct State {
    double scale = 0;                ///< m; 0 where there is none
    double reached = 0, coming = 0;  ///< r; what is to come to it, once the tool moves
  };
  [[nodiscard]] double give(double k) const { return state_.reached * k / state_.scale; }
  detail::If<kRelief, State> state_;
};

}  // namespace palpate::runtime
