// SPDX-License-Identifier: MIT
// Checks responses: coefficients, softening, bonded contacts and their torques.
#pragma once

#include "palpate/format/bonded_rules.hpp"
#include "palpate/format/response_rules.hpp"
#include "palpate/format/validate_common.hpp"

namespace palpate::runtime::detail {

inline constexpr float kLargest = 1e12f;  ///< N, N m, N/m: products of two values and of extrapolations stay finite

/// True when all values lie in [low, high], the first `zeros` are exactly 0, and none is below the one before it where
/// `rising`.
inline bool is_curve(const float* c, std::uint32_t count, std::uint32_t zeros, float low, float high, bool rising) {
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!(c[i] >= low && c[i] <= high)) return false;
    if (i < zeros && c[i] != 0) return false;
    if (rising && i > 0 && c[i] < c[i - 1]) return false;
  }
  return true;
}

/// True when all bits that hold no coefficient are zero.
inline bool is_padded(const View& v, std::uint32_t i, const response::Offsets& o) {
  const unsigned char* law = v.packed_coefficients(i);
  const std::uint32_t bits = v.meta->coef_bits, friction = layout::friction_offset(o, bits);
  const std::uint32_t used = static_cast<std::uint32_t>(o.friction) * bits;
  if (used % 8 != 0 && law[4 + used / 8] >> used % 8 != 0) return false;
  for (std::uint32_t k = 4 + (used + 7) / 8; k < friction; ++k) {
    if (law[k] != 0) return false;
  }
  for (std::uint32_t k = friction + 2 * static_cast<std::uint32_t>(o.end - o.friction);
       k < layout::coefficients_size(*v.meta); ++k) {
    if (law[k] != 0) return false;
  }
  return true;
}

inline bool check_coefficients(const View& v, std::uint32_t i, Fault& fault) {
  const response::Degrees degrees = response::degrees(*v.meta);
  const float unit = v.coefficient_unit(i);
  std::int16_t coefs[response::kMostCoefs];
  v.coefficients(i, coefs);
  if (!(unit >= 0 && unit <= kLargest / 32768)) {
    return fault.fail("RESPONSES: response %: its unit must be 0 to 1e12 / 32768 N", i);
  }
  if (const char* broken = response::broken_rule(coefs, degrees, layout::kMaxFriction / layout::kFrictionUnit)) {
    return fault.fail("RESPONSES: response %: %", i, broken);
  }
  if (!is_padded(v, i, response::offsets(degrees))) {
    return fault.fail("RESPONSES: response %: padding is not zero", i);
  }
  return true;
}

template <std::uint32_t kFeatures>
bool check_responses(const View& v, Fault& fault) {
  const layout::Meta& m = *v.meta;
  for (std::uint32_t i = 0; i < m.response_count; ++i) {
    const layout::ResponseHead& head = v.response_head(i);
    if (!is_limit(head.depth_limit, m.depth_scale)) {
      return fault.fail("RESPONSES: response %: depth limit out of range", i);
    }
    if (head.flags != layout::response_solved && head.flags != layout::response_filled &&
        head.flags != layout::response_measured && head.flags != layout::response_analytic) {
      return fault.fail("RESPONSES: response %: flags %, allowed one of 1 solved, 2 filled, 4 measured, 8 analytic", i,
                        head.flags);
    }
    if constexpr ((kFeatures & layout::feature_slip_softening) != 0) {
      if (m.softening_count > 0 &&
          !(v.softening(i) >= 0 && v.softening(i) <= static_cast<double>(layout::kMaxSoftening))) {
        return fault.fail("RESPONSES: response %: slip softening out of 0 to 0.2", i);
      }
    }
    if (!check_coefficients(v, i, fault)) return false;
  }
  return true;
}

