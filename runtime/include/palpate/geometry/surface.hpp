// SPDX-License-Identifier: MIT
// Points of the contact surface: position, weights of the patch's sites, smooth normal.
#pragma once

#include "palpate/format/response_view.hpp"
#include "palpate/math/vec3.hpp"

#include <cstdint>

namespace palpate::runtime {

/// A point of the contact surface: a triangle and its barycentric weights (>= 0, summing to 1).
struct BodyPoint {
  std::uint32_t triangle = 0;
  double bary[3] = {1, 0, 0};
};

inline Vec3 vertex(const View& view, std::uint32_t index) { return to_vec(view.vertices[index].xyz); }

/// Position (m) of a point of the surface.
inline Vec3 position(const View& view, const BodyPoint& at) {
  const auto& v = view.triangle(at.triangle).vertex;
  return at.bary[0] * vertex(view, v[0]) + at.bary[1] * vertex(view, v[1]) + at.bary[2] * vertex(view, v[2]);
}

/// Weights (>= 0, summing to 1) of the three sites of the point's patch.
inline void site_weights(const View& view, const BodyPoint& at, double (&weights)[3]) {
  const layout::SurfaceTriangle t = view.triangle(at.triangle);
  const double scale = 1.0 / view.meta->subdivision;
  weights[0] = weights[1] = 0;
  for (int k = 0; k < 3; ++k) {
    weights[0] += at.bary[k] * (scale * t.grid[k][0]);
    weights[1] += at.bary[k] * (scale * t.grid[k][1]);
  }
  const double rest = 1 - weights[0] - weights[1];
  weights[2] = rest > 0 ? rest : 0;
}

/// Gradients over the triangle (1/m) of the weights of its three sites; 0 where it has no area.
inline void site_weight_slopes(const View& view, std::uint32_t triangle, Vec3 (&slopes)[3]) {
  const layout::SurfaceTriangle t = view.triangle(triangle);
  const Vec3 corner[3] = {vertex(view, t.vertex[0]), vertex(view, t.vertex[1]), vertex(view, t.vertex[2])};
  const Vec3 area = cross(corner[1] - corner[0], corner[2] - corner[0]);
  const double square = dot(area, area), scale = square > 0 ? 1 / (square * view.meta->subdivision) : 0;
  slopes[0] = slopes[1] = {};
  for (int k = 0; k < 3; ++k) {
    const Vec3 slope = scale * cross(area, corner[(k + 2) % 3] - corner[(k + 1) % 3]);
    slopes[0] = slopes[0] + static_cast<double>(t.grid[k][0]) * slope;
    slopes[1] = slopes[1] + static_cast<double>(t.grid[k][1]) * slope;
  }
  slopes[2] = -slopes[0] - slopes[1];
}

/// Normal of a triangle (m^2): outward, its length is twice the triangle's area.
inline Vec3 face_normal(const View& view, std::uint32_t triangle) {
  const auto& v = view.triangle(triangle).vertex;
  const Vec3 a = vertex(view, v[0]);
  return cross(vertex(view, v[1]) - a, vertex(view, v[2]) - a);
}

/// Unit normal of a triangle, outward, however small it is; `none` where it has no area.
inline Vec3 unit_face_normal(const View& view, std::uint32_t triangle, const Vec3& none = {}) {
  const Vec3 n = face_normal(view, triangle);
  const double size = length(n);
  return size > 0 ? (1 / size) * n : none;
}

/// The smooth unit normal: the sites' normals blended by `weights`. The triangle's own normal where they cancel.
inline Vec3 smooth_normal(const View& view, const BodyPoint& at, const double (&weights)[3]) {
  const auto& site = view.triangle(at.triangle).site;
  Vec3 sum;
  for (int k = 0; k < 3; ++k) sum = sum + weights[k] * to_vec(view.sites[site[k]].normal);
  if (dot(sum, sum) > 1e-12) return unit(sum, sum);
  return unit_face_normal(view, at.triangle, to_vec(view.sites[site[0]].normal));
}
inline Vec3 smooth_normal(const View& view, const BodyPoint& at) {
  double weights[3];
  site_weights(view, at, weights);
  return smooth_normal(view, at, weights);
}

}  // namespace palpate::runtime
