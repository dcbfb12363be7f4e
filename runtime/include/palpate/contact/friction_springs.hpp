// SPDX-License-Identifier: MIT
// Friction as a row of springs in parallel, each with a slip limit and radial return.
#pragma once

#include "palpate/response/response_law.hpp"

#include <cmath>

namespace palpate::runtime {

/// Constants of the friction springs.
struct SpringConstants {
  /// Layers. A contact that slips in part follows Cattaneo and Mindlin within 2.6 % of its limit from 0.05 Z to 1.3 Z
  /// with 12 layers at z_k = (k / 12)^3 Z (8 at (k / 8)^2: 5.7 %).
  static constexpr int kLayers = 12;
  /// Share of the tangential bias at full depth that acts on the tool's flanks rather than through friction, less at
  /// the surface: 1/4 + 3/4 s, measured in the gross-slip forces of 67 solved contacts (0.28, 0.43, 0.62, 0.75).
  static constexpr double kFlankShare = 0.75;
  /// Of the friction limit: most that the flanks' share may shift its centre by, so that friction opposes each slip.
  static constexpr double kMostShift = 0.5;
};

/// s_k = (k / M)^1.5: where layer k engages, as sqrt(z_k / Z).
constexpr double layer_abscissa(int k) {
  constexpr double kTable[SpringConstants::kLayers] = {
      0.0, 0.024056261216234404, 0.06804138174397717, 0.125,
      0.19245008972987523, 0.26895717681995951, 0.35355339059327379, 0.44552819256515114,
      0.54433105395181736, 0.649519052838329, 0.76072577431273081, 0.87764151544330993};
  return kTable[k];
}

/// What a blended response says at the depths where layers engage.
class FrictionLayers {
public:
  static constexpr int kCount = SpringConstants::kLayers;

  void set(const ResponseLaw& law) {
    depth_scale_ = law.depth_scale();
    ResponseAtDepth r;
    for (int k = 1; k < kCount; ++k) {
      const double s = layer_abscissa(k);
      law.set_normal(s * s * depth_scale_, r);
      force_[k] = r.normal_force;
      slope_[k] = r.normal_slope;
      work_[k] = r.work;
      stiffness_[k] = law.has_friction() ? law.stiffness_at(s) : Sym2{};
    }
  }

