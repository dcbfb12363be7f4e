// SPDX-License-Identifier: MIT
// How a tool is turned about the normal of its contact: which of the sampled spins answer, and how they lie.
#pragma once

#include "palpate/surface.hpp"

#include <cmath>

namespace palpate::runtime {

/// The spin of a tool at a contact: that of a pose, or one that was sampled (below that vertex' count of spins), which
/// lies as it was baked.
struct Spin {
  const Pose* pose = nullptr;
  std::uint32_t sample = 0;
  /// Of a point on a profile's tip that lies further from the pole than the pose says: times the sine of the tool's
  /// tilt it is how sure the direction is in which it lies, at most wholly.
  double sure_per_sine = HUGE_VAL;
};

/// How a vertex of a tool lies at a contact.
struct LaidVertex {
  Vec3 x;           ///< unit, across n(c): where the tangent of its first spin is
  double sure = 1;  ///< [0, 1], falls to 0 where that direction is lost
};

/// Of a profile the tangent runs up the tool's axis, whichever side of it touches; it is lost where the tool points
/// into the body, and where the stem that is to lie on the body stands upright, or a tip that lags behind. Of a mesh it
/// is carried from the vertex' own normal to the contact's by the smallest rotation; it is lost where these are
/// opposed.
inline LaidVertex laid_vertex(const View& view, const layout::ToolRecord& tool, std::uint32_t vertex, const Pose& pose,
                              const Vec3& n, const Vec3& otherwise, double sure_per_sine = HUGE_VAL) {
  const layout::ToolVertexRecord& record = view.tool_vertices[vertex];
  Vec3 along = pose.rotate({0, 0, 1});
  double cosine = dot(along, n);
  double per_sine = record.tangent[2] > 0.9f ? 2 : sure_per_sine;
  if (tool.kind != static_cast<std::uint32_t>(layout::ToolKind::profile)) {
    const Vec3 own = pose.rotate(to_vec(record.normal));
    cosine = -dot(own, n);
    along = pose.rotate(to_vec(record.tangent));
    if (1 + cosine > 1e-9) along = along + (dot(along, n) / (1 + cosine)) * (own - n);
    per_sine = HUGE_VAL;
  }
  LaidVertex laid;
  laid.x = unit(tangential(along, n), otherwise);
  if (cosine < 0) per_sine = 2;
  if (per_sine < HUGE_VAL) laid.sure = std::fmin(1, per_sine * std::sqrt(std::fmax(0, 1 - cosine * cosine)));
  return laid;
}

/// Cosine and sine of the angles of sampled spins, for a blend that asks for the same ones at each of its sites.
class SampledAngles {
public:
  /// Of one of so many spins evenly round.
  const Across& at(std::uint32_t sample, std::uint32_t spins) {
    Known& known = known_[sample % 2];  // neighbours are asked for in turn
    if (known.sample != sample || known.spins != spins) {
      const double angle = sample * (kFullTurn / spins);
      known = {sample, spins, {std::cos(angle), std::sin(angle)}};
    }
    return known.angle;
  }

private:
  struct Known {
    std::uint32_t sample = 0, spins = 1;
    Across angle;
  };
  Known known_[2];
};

/// Calls use(sample, share, x) for the samples, counted from the vertex' first, that answer for a tool vertex at a site
/// whose frame is carried to x0; x is the axis of what the sample answers. Those on either side of the spin, by hats,
/// each turned on until its tangent lies where the tool's does: what the tool brings along turns with it. What is not
/// sure is left to the first sample as it was baked. Of a view with spins.
template <class Use>
void for_each_spin(const View& view, const layout::ToolRecord& tool, std::uint32_t vertex, const Spin& spin,
                   const Vec3& x0, const Vec3& n, SampledAngles& angles, const Use& use) {
  const std::uint32_t spins = view.spins[vertex];
  if (spins == 1 || spin.pose == nullptr) return use(spin.sample < spins ? spin.sample : 0u, 1.0, x0);
  const LaidVertex laid = laid_vertex(view, tool, vertex, *spin.pose, n, x0, spin.sure_per_sine);
  double angle = std::atan2(dot(cross(x0, laid.x), n), dot(x0, laid.x));
  if (angle < 0) angle += kFullTurn;
  const double at = angle * (spins / kFullTurn);
  const auto below = static_cast<std::uint32_t>(at);  // `spins` where a negative angle was rounded away
  const double share = at - below;
  const Vec3 y = cross(n, laid.x);
  for (std::uint32_t k = 0; k < 2; ++k) {
    const std::uint32_t sample = (below + k) % spins;
    const double weight = laid.sure * (k == 0 ? 1 - share : share);
    if (!(weight > 0)) continue;
    const Across& back = angles.at(sample, spins);
    use(sample, weight, back.cosine * laid.x - back.sine * y);
  }
  if (laid.sure < 1) use(0u, 1 - laid.sure, x0);
}

}  // namespace palpate::runtime
