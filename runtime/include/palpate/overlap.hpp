// SPDX-License-Identifier: MIT
// How far the sum of contacts that lie near each other can be trusted.
#pragma once

#include "palpate/tick.hpp"
#include "palpate/tool.hpp"

#include <cmath>

namespace palpate::runtime {

/// By what share the sum of two equal tips' forces is too large, for each sinks into the other's dent: `spacing` and
/// their contact radius in m. Measured by solving both at once on a block 30 contact radii wide and deep, 1, 2, 4 and 8
/// radii apart (`palpate verify --two-tips`): 0.33, 0.22, 0.11, 0.04. Straight in between; beyond, falling as the dent
/// does.
inline double superposition_error(double spacing, double contact_radius) {
  constexpr double kError[] = {0.33, 0.22, 0.11, 0.04};
  if (!(contact_radius > 0)) return 0;
  double apart = spacing / contact_radius;
  if (apart >= 8) return kError[3] * 8 / apart;
  if (!(apart > 1)) return apart > 0 ? 0.5 - (0.5 - kError[0]) * apart : 0.5;  // at one place the second counts twice
  int below = 0;
  for (; apart >= 2; apart *= 0.5) ++below;
  return kError[below] + (apart - 1) * (kError[below + 1] - kError[below]);
}

/// How large the contact of a tool is. A round tip's grows with the depth, a punch has its own from the first touch; a
/// mesh tool counts as round with the reach of its skeleton, so rather as too large.
class Tip {
public:
  Tip() = default;
  Tip(const View& view, std::uint32_t tool) {
    const layout::ToolRecord& record = view.tool(tool);
    if (record.kind == static_cast<std::uint32_t>(layout::ToolKind::mesh)) {
      round_ = std::fmax(skeleton_radius(view, tool), record.probe_radius);
    } else {
      (record.probe_radius > 0 ? round_ : flat_) = std::fmax(record.radius, record.probe_radius);
    }
  }

  /// Radius (m) at a depth (m).
  [[nodiscard]] double contact(double depth) const { return flat_ > 0 ? flat_ : std::sqrt(round_ * depth); }

private:
  double round_ = 0, flat_ = 0;  ///< m, radius of curvature, or of the flat end
};

/// Where two contacts add, and whether their sum can be trusted.
struct Overlap {
  double spacing = HUGE_VAL;  ///< m, least between two points c that push
  double error = 0;           ///< largest superposition_error of such two
  /// People notice 7 to 10 %: what is less than this is not worth a warning.
  static constexpr double kNotable = 0.07;
  [[nodiscard]] bool near() const { return error > kNotable; }

  /// Takes in two contacts, of which it counts those that push.
  void add(const Tick& a, const Tip& tip_a, const Tick& b, const Tip& tip_b) {
    if (!(a.depth > 0) || !(b.depth > 0)) return;
    const double gap = length(a.body_point - b.body_point);
    spacing = std::fmin(spacing, gap);
    error = std::fmax(error, superposition_error(gap, std::fmax(tip_a.contact(a.depth), tip_b.contact(b.depth))));
  }
};

}  // namespace palpate::runtime
