// SPDX-License-Identifier: MIT
// Checks of responses: curves, coupled laws, grasps and their turns.
#pragma once

#include "palpate/coupled_check.hpp"
#include "palpate/spline.hpp"
#include "palpate/turn_check.hpp"
#include "palpate/validate_common.hpp"

namespace palpate::runtime::detail {

/// First `zeros` exactly 0, all inside [low, high], and not falling (direction 1) or not rising (-1).
inline bool is_curve(const float* c, std::uint32_t count, std::uint32_t zeros, float low, float high, int direction) {
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!(c[i] >= low && c[i] <= high)) return false;
    if (i < zeros && c[i] != 0) return false;
    if (i > 0 && static_cast<float>(direction) * (c[i] - c[i - 1]) < 0) return false;
  }
  return true;
}

inline bool is_sideways(const float* c, std::uint32_t count, float high) {
  if (!is_curve(c, count, 0, -high, high, -1)) return false;
  const double size = std::fmax(std::fabs(c[0]), std::fabs(c[count - 1]));
  return std::fabs(spline::value(c, static_cast<int>(count), 0.5)) <= 2e-5 * size;
}

/// What no coefficient takes of a coupled law is zero.
inline bool is_padded(const View& v, std::uint32_t i, const coupled::Degrees& degrees) {
  const unsigned char* law = v.coupled_law(i);
  const coupled::Places p = coupled::places(degrees);
  const std::uint32_t bits = v.meta->coef_bits, limit = layout::coupled_limit_offset(p, bits);
  const std::uint32_t used = static_cast<std::uint32_t>(p.limit) * bits;
  if (used % 8 != 0 && law[4 + used / 8] >> used % 8 != 0) return false;
  for (std::uint32_t k = 4 + (used + 7) / 8; k < limit; ++k) {
    if (law[k] != 0) return false;
  }
  for (std::uint32_t k = limit + 2 * (static_cast<std::uint32_t>(degrees.limit) + 1); k < layout::coupled_size(*v.meta);
       ++k) {
    if (law[k] != 0) return false;
  }
  return true;
}

inline bool check_coupled(const View& v, std::uint32_t i, float largest, Fault& fault) {
  const coupled::Degrees degrees = layout::coupled_degrees(*v.meta);
  const float unit = v.coupled_unit(i);
  std::int16_t coefs[coupled::kMostCoefs];
  v.coupled_coefs(i, coefs);
  if (!(unit >= 0 && unit <= largest / 32768)) return fault.say("RESPONSES: response %: the unit is out of range", i);
  if (const char* broken = coupled::broken_rule(coefs, degrees, 10 / layout::kLimitUnit)) {
    return fault.say("RESPONSES: response %: %", i, broken);
  }
  if (!is_padded(v, i, degrees)) return fault.say("RESPONSES: response %: padding is not zero", i);
  return true;
}

template <std::uint32_t kFeatures>
bool check_responses(const View& v, Fault& fault) {
  constexpr float kLargest = 1e12f;  // N; products of two curves and of extrapolations stay finite
  const layout::Meta& m = *v.meta;
  for (std::uint32_t i = 0; i < m.response_count; ++i) {
    const layout::ResponseHead& head = v.response_head(i);
    if (!is_limit(head.depth_limit, m.depth_scale))
      return fault.say("RESPONSES: response %: depth limit out of range", i);
    if (head.flags != layout::response_solved && head.flags != layout::response_covered &&
        head.flags != layout::response_measured && head.flags != layout::response_analytic) {
      return fault.say("RESPONSES: response %: must be one of solved, covered, measured, analytic", i);
    }
    if constexpr ((kFeatures & layout::feature_relief) != 0) {
      if (m.relief_count > 0 && !(v.relief(i) >= 0 && v.relief(i) <= static_cast<double>(layout::kMostRelief))) {
        return fault.say("RESPONSES: response %: relief out of 0 to 0.2", i);
      }
    }
    if constexpr ((kFeatures & layout::feature_coupled) != 0) {
      if (layout::is_coupled(m)) {
        if (!check_coupled(v, i, kLargest, fault)) return false;
        continue;
      }
    }
    if (!is_curve(v.normal_coefs(i), m.normal_coefs, 2, 0, kLargest, 1)) {
      return fault.say("RESPONSES: response %: normal force must start at zero and not decrease", i);
    }
    for (std::uint32_t axis = 0; m.lateral_coefs > 0 && axis < 2; ++axis) {
      if (!is_curve(v.lateral_coefs(i) + axis * m.lateral_coefs, m.lateral_coefs, 2, -kLargest, kLargest, 0)) {
        return fault.say("RESPONSES: response %: sideways force of a straight push must start at zero and be finite",
                         i);
      }
    }
    if (m.friction_coefs == 0) continue;
    const float* growth = v.friction_coefs(i);
    const float* sideways = growth + 2 * m.growth_coefs;
    for (std::uint32_t axis = 0; axis < 2; ++axis) {
      if (!is_curve(growth + axis * m.growth_coefs, m.growth_coefs, 1, 0, 1e3f, 0)) {
        return fault.say("RESPONSES: response %: growth must start at zero and not be negative", i);
      }
      if (!is_sideways(sideways + axis * m.sideways_coefs, m.sideways_coefs, kLargest)) {
        return fault.say("RESPONSES: response %: sideways force must oppose the deflection and vanish at zero", i);
      }
    }
    if (!is_curve(sideways + 2 * m.sideways_coefs, m.friction_coefs, 0, 0, 10, 0)) {
      return fault.say("RESPONSES: response %: friction limit out of 0 to 10", i);
    }
  }
  return true;
}

