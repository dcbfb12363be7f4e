// SPDX-License-Identifier: MIT
// Nearest points of boxes and triangles.
#pragma once

#include "palpate/lanes.hpp"
#include "palpate/surface.hpp"

#include <cmath>

namespace palpate::runtime::detail {

struct Nearest {
  double squared = 0;
  double bary[3] = {1, 0, 0};
};

inline void nearest_on_edge(const Vec3& p, const Vec3& a, const Vec3& b, int i, int j, Nearest& best) {
  const Vec3 ab = b - a;
  const double size = dot(ab, ab);
  double s = size > 0 ? dot(p - a, ab) / size : 0;
  s = s > 0 ? (s < 1 ? s : 1) : 0;
  const Vec3 gap = a + s * ab - p;
  const double squared = dot(gap, gap);
  if (squared >= best.squared) return;
  best.squared = squared;
  best.bary[0] = best.bary[1] = best.bary[2] = 0;
  best.bary[i] = 1 - s;
  best.bary[j] = s;
}

/// Nearest point of a triangle; a triangle of no area is its edges. May be none (`squared` infinite) where that is not
/// nearer than the root of `most` (m^2).
inline Nearest nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, double most = HUGE_VAL) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const Vec3 n = cross(ab, ac);
  const double area = dot(n, n), ab2 = dot(ab, ab), ac2 = dot(ac, ac), longest = ab2 + ac2;
  Nearest best{HUGE_VAL, {1, 0, 0}};
  bool beyond_ab = true, beyond_bc = true, beyond_ca = true;
  if (area > 1e-20 * longest * longest) {
    // Barycentric weights and height, times the doubled area squared: what divides by it waits until it is wanted.
    const double wb = dot(cross(ap, ac), n), wc = dot(cross(ab, ap), n), wa = area - wb - wc, height = dot(ap, n);
    if (wb >= 0 && wc >= 0 && wb + wc <= area) {
      return {height * height / area, {wa > 0 ? wa / area : 0, wb / area, wc / area}};  // wa may round below zero
    }
    // Where rounding is far below the slack the nearest point is on an edge that p lies beyond. Most triangles of a
    // search are seen off before that: they are at least as far as the plane and, in it, as the line of such an edge.
    constexpr double kSlack = 1e-9;
    if (area > 1e-8 * longest * longest) {
      const Vec3 bc = c - b;
      const double across = (most + kSlack * dot(ap, ap)) * area - height * height;
      beyond_ab = wc < 0;
      beyond_bc = wa < 0;
      beyond_ca = wb < 0;
      const auto far = [&](double weight, double edge) { return weight * weight >= across * edge; };
      if ((beyond_bc && far(wa, dot(bc, bc))) || (beyond_ca && far(wb, ac2)) || (beyond_ab && far(wc, ab2))) {
        return best;
      }
    }
  }
  if (beyond_ab) nearest_on_edge(p, a, b, 0, 1, best);
  if (beyond_bc) nearest_on_edge(p, b, c, 1, 2, best);
  if (beyond_ca) nearest_on_edge(p, c, a, 2, 0, best);
  return best;
}

/// Of two vectors the coordinates side by side.
struct Vec3Two {
  Two x, y, z;
};
inline Vec3Two beside(const Vec3& a, const Vec3& b) { return {two(a.x, b.x), two(a.y, b.y), two(a.z, b.z)}; }
inline Vec3Two operator-(const Vec3Two& a, const Vec3Two& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Two dot(const Vec3Two& a, const Vec3Two& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// m^2, from p to two boxes.
inline Two squared_distances(const layout::SearchNode& first, const layout::SearchNode& second, const Vec3& p) {
  const double q[3] = {p.x, p.y, p.z};
  Two squared = two(0, 0);
  for (int k = 0; k < 3; ++k) {
    const Two at = two(q[k], q[k]), below = two(first.lower[k], second.lower[k]) - at,
              above = at - two(first.upper[k], second.upper[k]);
    const Two gap = positive(larger(below, above));
    squared += gap * gap;
  }
  return squared;
}

/// Of two triangles: above 0 where one is seen to have no point that is nearer to p than the root of `most` (m^2), by
/// what nearest_on_triangle sees. That is most triangles of a search, two in half the time of one there. Not slivers,
/// which rounding would decide.
inline Two out_of_reach(const Vec3Two& p, const Vec3Two& a, const Vec3Two& b, const Vec3Two& c, double most) {
  constexpr double kSlack = 1e-9, kSliver = 1e-4;
  const Vec3Two ab = b - a, ac = c - a, ap = p - a;
  const Two bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac), pb = dot(ap, ab), pc = dot(ap, ac);
  // Barycentric weights, and the square that is left of `most` in the plane, all times the doubled area squared.
  const Two area = bb * cc - bc * bc, wb = cc * pb - bc * pc, wc = bb * pc - bc * pb;
  const Two across = most * area - (1 - kSlack) * dot(ap, ap) * area + wb * pb + wc * pc;
  const auto beyond = [&](const Two& weight, const Two& edge) {
    const Two by = positive(-1.0 * weight);
    return by * by - across * edge;
  };
  const Two of_bc = beyond(area - wb - wc, bb + cc - 2.0 * bc);
  const Two far = larger(larger(-1.0 * across, of_bc), larger(beyond(wb, cc), beyond(wc, bb)));
  return smaller(far, area - kSliver * (bb + cc) * (bb + cc));
}

}  // namespace palpate::runtime::detail
