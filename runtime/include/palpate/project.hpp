// SPDX-License-Identifier: MIT
// Where the smooth normals of the contact surface meet a point: how a sliding contact point follows the tool.
#pragma once

#include "palpate/surface.hpp"

#include <cmath>

namespace palpate::runtime {

/// The point c with q = c + height n(c), found by walking over the surface from a start.
struct Projection {
  BodyPoint at;
  Vec3 point;           ///< c (m)
  Vec3 normal;          ///< n(c)
  double height = 0;    ///< m, of q above c along n(c)
  double residual = 0;  ///< m, length of the part of q - c across n(c)
  bool converged = false;
};

namespace detail {

/// One triangle while a projection passes through it.
struct Facet {
  Vec3 corner, e1, e2;  ///< first corner, edges to the two others
  Vec3 m, f1, f2;       ///< normals the same way
  double size;          ///< m, of both edges together

  Facet(const View& view, std::uint32_t triangle) {
    const layout::SurfaceTriangle& t = view.triangles[triangle];
    corner = vertex(view, t.vertex[0]);
    e1 = vertex(view, t.vertex[1]) - corner;
    e2 = vertex(view, t.vertex[2]) - corner;
    m = corner_normal(view, t, 0);
    f1 = corner_normal(view, t, 1) - m;
    f2 = corner_normal(view, t, 2) - m;
    size = length(e1) + length(e2);
  }
};

/// x and y of a x + b y + c z = r; false where the three are too close to a plane.
inline bool solve3(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& r, double& x, double& y) {
  const Vec3 bc = cross(b, c);
  const double det = dot(a, bc), least = 1e-4 * std::sqrt(dot(a, a) * dot(b, b) * dot(c, c));
  if (!(det > least)) return false;  // negative: past the focal point of the normals
  const double per_det = 1 / det;
  x = per_det * dot(r, bc);
  y = per_det * dot(r, cross(c, a));
  return true;
}

}  // namespace detail

namespace detail {

/// Keeps the best point met so far; m is the normal there, not yet of length 1.
inline void remember(Projection& best, const BodyPoint& at, const Vec3& c, const Vec3& m, double residual) {
  if (residual >= best.residual) return;
  best.at = at;
  best.point = c;
  best.normal = m;
  best.residual = residual;
}

/// Newton's method inside one triangle, starting at `at`. Returns the corner opposite the edge through which
/// the solution left (`at` then lies on it), or -1 when it stays or cannot go on. `moved` tells whether the
/// point moved before leaving.
inline int pass_triangle(const View& view, const Vec3& q, BodyPoint& at, int& steps, Projection& best, bool& moved) {
  const Facet facet(view, at.triangle);
  double* b = at.bary;
  moved = false;
  for (; steps > 0; --steps) {
    const Vec3 c = facet.corner + b[1] * facet.e1 + b[2] * facet.e2;
    const Vec3 m = facet.m + b[1] * facet.f1 + b[2] * facet.f2;
    const double size = dot(m, m);
    if (!(size > 1e-12)) return -1;
    const Vec3 gap = q - c;
    const double t = dot(gap, m) / size;
    const Vec3 across = gap - t * m;
    const double residual = length(across);
    remember(best, at, c, m, residual);
    best.converged = residual <= 1e-10 * (std::fabs(t) + facet.size);
    double d1 = 0, d2 = 0;
    if (best.converged || !solve3(facet.e1 + t * facet.f1, facet.e2 + t * facet.f2, m, across, d1, d2)) return -1;
    double move[3] = {-d1 - d2, d1, d2};
    // A step along an edge must not be stopped by the last bit of its part across it.
    const double along = std::fabs(d1) + std::fabs(d2);
    for (int k = 0; k < 3; ++k) {
      if (b[k] <= 0 && move[k] < 0 && move[k] > -1e-6 * along) move[k] = 0;
    }
    double share = 1;
    int crossing = -1;
    for (int k = 0; k < 3; ++k) {
      if (b[k] + move[k] < 0 && b[k] < share * -move[k]) {
        share = b[k] / -move[k];
        crossing = k;
      }
    }
    for (int k = 0; k < 3; ++k) {
      const double next = b[k] + share * move[k];
      b[k] = k != crossing && next > 0 ? next : 0;
    }
    moved = moved || share > 0;
    if (crossing >= 0) return crossing;
  }
  return -1;
}

}  // namespace detail

/// Newton's method inside a triangle, stepping over edges by adjacency; at most `steps` iterations in all.
/// Where the normals from the surface cross before they reach q, stops at the best point it came to.
inline Projection project(const View& view, const BodyPoint& start, const Vec3& q, int steps = 64) {
  BodyPoint at = start;
  Projection best;
  best.at = start;
  best.residual = HUGE_VAL;
  std::uint32_t previous = view.meta->triangle_count;
  bool moved = true;
  while (steps > 0) {
    const bool moved_before = moved;
    const int crossing = detail::pass_triangle(view, q, at, steps, best, moved);
    if (crossing < 0) break;
    const std::uint32_t next = view.triangles[at.triangle].neighbour[crossing];
    // To and fro over an edge without moving: the two sides disagree, the point is on a crease.
    if (!moved && !moved_before && next == previous) break;
    previous = at.triangle;
    at = cross_edge(view, at, crossing);
    --steps;
  }
  if (std::isinf(best.residual)) {  // the start had no direction to go in
    best.point = position(view, best.at);
    best.normal = normal(view, best.at);
    best.residual = length(tangential(q - best.point, best.normal));
  }
  best.normal = unit(best.normal, best.normal);
  best.height = dot(q - best.point, best.normal);
  return best;
}

}  // namespace palpate::runtime
