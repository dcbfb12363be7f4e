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

/// The layers of a blended response: stiffness, and force and work as polynomials of the depth.
class FrictionLayers {
public:
  static constexpr int kCount = SpringConstants::kLayers;

  /// `softening`: k, share of a layer's normal force that is lost at z = Z where the layer has slipped.
  void set(const ResponseLaw& law, double softening) {
    depth_scale_ = law.depth_scale();
    softening_ = softening;
    if (!law.has_friction()) return;
    ResponseAtDepth r;
    for (int k = 1; k < kCount; ++k) {
      law.set_normal_within(kLayerAbscissa[k], r);
      slope_[k] = r.normal_slope;
      force_[k] = r.normal_force - r.normal_slope * start(k);
      work_[k] = r.work - start(k) * (r.normal_force - 0.5 * start(k) * r.normal_slope);
      stiffness_[k] = law.stiffness_at(kLayerAbscissa[k]);
      whole_[k - 1] = stiffness_[k] - stiffness_[k - 1];
    }
  }

  /// m, Z.
  [[nodiscard]] double depth_scale() const { return depth_scale_; }
  /// k, share of a layer's normal force that is lost at z = Z where the layer has slipped.
  [[nodiscard]] double softening() const { return softening_; }
  /// Number of layers engaged at a depth (m).
  [[nodiscard]] int engaged(double depth) const {
    const double share = depth / depth_scale_;
    int count = 0;
    while (count < kCount && share > kLayerDepth[count]) ++count;
    return count;
  }
  /// m, z_k.
  [[nodiscard]] double start(int k) const { return kLayerDepth[k] * depth_scale_; }
  /// K(s_k) (N/m); 0 for k = 0.
  [[nodiscard]] const Sym2& stiffness(int k) const { return stiffness_[k]; }
  /// K(s_k+1) - K(s_k) (N/m): stiffness of a layer below which another one is engaged.
  [[nodiscard]] const Sym2& whole(int k) const { return whole_[k]; }
  /// L_k(z): the tangent to F at z_k; 0 for k = 0.
  [[nodiscard]] double tangent(int k, double z) const { return force_[k] + slope_[k] * z; }
  /// Its integral from no depth, along F up to z_k; 0 for k = 0.
  [[nodiscard]] double tangent_work(int k, double z) const { return work_[k] + z * (force_[k] + 0.5 * z * slope_[k]); }

private:
  double depth_scale_ = 1;  ///< Z, m
  double softening_ = 0;
  double force_[kCount] = {}, slope_[kCount] = {}, work_[kCount] = {};  ///< N, N/m, J: of the tangents, at z = 0
  Sym2 stiffness_[kCount] = {}, whole_[kCount] = {};                    ///< N/m
};

/// The springs of one contact.
struct SpringState {
  Vec2 deflection[SpringConstants::kLayers] = {};    ///< e_k, m
  double stiffness[SpringConstants::kLayers] = {};   ///< mean of K_k, N/m; 0 where the layer is not engaged
  double slipped[SpringConstants::kLayers] = {};     ///< [0, 1]: how far the layer has slipped since it engaged
  Vec2 mean;                                         ///< K^-1 sum of K_k e_k, m
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

/// Moves the springs `before` by one tick to `after`, which may be the same. `r`: the response at the depth
/// `motion.to` > 0, of the layers `layers`.
///
///     K_k(z) = K(min(s, s_k+1)) - K(s_k)                    layer k's stiffness; the last layer is open-ended
///     limit  = mu (L_k+1(z) - L_k(z)) (1 - k z/Z slipped_k) telescopes to mu F (1 - k r z/Z); negative shares (F not
///                                                           convex) are 0, the others scaled to the same sum
///     e_k   += (share of the tick in which the layer was engaged) * way
///     where K_k grew:  e_k *= K_k(before) / K_k             new area is unstressed
///     where |K_k e_k| > limit:  e_k *= limit / |K_k e_k|    radial return (Simo and Hughes 1998, chapter 3)
///
/// A contact in partial slip is such a row of layers (Jaeger 1993, Ciavarella 1998). Slip removes part of the tangential
/// bias, which was solved sticking: with r the slipped share of F, g (1 - r (1 - slipping_bias_share(s))) remains.
inline SpringForce update_springs(const FrictionLayers& layers, const ResponseAtDepth& r, const SpringMotion& motion,
                                  const SpringState& before, SpringState& after) {
  constexpr int kCount = SpringConstants::kLayers;
  SpringForce result;
  const double mu = r.friction_coefficient, force = r.normal_force;
  const int engaged = force > 0 ? layers.engaged(motion.to) : 0;
  for (int k = engaged; k < kCount; ++k) {
    after.deflection[k] = {};
    after.stiffness[k] = after.slipped[k] = 0;
  }
  after.mean = {};
  if (engaged == 0) return result;
  const double share_of_depth = smaller(1, motion.to / layers.depth_scale());
  const double softening = layers.softening() * share_of_depth;

  double normal[kCount], sum = 0, below = 0;  // N, of the normal force
  for (int k = 0; k < engaged; ++k) {
    const double above = k + 1 < engaged ? layers.tangent(k + 1, motion.to) : force;
    normal[k] = larger(0, above - below);
    sum += normal[k];
    below = above;
  }
  const double scale = sum > 0 ? force / sum : 0;

  result.slides = true;
  for (int k = 0; k < engaged; ++k) {
    const bool last = k + 1 == engaged;
    const Sym2 stiffness = last ? r.stiffness - layers.stiffness(k) : layers.whole(k);
    Vec2 e = before.deflection[k];
    if (stiffness.m > before.stiffness[k]) e = (before.stiffness[k] / stiffness.m) * e;
    const double start = layers.start(k);
    e = e + (motion.from >= start ? 1 : (motion.to - start) / (motion.to - motion.from)) * motion.way;
    Vec2 elastic = stiffness * e;
    double slipped = before.slipped[k];
    normal[k] *= scale;
    double limit = mu * normal[k] * (1 - softening * slipped);
    const double squared = dot(elastic, elastic), most = limit * limit;
    // Rounding neither moves what is at its limit nor lets it stick.
    constexpr double kRounding = 1e-12;
    if (squared > most * (1 + kRounding)) {
      const double size = std::sqrt(squared), over = size / limit - 1;  // slip over the deflection at the limit
      slipped += (1 - slipped) * smaller(1, over / SpringConstants::kSlipTravel);
      limit = mu * normal[k] * (1 - softening * slipped);
      e = (limit / size) * e;
      elastic = stiffness * e;  // the same bits as in the next tick at rest
    } else if (squared < most * (1 - kRounding)) {
      result.slides = false;
    }
    after.deflection[k] = e;
    after.stiffness[k] = stiffness.m;
    after.slipped[k] = slipped;
    result.force = result.force + elastic;
    result.energy += dot(e, elastic);
    if (slipped > 0) {
      const double work = (last ? r.work : layers.tangent_work(k + 1, motion.to)) - layers.tangent_work(k, motion.to);
      result.lost_force += slipped * normal[k];
      result.lost_work += slipped * larger(0, work);
    }
  }
  after.mean = solve(r.stiffness, result.force);
  result.energy *= 0.5;
  result.lost_bias = (1 - response::slipping_bias_share(std::sqrt(share_of_depth))) * result.lost_force / force;
  result.lost_force *= softening;
  result.lost_work *= softening;
  return result;
}

}  // namespace palpate::runtime