/// Checks the curves of a tool that bonds. Those of another tool must be zero.
inline bool check_bonded(const View& v, std::uint64_t index, bool bonds, Fault& fault) {
  const auto i = static_cast<std::uint32_t>(index);
  const std::uint32_t n = v.meta->bonded_coefs;
  const layout::BondedHead& head = v.bonded_head(index);
  const float* c = v.bonded_curves(index);
  const double most = v.meta->depth_scale;
  if (bonds ? !is_limit(head.depth, most) || !(head.pulled == 0 || is_limit(head.pulled, most))
            : head.depth != 0 || head.pulled != 0) {
    return fault.fail("BONDED: response %: depth or pull out of range, or unlike the other responses of its tool", i);
  }
  for (std::uint32_t k = 0; k < layout::kBondedCurves; ++k) {
    if (!is_curve(c + k * n, n, bonds ? 0 : n, -kLargest, kLargest, k == 2)) {
      return fault.fail("BONDED: response %: %", i,
                        bonds ? "curves must be finite, and the normal force must not decrease"
                              : "its tool does not bond, so its curves must be zero");
    }
  }
  for (std::uint32_t k = 3; k < layout::kBondedCurves; ++k) {
    const float* curve = c + k * n;
    if (curve[0] != curve[1] || curve[n - 1] != curve[n - 2]) {
      return fault.fail("BONDED: response %: stiffness must be level at its ends", i);
    }
  }
  const float *xx = c + 3 * n, *xy = c + 4 * n, *yy = c + 5 * n;
  for (std::uint32_t k = 0; k < n; ++k) {
    if (xx[k] < 0 || yy[k] < 0 || double{xy[k]} * double{xy[k]} > double{xx[k]} * double{yy[k]}) {
      return fault.fail("BONDED: response %: stiffness must be positive semidefinite", i);
    }
  }
  return true;
}

/// Checks the torque curves of a tool that was rotated. Those of another tool must be zero.
inline bool check_torque(const View& v, std::uint64_t index, bool rotates, Fault& fault) {
  const auto i = static_cast<std::uint32_t>(index);
  const std::uint32_t n = v.meta->bonded_coefs;
  const float rotated = v.torque_head(index).rotated, *curves = v.torque_curves(index);
  if (!rotates) {
    if (rotated == 0 && is_curve(curves, layout::kTorqueCurves * n, layout::kTorqueCurves * n, 0, 0, false)) {
      return true;
    }
    return fault.fail("BONDED_TORQUE: response %: its tool is not rotated, so its values must be zero", i);
  }
  if (!is_limit(rotated, layout::kMaxRotation)) {
    return fault.fail("BONDED_TORQUE: response %: angle out of range, allowed above 0 and at most 1 rad", i);
  }
  if (!(v.bonded_head(index).depth > 0)) {
    return fault.fail("BONDED_TORQUE: response %: its tool does not bond", i);
  }
  if (const char* broken = bonded::broken_torque(v.bonded_curves(index), curves, static_cast<int>(n))) {
    return fault.fail("BONDED_TORQUE: response %: %", i, broken);
  }
  return true;
}

/// Checks that all responses of a tool bond or none does, and that all have torques or none has.
inline bool check_bonded_contacts(const View& v, Fault& fault) {
  for (std::uint32_t t = 0; v.bonded != nullptr && t < v.meta->tool_count; ++t) {
    const layout::ToolRecord& tool = v.tools[t];
    const bool bonds = v.bonded_head(tool.first_vertex).depth != 0;
    const bool rotates = v.bonded_torque != nullptr && v.torque_head(tool.first_vertex).rotated != 0;
    for (std::uint32_t site = 0; site < v.meta->site_count; ++site) {
      for (std::uint32_t k = 0; k < tool.vertex_count; ++k) {
        const std::uint64_t index = layout::response_index(*v.meta, site, tool.first_vertex + k);
        if (!check_bonded(v, index, bonds, fault)) return false;
        if (v.bonded_torque != nullptr && !check_torque(v, index, rotates, fault)) return false;
      }
    }
  }
  return true;
}

}  // namespace palpate::runtime::detail
