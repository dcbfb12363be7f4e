// SPDX-License-Identifier: MIT
// Nearest point of the contact surface with its signed distance: by the search tree, or one by one without it.
#pragma once

#include "palpate/nearest.hpp"

#include <cmath>
#include <type_traits>

namespace palpate::runtime {

struct Location {
  BodyPoint at;
  Vec3 point;                  ///< m
  double signed_distance = 0;  ///< m, negative inside the body
};

namespace detail {

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

/// The triangles begin .. end - 1.
template <class Counts>
inline void consider_all(const View& view, const Vec3& p, std::uint32_t begin, std::uint32_t end, const Counts& counts,
                         Nearest& best, std::uint32_t& at) {
  if constexpr (kTwoARegister) {
    for (std::uint32_t t = begin; t < end; t += 2) {
      const std::uint32_t next = t + 1 < end ? t + 1 : t;
      const auto &v = view.triangles[t].vertex, &w = view.triangles[next].vertex;
      const auto corners = [&](int k) { return beside(vertex(view, v[k]), vertex(view, w[k])); };
      const Two far = out_of_reach(beside(p, p), corners(0), corners(1), corners(2), best.squared);
      if (!(far[0] > 0)) consider(view, p, t, counts, best, at);
      if (!(far[1] > 0) && next != t) consider(view, p, next, counts, best, at);
    }
  } else {
    for (std::uint32_t t = begin; t < end; ++t) consider(view, p, t, counts, best, at);
  }
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
        const Two distances = squared_distances(view.search[n.first], view.search[n.first + 1], p);
        const Entry left{n.first, distances[0]}, right{n.first + 1, distances[1]};
        const bool left_first = left.distance <= right.distance;
        const Entry& later = left_first ? right : left;
        if (later.distance < best.squared) stack[top++] = later;
        next = left_first ? left : right;
        continue;
      }
      consider_all(view, p, n.first, n.first + n.count, counts, best, at);
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
    detail::consider_all(view, p, 0, view.meta->triangle_count, counts, best, found.at.triangle);
  }
  if (!(best.squared < most)) return false;
  for (int k = 0; k < 3; ++k) found.at.bary[k] = best.bary[k];
  found.point = position(view, found.at);
  const double distance = std::sqrt(best.squared);
  const bool inside = dot(p - found.point, detail::pseudonormal(view, found.at)) < 0;
  found.signed_distance = inside ? -distance : distance;
  return true;
}

/// Nearest point of the contact surface. Any point within 1e6 m, where poses are valid: beyond, squares of distances
/// overflow or say nothing. The first triangle in file order wins a tie without a search section. `near`: any point of
/// the surface; the nearer it is, the shorter the search, which finds the same.
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
