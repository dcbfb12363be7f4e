// SPDX-License-Identifier: MIT
// What the law of a contact says of one depth, whatever its model.
#pragma once

#include "palpate/coupled.hpp"
#include "palpate/lanes.hpp"
#include "palpate/math3.hpp"

namespace palpate::runtime {

/// Of a contact (rim.hpp).
enum class Part : int { core = 0, rim = 1 };

/// Layers of a separable law (sideways_curves.hpp): the vertices of a tool's patch; of a tool with spins, two samples
/// of each and what is not sure.
inline constexpr int kLayersUnspun = 3, kMostLayers = 9;

/// What depends on the depth alone; valid for the field that made it.
struct DepthTerms {
  double depth = 0;         ///< m
  double normal_force = 0;  ///< N along n(c)
  double limit = 0;         ///< N, largest tangential force: mu(depth) Fn; infinite in a frictionless file
  Vec3 straight;            ///< N, sideways force of the straight push, across n(c)
  union {
    Lanes<6> growth[kMostLayers];  ///< N, of the separable model, as many as it has layers
    coupled::AtDepth coupled;      ///< in a file of the coupled model
  };
  bool beyond = false;  ///< deeper than this pair was sampled
};

}  // namespace palpate::runtime