/// A response of a tool that holds on has its curves; that of another is zero.
inline bool check_grasp(const View& v, std::uint64_t index, bool holds, Fault& fault) {
  constexpr float kLargest = 1e12f;  // N, N/m
  const auto i = static_cast<std::uint32_t>(index);
  const std::uint32_t n = v.meta->grasp_coefs;
  const layout::GraspHead& head = v.grasp_head(index);
  const float* c = v.grasp_curves(index);
  const double most = v.meta->depth_scale;
  if (holds ? !is_limit(head.depth, most) || !(head.pulled == 0 || is_limit(head.pulled, most))
            : head.depth != 0 || head.pulled != 0) {
    return fault.say("GRASP: response %: depth or pull out of range, or not as the tool's others", i);
  }
  for (std::uint32_t k = 0; k < layout::kGraspCurves; ++k) {
    if (!is_curve(c + k * n, n, holds ? 0 : n, -kLargest, kLargest, k == 2 ? 1 : 0)) {
      return fault.say("GRASP: response %: curves must be finite, and the normal force not decrease", i);
    }
  }
  for (std::uint32_t k = 3; k < layout::kGraspCurves; ++k) {
    const float* curve = c + k * n;
    if (curve[0] != curve[1] || curve[n - 1] != curve[n - 2]) {
      return fault.say("GRASP: response %: stiffness must be level at its ends", i);
    }
  }
  const float *xx = c + 3 * n, *xy = c + 4 * n, *yy = c + 5 * n;
  for (std::uint32_t k = 0; k < n; ++k) {
    if (xx[k] < 0 || yy[k] < 0 || double{xy[k]} * xy[k] > double{xx[k]} * yy[k]) {
      return fault.say("GRASP: response %: stiffness must be positive semidefinite", i);
    }
  }
  return true;
}

/// The same of a grasped tool that is turned.
inline bool check_turn(const View& v, std::uint64_t index, bool turns, Fault& fault) {
  const auto i = static_cast<std::uint32_t>(index);
  const float turned = v.turn_head(index).turned, *curves = v.turn_curves(index);
  if (!turns) {
    if (turned == 0 &&
        is_curve(curves, layout::kTurnCurves * v.meta->grasp_coefs, layout::kTurnCurves * v.meta->grasp_coefs, 0, 0, 0))
      return true;
    return fault.say("TURN: response %: must be zero as the tool's others", i);
  }
  if (!is_limit(turned, layout::kLargestTurn)) return fault.say("TURN: response %: angle out of range", i);
  if (!(v.grasp_head(index).depth > 0)) return fault.say("TURN: response %: has no grasp", i);
  if (const char* broken = grasp::broken_turn(v.grasp_curves(index), curves, static_cast<int>(v.meta->grasp_coefs))) {
    return fault.say("TURN: response %: %", i, broken);
  }
  return true;
}

/// All responses of a tool have a grasp, or none; and turns, or none.
inline bool check_grasps(const View& v, Fault& fault) {
  for (std::uint32_t t = 0; v.grasps != nullptr && t < v.meta->tool_count; ++t) {
    const layout::ToolRecord& tool = v.tools[t];
    const bool holds = v.grasp_head(tool.first_vertex).depth != 0;
    const bool turns = v.turns != nullptr && v.turn_head(tool.first_vertex).turned != 0;
    for (std::uint32_t site = 0; site < v.meta->site_count; ++site) {
      for (std::uint32_t k = 0; k < tool.vertex_count; ++k) {
        const std::uint64_t index = layout::response_index(*v.meta, site, tool.first_vertex + k);
        if (!check_grasp(v, index, holds, fault)) return false;
        if (v.turns != nullptr && !check_turn(v, index, turns, fault)) return false;
      }
    }
  }
  return true;
}

}  // namespace palpate::runtime::detail
