// SPDX-License-Identifier: MIT
// Shares and axes of the responses at a contact: sites by weights, tool vertices by weights, spins by how the tool lies.
#pragma once

#include "palpate/geometry/surface.hpp"
#include "palpate/geometry/tool_shape.hpp"
#include "palpate/math/vec2.hpp"

#include <cmath>

namespace palpate::runtime {

/// Distinct vertices, numbered over all tools, of a tool point, with their weights.
struct ToolCorners {
  int count = 0;
  std::uint32_t vertex[3] = {};
  double weight[3] = {};
};

template <std::uint32_t kFeatures = layout::feature_all>
inline ToolCorners tool_corners(const View& view, std::uint32_t tool, const ToolPoint& at) {
  const layout::ToolRecord& record = view.tools[tool];
  if ((kFeatures & layout::feature_tool_patches) == 0 || view.tool_patches == nullptr || record.vertex_count == 1) {
    return {1, {record.first_vertex}, {1}};
  }
  const layout::ToolPatch& patch = view.tool_patches[at.patch];
  ToolCorners corners;
  for (int k = 0; k < 3; ++k) {
    if (!(at.weights[k] > 0)) continue;
    int same = 0;
    while (same < corners.count && corners.vertex[same] != patch.vertex[k]) ++same;
    if (same == corners.count) corners.vertex[corners.count++] = patch.vertex[k];
    corners.weight[same] += at.weights[k];
  }
  return corners;
}

/// The x axis of a site's frame, carried to a point with unit normal n by the smallest rotation between the normals, as
/// a unit complex number in the basis (x, n cross x) there.
inline Vec2 carried_axis(const layout::Site& site, const Vec3& n, const Vec3& x, const Vec3& y) {
  const Vec3 axis = turned(to_vec(site.tangent), to_vec(site.normal), n);
  const Vec2 carried{dot(axis, x), dot(axis, y)};
  const double size = length(carried);
  return size > 1e-12 ? (1 / size) * carried : Vec2{1, 0};
}

/// How a tool lies at a contact: by its pose (body frame), or as one of the sampled spins was baked (0 where a vertex has
/// fewer). Tools with one spin have no use for either.
struct Orientation {
  const Pose* pose = nullptr;
  std::uint32_t sample = 0;

  Orientation() = default;
  Orientation(const Pose* pose_of_tool) : pose(pose_of_tool) {}
  explicit Orientation(std::uint32_t sampled_spin) : sample(sampled_spin) {}
};

namespace detail {

/// How the tangent of a tool vertex lies at a contact.
struct LaidTangent {
  Vec2 axis{1, 0};       ///< unit, in the basis of the blend
  double confidence = 0;  ///< [0, 1]: falls to 0 where the direction is lost
};

/// A profile's tangent runs up the tool's axis and is lost where the tool stands upright on its stem or points into the
/// body. A mesh's is carried from the vertex' normal to the contact's by the smallest rotation.
inline LaidTangent laid_tangent(const View& view, const layout::ToolRecord& tool, std::uint32_t vertex,
                                const Pose& pose, const Vec3& n, const Vec3& x, const Vec3& y) {
  const layout::ToolVertexRecord& record = view.tool_vertices[vertex];
  Vec3 along = pose.axis();
  double cosine = dot(along, n);
  const bool profile = tool.kind == static_cast<std::uint32_t>(layout::ToolKind::profile);
  if (!profile) {
    const Vec3 own = pose.rotate(to_vec(record.normal));
    cosine = -dot(own, n);
    along = turned(pose.rotate(to_vec(record.tangent)), own, -n);
  }
  const Vec2 flat{dot(along, x), dot(along, y)};
  const double size = length(flat);
  if (!(size > 0)) return {};
  const double sine = std::sqrt(larger(0, 1 - cosine * cosine));
  const bool loses = cosine < 0 || (profile && record.tangent[2] > 0.9f);
  return {(1 / size) * flat, loses ? smaller(1, 2 * sine) : 1};
}

}  // namespace detail

/// Calls use(response, share, axis) for every response of a tool at (c, p): its share of the blend (> 0) and its x axis
/// as a complex number in the basis of `frame` (normal(), basis_x(), basis_y()). `weights`: of the sites. With several
/// spins the two samples on either side of the tool's spin share linearly, each turned to where the tool's tangent
/// lies. The rest of the share (1 - confidence) belongs to the first sample in the site's frame.
template <std::uint32_t kFeatures, class Frame, class Use>
inline void for_each_share(const View& view, std::uint32_t tool, const BodyPoint& c, const ToolPoint& p,
                           const Orientation& lies, const Frame& frame, const double (&weights)[3], const Use& use) {
  const auto& site = view.triangle(c.triangle).site;
  const ToolCorners corners = tool_corners<kFeatures>(view, tool, p);
  Vec2 axis[3];
  for (int k = 0; k < 3; ++k) {
    axis[k] = carried_axis(view.sites[site[k]], frame.normal(), frame.basis_x(), frame.basis_y());
  }
  for (int l = 0; l < corners.count; ++l) {
    const std::uint32_t vertex = corners.vertex[l];
    std::uint32_t spins = 1;
    if constexpr ((kFeatures & layout::feature_spin) != 0) {
      if (view.spins != nullptr) spins = view.spins[vertex];
    }
    const auto answer = [&](int k, std::uint32_t sample, double share, const Vec2& x) {
      const double all = weights[k] * corners.weight[l] * share;
      if (all > 0) use(layout::response_index(*view.meta, site[k], vertex) + sample, all, x);
    };
    if (spins <= 1 || lies.pose == nullptr) {
      for (int k = 0; k < 3; ++k) answer(k, lies.sample < spins ? lies.sample : 0, 1, axis[k]);
      continue;
    }
    if constexpr ((kFeatures & layout::feature_spin) != 0) {
      const double spacing = kFullTurn / spins;  // rad
      const Vec2 step{std::cos(spacing), -std::sin(spacing)};
      const detail::LaidTangent laid = detail::laid_tangent(view, view.tools[tool], vertex, *lies.pose, frame.normal(),
                                                            frame.basis_x(), frame.basis_y());
      for (int k = 0; k < 3; ++k) {
        const Vec2 from = product(laid.axis, {axis[k].x, -axis[k].y});  // angle from the site's axis to the tangent
        double at = std::atan2(from.y, from.x) / spacing;
        if (at < 0) at += spins;
        const double below = std::floor(at), share = at - below;
        const auto sample = static_cast<std::uint32_t>(below) % spins;
        Vec2 x_of_sample = laid.axis, turn = step;
        for (std::uint32_t left = sample; left > 0; left /= 2, turn = product(turn, turn)) {
          if (left % 2 == 1) x_of_sample = product(x_of_sample, turn);
        }
        answer(k, sample, laid.confidence * (1 - share), x_of_sample);
        answer(k, (sample + 1) % spins, laid.confidence * share, product(x_of_sample, step));
        answer(k, 0, 1 - laid.confidence, axis[k]);
      }
    }
  }
}

}  // namespace palpate::runtime
