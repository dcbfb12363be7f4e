// SPDX-License-Identifier: MIT
// The nearest point of the surface that a walk over it comes to: without a search, from triangle to triangle.
#pragma once

#include "palpate/locate.hpp"

#include <cmath>

namespace palpate::runtime {

namespace detail {

/// Of what a walk met the nearest to p.
struct Nearby {
  std::uint32_t triangle;
  Nearest nearest{HUGE_VAL, {1, 0, 0}};

  /// True where a triangle has a point that is clearly nearer.
  [[gnu::noinline]] bool nearer(const View& view, const Vec3& p, std::uint32_t next) {
    const auto& v = view.triangles[next].vertex;
    const Nearest found =
        nearest_on_triangle(p, vertex(view, v[0]), vertex(view, v[1]), vertex(view, v[2]), nearest.squared);
    if (!(found.squared < (1 - 1e-12) * nearest.squared)) return false;
    triangle = next;
    nearest = found;
    return true;
  }

  /// The same of one that shares the edge or the corner on which the nearest point lies.
  bool goes_on(const View& view, const Vec3& p) {
    constexpr int kMostFaces = 16;  // of one fan
    for (int k = 0; k < 3; ++k) {
      if (nearest.bary[k] > 0) continue;
      const int corner = nearest.bary[(k + 1) % 3] > 0 ? (k + 1) % 3 : (k + 2) % 3;
      const bool edge = nearest.bary[3 - k - corner] > 0;
      const std::uint32_t centre = view.triangles[triangle].vertex[corner];
      std::uint32_t next = view.triangles[triangle].neighbour[k];
      for (int i = 0; i < (edge ? 1 : kMostFaces) && next != triangle; ++i) {
        if (nearer(view, p, next)) return true;
        const layout::SurfaceTriangle& face = view.triangles[next];
        const int j = face.vertex[0] == centre ? 0 : face.vertex[1] == centre ? 1 : 2;
        next = face.neighbour[(j + 1) % 3];
      }
      return false;
    }
    return false;
  }
};

}  // namespace detail

/// Walks from a point of the surface to where none of the triangles around is nearer to p.
[[gnu::noinline]] inline Location nearby(const View& view, const BodyPoint& start, const Vec3& p) {
  constexpr int kMostSteps = 32;
  detail::Nearby walk{start.triangle};
  walk.nearer(view, p, start.triangle);
  for (int i = 0; i < kMostSteps && walk.goes_on(view, p); ++i) {
  }
  Location found{{walk.triangle, {walk.nearest.bary[0], walk.nearest.bary[1], walk.nearest.bary[2]}}, {}};
  found.point = position(view, found.at);
  const double distance = std::sqrt(walk.nearest.squared);
  found.signed_distance = dot(p - found.point, normal(view, found.at)) < 0 ? -distance : distance;
  return found;
}

}  // namespace palpate::runtime
