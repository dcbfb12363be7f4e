// SPDX-License-Identifier: MIT
// Nearest point of the contact surface with its signed distance: by the search tree, or one by one without it.
#pragma once

#include "palpate/surface.hpp"

#include <cmath>
#include <type_traits>

namespace palpate::runtime {

struct Location {
  BodyPoint at;
  Vec3 point;                  ///< m
  double signed_distance = 0;  ///< m, negative inside the body
};

namespace detail {

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

/// By what the square of a bound on a search is more, lest rounding decide otherwise than it does without a bound.
inline constexpr double kBoundSlack = 1 + 1e-9;

/// Every point counts.
struct Anywhere {
  bool operator()(const Vec3& /*point*/) const { return true; }
};

template <class Counts>
inline void consider(const View& view, const Vec3& p, std::uint32_t triangle, const Counts& counts, Nearest& best,
                     std::uint32_t& at) {
  const auto& v = view.triangles[triangle].vertex;
  const Nearest found =
      nearest_on_triangle(p, vertex(view, v[0]), vertex(view, v[1]), vertex(view, v[2]), best.squared);
  if (found.squared >= best.squared) return;
  if constexpr (!std::is_same_v<Counts, Anywhere>) {
    if (!counts(position(view, {triangle, {found.bary[0], found.bary[1], found.bary[2]}}))) return;
  }
  best = found;
  at = triangle;
}

inline double box_distance(const layout::SearchNode& box, const Vec3& p) {
  const double q[3] = {p.x, p.y, p.z};
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const double below = box.lower[k] - q[k], above = q[k] - box.upper[k];
    double gap = below > above ? below : above;
    gap = gap > 0 ? gap : 0;  // a branch would be mispredicted every other time
    squared += gap * gap;
  }
  return squared;
}

template <class Counts>
inline void search_tree(const View& view, const Vec3& p, const Counts& counts, Nearest& best, std::uint32_t& at) {
  struct Entry {
    std::uint32_t node;
    double distance;
  } stack[layout::kMaxSearchDepth + 1], next{0, 0};
  int top = 0;
  for (;;) {
    if (next.distance < best.squared) {
      const layout::SearchNode& n = view.search[next.node];
      if (n.count == 0) {
        const Entry left{n.first, box_distance(view.search[n.first], p)};
        const Entry right{n.first + 1, box_distance(view.search[n.first + 1], p)};
        const bool left_first = left.distance <= right.distance;
        const Entry& later = left_first ? right : left;
        if (later.distance < best.squared) stack[top++] = later;
        next = left_first ? left : right;
        continue;
      }
      for (std::uint32_t t = n.first; t < n.first + n.count; ++t) consider(view, p, t, counts, best, at);
    }
    if (top == 0) return;
    next = stack[--top];
  }
}

/// Sum of the face normals round corner `k`, weighted by their angles: its sign tells inside from outside.
inline Vec3 vertex_pseudonormal(const View& view, std::uint32_t triangle, int k) {
  constexpr int kMostFaces = 512;  // of one fan; a longer one is cut short rather than walked for ever
  Vec3 sum;
  std::uint32_t t = triangle;
  const std::uint32_t centre = view.triangles[triangle].vertex[k];
  for (int step = 0; step < kMostFaces; ++step) {
    const layout::SurfaceTriangle& face = view.triangles[t];
    const int j = face.vertex[0] == centre ? 0 : face.vertex[1] == centre ? 1 : 2;
    const Vec3 o = vertex(view, centre);
    const Vec3 a = vertex(view, face.vertex[(j + 1) % 3]) - o, b = vertex(view, face.vertex[(j + 2) % 3]) - o;
    const Vec3 n = cross(a, b);
    const double size = length(n);
    if (size > 0) sum = sum + (std::atan2(size, dot(a, b)) / size) * n;
    t = face.neighbour[(j + 1) % 3];
    if (t == triangle) break;
  }
  return sum;
}

/// A vector whose side decides the sign of the distance at a point of the surface.
inline Vec3 pseudonormal(const View& view, const BodyPoint& at) {
  int zeros = 0, zero = 0, full = 0;
  for (int k = 0; k < 3; ++k) {
    if (at.bary[k] <= 0) {
      ++zeros;
      zero = k;
    } else {
      full = k;
    }
  }
  if (zeros >= 2) return vertex_pseudonormal(view, at.triangle, full);
  const Vec3 own = unit(face_normal(view, at.triangle), {});
  if (zeros == 0) return own;
  return own + unit(face_normal(view, view.triangles[at.triangle].neighbour[zero]), {});
}

}  // namespace detail

/// Nearest point of the contact surface among those of the triangles whose own nearest point `counts` (a bool of a
/// point, m). False where none does that is nearer than the root of `most` (m^2): the less that is, the shorter the
/// search. It measures every box and triangle at most once.
template <std::uint32_t kFeatures = layout::feature_all, class Counts>
inline bool locate_where(const View& view, const Vec3& p, const Counts& counts, Location& found,
                         double most = HUGE_VAL) {
  detail::Nearest best{most, {1, 0, 0}};
  if ((kFeatures & layout::feature_search) != 0 && view.search != nullptr) {
    detail::search_tree(view, p, counts, best, found.at.triangle);
  } else {
    for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
      detail::consider(view, p, t, counts, best, found.at.triangle);
    }
  }
  if (!(best.squared < most)) return false;
  for (int k = 0; k < 3; ++k) found.at.bary[k] = best.bary[k];
  found.point = position(view, found.at);
  const double distance = std::sqrt(best.squared);
  const bool inside = dot(p - found.point, detail::pseudonormal(view, found.at)) < 0;
  found.signed_distance = inside ? -distance : distance;
  return true;
}

/// Nearest point of the contact surface. Any finite point; the first triangle in file order wins a tie
/// without a search section. `near`: any point of the surface; the nearer it is, the shorter the search, which finds
/// the same.
template <std::uint32_t kFeatures = layout::feature_all>
[[gnu::noinline]] inline Location locate(const View& view, const Vec3& p, const BodyPoint& near = {}) {
  const Vec3 gap = p - position(view, near);
  Location found;
  // Where the point is all but on the surface, what rounding leaves may be more than the slack.
  if (!locate_where<kFeatures>(view, p, detail::Anywhere{}, found, detail::kBoundSlack * dot(gap, gap))) {
    locate_where<kFeatures>(view, p, detail::Anywhere{}, found);
  }
  return found;
}

}  // namespace palpate::runtime
