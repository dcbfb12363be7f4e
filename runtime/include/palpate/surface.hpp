// SPDX-License-Identifier: MIT
// Points of the contact surface: position, weights of the patch's sites, interpolated normal.
#pragma once

#include "palpate/math3.hpp"
#include "palpate/view.hpp"

#include <cstdint>

namespace palpate::runtime {

/// A point of the contact surface: a triangle and its barycentric weights (>= 0, summing to 1).
struct BodyPoint {
  std::uint32_t triangle = 0;
  double bary[3] = {1, 0, 0};
};

/// A point of a tool: an index into the file's tool patches and weights of that patch's vertices. A tool
/// with one vertex has patch 0 and weights {1, 0, 0}.
struct ToolPoint {
  std::uint32_t patch = 0;
  double weights[3] = {1, 0, 0};
};

inline Vec3 vertex(const View& view, std::uint32_t index) { return to_vec(view.vertices[index].xyz); }

inline Vec3 position(const View& view, const BodyPoint& at) {
  const auto& v = view.triangles[at.triangle].vertex;
  return at.bary[0] * vertex(view, v[0]) + at.bary[1] * vertex(view, v[1]) + at.bary[2] * vertex(view, v[2]);
}

/// Weights of the three sites of the point's patch.
inline void patch_weights(const View& view, const BodyPoint& at, double (&weights)[3]) {
  const layout::SurfaceTriangle& t = view.triangles[at.triangle];
  const double scale = 1.0 / view.meta->subdivision;
  weights[0] = weights[1] = 0;
  for (int k = 0; k < 3; ++k) {
    weights[0] += at.bary[k] * (scale * t.grid[k][0]);
    weights[1] += at.bary[k] * (scale * t.grid[k][1]);
  }
  const double rest = 1 - weights[0] - weights[1];
  weights[2] = rest > 0 ? rest : 0;
}

/// Normal of the triangle as it lies, length twice its area.
inline Vec3 face_normal(const View& view, std::uint32_t triangle) {
  const auto& v = view.triangles[triangle].vertex;
  const Vec3 a = vertex(view, v[0]);
  return cross(vertex(view, v[1]) - a, vertex(view, v[2]) - a);
}

/// Sum of the sites' normals at corner `k` of a triangle (not normalised: linear inside the patch).
inline Vec3 corner_normal(const View& view, const layout::SurfaceTriangle& t, int k) {
  const double scale = 1.0 / view.meta->subdivision;
  const double a = scale * t.grid[k][0], b = scale * t.grid[k][1];
  return a * to_vec(view.sites[t.site[0]].normal) + b * to_vec(view.sites[t.site[1]].normal) +
         (1 - a - b) * to_vec(view.sites[t.site[2]].normal);
}

/// n(c) for a caller that has the weights of the patch's sites: the unit normal that all responses at the point share.
inline Vec3 normal(const View& view, const BodyPoint& at, const double (&weights)[3]) {
  const auto& site = view.triangles[at.triangle].site;
  Vec3 sum;
  for (int k = 0; k < 3; ++k) sum = sum + weights[k] * to_vec(view.sites[site[k]].normal);
  // Opposed normals of a knife edge may cancel: there the triangle's own normal stands in.
  if (dot(sum, sum) > 1e-12) return unit(sum, sum);
  return unit(face_normal(view, at.triangle), to_vec(view.sites[site[0]].normal));
}
/// n(c).
inline Vec3 normal(const View& view, const BodyPoint& at) {
  double weights[3];
  patch_weights(view, at, weights);
  return normal(view, at, weights);
}

/// A direction across n(c), in a basis x, n(c) x x there.
struct Across {
  double cosine = 1, sine = 0;
};
/// The x axis of a site's frame, carried to a point with unit normal `n` by the smallest rotation between the normals;
/// `x` where they are opposed. `y` is n x x.
inline Across carried_axis(const layout::Site& site, const Vec3& n, const Vec3& x, const Vec3& y) {
  const Vec3 own = to_vec(site.normal), t = to_vec(site.tangent);
  const double cosine = dot(own, n), along = cosine > -0.999 ? dot(t, n) / (1 + cosine) : 0;
  const Across carried{dot(t, x) - along * dot(own, x), dot(t, y) - along * dot(own, y)};
  const double square = carried.cosine * carried.cosine + carried.sine * carried.sine, off = square - 1;
  if (!(square > 1e-24)) return {};
  // As short as floats leave it, its series is as good as a root, and sooner there.
  const double scale = std::fabs(off) < 1e-5 ? 1 - off * (0.5 - 0.375 * off) : 1 / std::sqrt(square);
  return {scale * carried.cosine, scale * carried.sine};
}

/// Distinct vertices, numbered over all tools, of a tool point, with their weights.
struct ToolCorners {
  int count = 0;
  std::uint32_t vertex[3] = {};
  double weight[3] = {};
};
inline bool operator==(const ToolCorners& a, const ToolCorners& b) {
  bool same = a.count == b.count;
  for (int k = 0; k < 3; ++k) same = same && a.vertex[k] == b.vertex[k] && a.weight[k] == b.weight[k];
  return same;
}
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

/// Leaves a triangle across the edge opposite `corner`: the same point seen from the neighbour.
inline BodyPoint cross_edge(const View& view, const BodyPoint& at, int corner) {
  const layout::SurfaceTriangle& t = view.triangles[at.triangle];
  BodyPoint to;
  to.triangle = t.neighbour[corner];
  const layout::SurfaceTriangle& n = view.triangles[to.triangle];
  for (int j = 0; j < 3; ++j) {
    to.bary[j] = 0;
    for (int k = 0; k < 3; ++k) {
      if (k != corner && n.vertex[j] == t.vertex[k]) to.bary[j] = at.bary[k];
    }
  }
  return to;
}

}  // namespace palpate::runtime
