// SPDX-License-Identifier: MIT
// Friction as a row of springs in parallel, each with a slip limit and radial return.
#pragma once

#include "palpate/math/vec3.hpp"
#include "palpate/response/response_law.hpp"

#include <cmath>

namespace palpate::runtime {

/// Constants of the friction springs.
struct SpringConstants {
  /// Layers. A contact that slips in part follows Cattaneo and Mindlin within 2.6 % of its limit from 0.05 Z to 1.3 Z
  /// with 12 layers at z_k = (k / 12)^3 Z (8 at (k / 8)^2: 5.7 %).
  static constexpr int kLayers = 12;
  /// Slip after which a layer counts as slipped, over its deflection at its limit. Solved strokes on a block are met to
  /// 2.8 % (95th percentile, sliding) with 0.2, 2.9 % with 0.45 and 3.0 % with 1.
  static constexpr double kSlipTravel = 0.2;
};

/// s_k = (k / M)^1.5 = sqrt(z_k / Z): where layer k engages.
inline constexpr double kLayerAbscissa[SpringConstants::kLayers] = {
    0.0, 0.024056261216234404, 0.06804138174397717, 0.125,
    0.19245008972987523, 0.26895717681995951, 0.35355339059327379, 0.44552819256515114,
    0.54433105395181736, 0.649519052838329, 0.76072577431273081, 0.87764151544330993};
/// z_k / Z = (k / M)^3.
inline constexpr double kLayerDepth[SpringConstants::kLayers] = {
    0.0, 0.00057870370370370356, 0.0046296296296296285, 0.015625,
    0.037037037037037028, 0.072337962962962979, 0.125, 0.19849537037037041,
    0.29629629629629622, 0.421875, 0.57870370370370383, 0.77025462962962954};

/// A layer of a blended response. The tangent L to F at the depth `start` is a line, its integral a parabola of the
/// depth.
struct FrictionLayer {
  double start = 0;                       ///< z_k, m
  double force = 0, slope = 0, work = 0;  ///< N, N/m, J: of the tangent, at z = 0; 0 for the first layer
  Sym2 stiffness;                         ///< K(s_k), N/m; 0 for the first layer
  Sym2 whole;                             ///< K(s_k+1) - K(s_k), N/m: stiffness while the next layer is engaged

  /// L(z).
  [[nodiscard]] double tangent(double z) const { return force + slope * z; }
  /// Integral of F up to the start, and of L from there on.
  [[nodiscard]] double tangent_work(double z) const { return work + z * (force + 0.5 * z * slope); }
};

/// The layers of a blended response.
struct FrictionLayers {
  static constexpr int kCount = SpringConstants::kLayers;

  double depth_scale = 1;  ///< Z, m
  double softening = 0;    ///< k, share of a layer's normal force that is lost at z = Z where the layer has slipped
  FrictionLayer at[kCount];