  /// Number of layers engaged at a depth (m).
  [[nodiscard]] int engaged(double depth) const {
    int count = 0;
    while (count < kCount && depth > start(count)) ++count;
    return count;
  }
  /// m, z_k.
  [[nodiscard]] double start(int k) const { return layer_abscissa(k) * layer_abscissa(k) * depth_scale_; }
  /// K(s_k) (N/m); 0 for k = 0.
  [[nodiscard]] const Sym2& stiffness(int k) const { return stiffness_[k]; }
  /// L_k(z): the tangent to F at z_k; 0 for k = 0.
  [[nodiscard]] double tangent(int k, double z) const { return force_[k] + slope_[k] * (z - start(k)); }
  /// Its integral from no depth, along F up to z_k; 0 for k = 0.
  [[nodiscard]] double tangent_work(int k, double z) const {
    const double further = z - start(k);
    return work_[k] + further * (force_[k] + 0.5 * further * slope_[k]);
  }

private:
  double depth_scale_ = 1;                                           ///< Z, m
  double force_[kCount] = {}, slope_[kCount] = {}, work_[kCount] = {};  ///< N, N/m, J
  Sym2 stiffness_[kCount] = {};                                      ///< N/m
};

/// The springs of one contact.
struct SpringState {
  Vec2 deflection[SpringConstants::kLayers] = {};    ///< e_k, m
  double stiffness[SpringConstants::kLayers] = {};   ///< mean of K_k, N/m; 0 where the layer is not engaged
  double slipped[SpringConstants::kLayers] = {};     ///< [0, 1]: how far the layer has slipped since it engaged
};

/// What the springs answer after an update.
struct SpringForce {
  Vec2 force;             ///< N: sum of K_k e_k
  double energy = 0;      ///< J: sum of e_k . K_k e_k / 2
  double lost_force = 0;  ///< N: normal force of the slipped layers, sum of slipped_k (L_k+1 - L_k)
  double lost_work = 0;   ///< J: the same of their normal work
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
///     limit  = mu (L_k+1(z) - L_k(z))                       telescopes to mu F; negative shares (F not convex) are 0,
///                                                           the others scaled to the same sum
///     e_k   += (share of the tick in which the layer was engaged) * way
///     where K_k grew:  e_k *= K_k(before) / K_k             new area is unstressed
///     t = K_k e_k + w_k g_f,  |t| > limit:  t *= limit / |t|  radial return (Simo and Hughes 1998, chapter 3)
///
/// with w_k the layer's share of F and g_f the part of the tangential bias that friction bears. Jaeger 1993 and
/// Ciavarella 1998 show that a contact in partial slip is such a row of layers.
inline SpringForce update_springs(const FrictionLayers& layers, const ResponseAtDepth& r, const SpringMotion& motion,
                                  SpringState& state) {
  constexpr int kCount = SpringConstants::kLayers;
  SpringForce result;
  const int engaged = layers.engaged(motion.to);
  for (int k = engaged; k < kCount && state.stiffness[k] > 0; ++k) {
    state.deflection[k] = {};
    state.stiffness[k] = state.slipped[k] = 0;
  }
  const double mu = r.friction_coefficient, force = r.normal_force;
  if (!(force > 0)) return result;

  double share[kCount], sum = 0;  // N, of the normal force
  for (int k = 0; k < engaged; ++k) {
    const double above = k + 1 < engaged ? layers.tangent(k + 1, motion.to) : force;
    share[k] = std::fmax(0, above - layers.tangent(k, motion.to));
    sum += share[k];
  }
  const double scale = sum > 0 ? force / sum : 0;

  // The flanks' share of the bias shifts the centre of the limit; friction bears the rest.
  const double s = std::fmin(1, std::sqrt(motion.to / layers.start(1)) * layer_abscissa(1));
  const double flanks = 1 - SpringConstants::kFlankShare * (1 - s);
  const double shift = flanks * length(r.bias), most = SpringConstants::kMostShift * mu * force;
  const Vec2 borne = (1 / force) * (r.bias - (shift > most ? most / shift : 1) * (flanks * r.bias));

  result.slides = engaged > 0;
  for (int k = 0; k < engaged; ++k) {
    const bool last = k + 1 == engaged;
    const Sym2 stiffness = (last ? r.stiffness : layers.stiffness(k + 1)) - layers.stiffness(k);
    const double normal = scale * share[k], limit = mu * normal, start = layers.start(k);
    Vec2 e = state.deflection[k];
    if (stiffness.m > state.stiffness[k]) e = (state.stiffness[k] / stiffness.m) * e;
    e = e + (motion.from >= start ? 1 : (motion.to - start) / (motion.to - motion.from)) * motion.way;
    Vec2 elastic = stiffness * e;
    const Vec2 bias = normal * borne, load = elastic + bias;
    const double size = length(load);
    if (size > limit) {
      elastic = (limit / size) * load - bias;
      const Vec2 held = solve(stiffness, elastic);
      const double slip = length(e - held), reach = length(held);
      state.slipped[k] += (1 - state.slipped[k]) * (slip < reach ? slip / reach : 1);
      e = held;
    } else {
      result.slides = false;
    }
    state.deflection[k] = e;
    state.stiffness[k] = stiffness.m;
    result.force = result.force + elastic;
    result.energy += 0.5 * dot(e, elastic);
    if (state.slipped[k] > 0) {
      const double work = (last ? r.work : layers.tangent_work(k + 1, motion.to)) - layers.tangent_work(k, motion.to);
      result.lost_force += state.slipped[k] * normal;
      result.lost_work += state.slipped[k] * std::fmax(0, work);
    }
  }
  return result;
}

}  // namespace palpate::runtime
