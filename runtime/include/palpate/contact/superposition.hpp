// SPDX-License-Identifier: MIT
// Error of the sum of contacts that lie near each other.
#pragma once

#include "palpate/contact/tick.hpp"
#include "palpate/geometry/tool_shape.hpp"

#include <cmath>

namespace palpate::runtime {

/// Constants of the superposition error.
struct SuperpositionConstants {
  /// Error at 1, 2, 4 and 8 contact radii between two equal contacts: both solved at once on a block that is 30 contact
  /// radii wide and deep, against the sum of each alone (`palpate verify --two-tips`).
  static constexpr double kError[] = {0.33, 0.22, 0.11, 0.04};
  /// Error above which the sum is not trusted. The least change of a force that people notice is 7 to 10 %.
  static constexpr double kNotable = 0.07;
};

/// Returns the share by which the sum of two equal contacts' forces is too large, because each lies in the other's
/// dent. The value is linear between the measured distances, 0.5 at distance 0, and falls as 1 / distance beyond 8
/// radii. `spacing` and `contact_radius` in m.
inline double superposition_error(double spacing, double contact_radius) {
  constexpr double kOnePlace = 0.5;  // the second contact counts twice
  const auto& error = SuperpositionConstants::kError;
  if (!(contact_radius > 0)) return 0;
  double distance = spacing / contact_radius;
  if (distance >= 8) return error[3] * 8 / distance;
  if (!(distance > 1)) return distance > 0 ? kOnePlace - (kOnePlace - error[0]) * distance : kOnePlace;
  int below = 0;
  for (; distance >= 2; distance *= 0.5) ++below;
  return error[below] + (distance - 1) * (error[below + 1] - error[below]);
}

/// Radius of a tool's contact area: sqrt(R z) at the depth z for a round tip of radius R, or the radius of a flat
/// punch. A mesh tool counts as round with the radius of its extent, which is the safe side.
class ContactRadius {
public:
  ContactRadius() = default;
  ContactRadius(const View& view, std::uint32_t tool) {
    const layout::ToolRecord& record = view.tool(tool);
    if (record.kind == static_cast<std::uint32_t>(layout::ToolKind::mesh)) {
      round_ = ToolShape<>(view, tool).extent();
    } else {
      (record.probe_radius > 0 ? round_ : flat_) = std::fmax(record.radius, record.probe_radius);
    }
  }
  /// Returns the radius (m) at a depth (m).
  [[nodiscard]] double at(double depth) const { return flat_ > 0 ? flat_ : std::sqrt(round_ * depth); }

private:
  double round_ = 0, flat_ = 0;  ///< m, radius of curvature; radius of a flat end
};

/// Largest superposition error among the contacts of one tick.
struct SuperpositionError {
  double spacing = HUGE_VAL;  ///< m, least distance of two points c
  double error = 0;           ///< superposition_error() of the worst pair

  [[nodiscard]] bool notable() const { return error > SuperpositionConstants::kNotable; }

  /// Adds a pair of contacts. A contact without counted depth has no force and does not count.
  void add(const Tick& a, const ContactRadius& radius_a, const Tick& b, const ContactRadius& radius_b) {
    if (!(a.counted_depth > 0) || !(b.counted_depth > 0)) return;
    const double gap = length(a.body_point - b.body_point);
    spacing = std::fmin(spacing, gap);
    error = std::fmax(error,
                      superposition_error(gap, std::fmax(radius_a.at(a.counted_depth), radius_b.at(b.counted_depth))));
  }
};

}  // namespace palpate::runtime
