// SPDX-License-Identifier: MIT
// What the law of a contact says of one depth, whatever its model.
#pragma once

#include "palpate/coupled.hpp"
#include "palpate/lanes.hpp"
#include "palpate/math3.hpp"
#include "palpate/response_layout.hpp"

#include <cmath>

namespace palpate::runtime {

/// Of a contact (rim.hpp).
enum class Part : int { core = 0, rim = 1 };

/// Layers of a separable law (sideways_curves.hpp): the vertices of a tool's patch; of a tool with spins, two samples
/// of each and what is not sure.
inline constexpr int kLayersUnspun = 3, kMostLayers = 9;

/// What depends on the depth alone; valid for the field that made it.
struct DepthTerms {
  double depth = 0;         ///< m
  double root = 0;          ///< of the depth over the depth scale, at most 1
  double normal_force = 0;  ///< N along n(c)
  double limit = 0;         ///< N, what friction holds: mu(depth) Fn; infinite in a frictionless file
  Vec3 straight;            ///< N, sideways force of the straight push, across n(c)
  union {
    Lanes<6> growth[kMostLayers];  ///< N, of the separable model, as many as it has layers
    coupled::AtDepth coupled;      ///< in a file of the coupled model
  };
  bool beyond = false;  ///< deeper than this pair was sampled
};

/// N, about which friction holds its limit: the sideways force of a straight push, as far as that is how the tissue
/// lies against the tool's flanks (a lump to one side, a slope), and no friction. Such a push is solved sticking, and
/// what shears the contact then is gone once it slips. In solved pushes that slip every way beside a lump, with each
/// one's own normal force taken for its friction, the middle is 0.28, 0.43, 0.62 and 0.75 times the straight push's at
/// roots of a quarter, a half, three quarters and 1 (layout::kFlanks). The limit is that of no sideways deflection; as
/// the normal force of one that is drawn towards the lump grows by some of its sideways force, friction does, and that
/// moves the middle on. Of more than half the limit only so much: friction opposes a slide by what is left at least,
/// lest sideways forces drive it, round a bend for as long as it lasts.
inline Vec3 friction_centre(const DepthTerms& terms) {
  constexpr double kTowards = 0.25;
  const Vec3 centre = (kTowards + layout::kFlanks * terms.root) * terms.straight;
  const double square = dot(centre, centre), most = 0.5 * terms.limit;
  return square > most * most ? (most / std::sqrt(square)) * centre : centre;
}
/// What is left of a sideways force (N) where friction holds `limit` (N) about a centre.
inline Vec3 within_limit(const Vec3& pull, const Vec3& centre, double limit) {
  const Vec3 friction = pull - centre;
  const double size = length(friction);
  return size > limit ? centre + (limit / size) * friction : pull;
}

}  // namespace palpate::runtime