  void set(const ResponseLaw& law, double slip_softening) {
    depth_scale = law.depth_scale();
    softening = slip_softening;
    if (!law.has_friction()) return;
    for (int k = 1; k < kCount; ++k) {
      FrictionLayer& layer = at[k];
      const NormalResponse r = law.normal_within(kLayerAbscissa[k]);
      const double z = layer.start = kLayerDepth[k] * depth_scale;
      layer.slope = r.normal_slope;
      layer.force = r.normal_force - r.normal_slope * z;
      layer.work = r.work - z * (r.normal_force - 0.5 * z * r.normal_slope);
      layer.stiffness = law.stiffness_at(kLayerAbscissa[k]);
      at[k - 1].whole = layer.stiffness - at[k - 1].stiffness;
    }
  }
  /// Number of layers engaged at a depth (m).
  [[nodiscard]] int engaged(double depth) const {
    int count = 0;
    while (count < kCount && depth > at[count].start) ++count;
    return count;
  }
};

/// The spring of one layer. All is 0 while the layer is not engaged.
struct Spring {
  Vec2 deflection;       ///< e_k, m
  double stiffness = 0;  ///< mean of K_k, N/m
  double slipped = 0;    ///< [0, 1]: how far the layer has slipped since it engaged
};

/// The springs of one contact.
struct SpringState {
  Spring layer[SpringConstants::kLayers];
  Vec2 mean;  ///< K^-1 sum of K_k e_k, m
};

/// Force of the springs after an update.
struct SpringForce {
  Vec2 force;             ///< N: sum of K_k e_k
  double energy = 0;      ///< J: sum of e_k . K_k e_k / 2
  double lost_force = 0;  ///< N: k z / Z times the slipped layers' normal force, sum of slipped_k (L_k+1 - L_k)
  double lost_work = 0;   ///< J: the same of their normal work
  double lost_bias = 0;   ///< [0, 1]: share of the tangential bias that slip has removed
  bool slides = false;    ///< every engaged layer is at its limit
};

/// Motion of the tool over a contact in one tick.
struct SpringMotion {
  double from = 0, to = 0;  ///< m, counted depth before and after
  Vec2 way;                 ///< m, across the normal
};

/// Moves the springs by one tick. `r`: the response at the depth `motion.to` > 0, of the layers `layers`.
///
///     K_k(z) = K(min(s, s_k+1)) - K(s_k)                    layer k's stiffness; the last layer is open-ended
///     limit  = mu (L_k+1(z) - L_k(z)) (1 - k z/Z slipped_k) telescopes to mu F (1 - k r z/Z); negative shares (F not
///                                                           convex) are 0, the others scaled to the same sum
///     e_k   += (share of the tick in which the layer was engaged) * way
///     where K_k grew:  e_k *= K_k(before) / K_k             new area is unstressed
///     where |K_k e_k| > limit:  e_k *= limit / |K_k e_k|    radial return (Simo and Hughes 1998, chapter 3)
///
/// A contact in partial slip is such a row of layers (Jaeger 1993, Ciavarella 1998). Slip removes part of the
/// tangential bias, which was solved sticking: with r the slipped share of F, g (1 - r (1 - slipping_bias_share(s)))
/// remains.
inline SpringForce update_springs(const FrictionLayers& layers, const ResponseAtDepth& r, const SpringMotion& motion,
                                  SpringState& springs) {
  constexpr int kCount = SpringConstants::kLayers;
  SpringForce result;
  const double mu = r.friction_coefficient, force = r.normal_force, z = motion.to;
  const int engaged = force > 0 ? layers.engaged(z) : 0, last = engaged - 1;
  for (int k = engaged; k < kCount; ++k) springs.layer[k] = {};
  springs.mean = {};
  if (engaged == 0) return result;
  const double share_of_depth = smaller(1, z / layers.depth_scale), softening = layers.softening * share_of_depth;

  double normal[kCount], sum = 0, below = 0;  // N, of the normal force
  for (int k = 0; k < engaged; ++k) {
    const double above = k < last ? layers.at[k + 1].tangent(z) : force;
    normal[k] = larger(0, above - below);
    sum += normal[k];
    below = above;
  }
  const double scale = sum > 0 ? force / sum : 0;

  result.slides = true;
  for (int k = 0; k < engaged; ++k) {
    const FrictionLayer& layer = layers.at[k];
    Spring& spring = springs.layer[k];
    const Sym2 stiffness = k < last ? layer.whole : r.stiffness - layer.stiffness;
    if (stiffness.m > spring.stiffness) spring.deflection = (spring.stiffness / stiffness.m) * spring.deflection;
    spring.stiffness = stiffness.m;
    Vec2 way = motion.way;
    if (layer.start > motion.from) way = ((z - layer.start) / (z - motion.from)) * way;
    spring.deflection = spring.deflection + way;
    Vec2 elastic = stiffness * spring.deflection;
    normal[k] *= scale;
    const double limit = mu * normal[k] * (1 - softening * spring.slipped);
    const double squared = dot(elastic, elastic), most = limit * limit;
    // Rounding neither moves what is at its limit nor lets it stick.
    constexpr double kRounding = 1e-12;
    if (squared < most * (1 - kRounding)) {
      result.slides = false;
    } else if (squared > most * (1 + kRounding)) {
      const double size = std::sqrt(squared), over = size / limit - 1;  // slip over the deflection at the limit
      spring.slipped += (1 - spring.slipped) * smaller(1, over / SpringConstants::kSlipTravel);
      spring.deflection = (mu * normal[k] * (1 - softening * spring.slipped) / size) * spring.deflection;
      elastic = stiffness * spring.deflection;  // the same bits as in the next tick at rest
    }
    result.force = result.force + elastic;
    result.energy += dot(spring.deflection, elastic);
    if (spring.slipped > 0) {
      const double work = (k < last ? layers.at[k + 1].tangent_work(z) : r.work) - layer.tangent_work(z);
      result.lost_force += spring.slipped * normal[k];
      result.lost_work += spring.slipped * larger(0, work);
    }
  }
  springs.mean = solve(r.stiffness, result.force);
  result.energy *= 0.5;
  result.lost_bias = (1 - response::slipping_bias_share(std::sqrt(share_of_depth))) * result.lost_force / force;
  result.lost_force *= softening;
  result.lost_work *= softening;
  return result;
}

}  // namespace palpate::runtime
