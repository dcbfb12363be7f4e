// SPDX-License-Identifier: MIT
// Closest point of the contact surface with its signed distance: through the search tree, or one by one without it.
#pragma once

#include "palpate/geometry/surface.hpp"

#include <cmath>
#include <cstdint>

namespace palpate::runtime {

/// A point of the surface that is closest to some point.
struct Location {
  BodyPoint at;
  Vec3 point;                  ///< m
  double signed_distance = 0;  ///< m, negative inside the body
};

namespace detail {

/// Rounding of a squared distance to a triangle, over that to its first corner.
constexpr double kSlack = 1e-9;

struct Closest {
  double squared = HUGE_VAL;  ///< m^2
  double bary[3] = {1, 0, 0};
};

inline void closest_on_edge(const Vec3& p, const Vec3& a, const Vec3& b, int i, int j, Closest& best) {
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

/// Closest point of a triangle; a triangle without area is its edges. The search may end without a result (infinite
/// `squared`) where the triangle is farther than the root of `most` (m^2).
inline Closest closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c,
                                   double most = HUGE_VAL) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const Vec3 n = cross(ab, ac);
  const double area = dot(n, n), ab2 = dot(ab, ab), ac2 = dot(ac, ac), longest = ab2 + ac2;
  Closest best;
  bool beyond_ab = true, beyond_bc = true, beyond_ca = true;
  if (area > 1e-20 * longest * longest) {
    // Weights and height, times the doubled area squared.
    const double wb = dot(cross(ap, ac), n), wc = dot(cross(ab, ap), n), wa = area - wb - wc, height = dot(ap, n);
    if (wb >= 0 && wc >= 0 && wb + wc <= area) {
      best = {height * height / area, {wa > 0 ? wa / area : 0, wb / area, wc / area}};
      return best;
    }
    // A triangle is at least as far as its plane and, in the plane, as the line of an edge that p lies beyond.
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
  if (beyond_ab) closest_on_edge(p, a, b, 0, 1, best);
  if (beyond_bc) closest_on_edge(p, b, c, 1, 2, best);
  if (beyond_ca) closest_on_edge(p, c, a, 2, 0, best);
  return best;
}

/// A point among the boxes of a search.
class PointOnGrid {
public:
  PointOnGrid(const layout::SearchGrid& grid, const Vec3& p) : square_(double{grid.unit} * double{grid.unit}) {
    const double q[3] = {p.x, p.y, p.z}, per_metre = 1 / double{grid.unit};
    for (int k = 0; k < 3; ++k) steps_[k] = per_metre * (q[k] - double{grid.origin[k]});
  }

  /// Squared distance (m^2) to a node's box.
  [[nodiscard]] double squared_distance(const layout::SearchNode& box) const {
    double squared = 0;
    for (int k = 0; k < 3; ++k) {
      const double gap = larger(0.0, larger(box.lower[k] - steps_[k], steps_[k] - box.upper[k]));
      squared += gap * gap;
    }
    return square_ * squared;
  }

private:
  double steps_[3], square_;
};

/// Calls visit(triangle, bound) for the triangles whose boxes are nearer to p than the root of `bound` (m^2), nearer
/// boxes first; `visit` may lower the bound. Without a tree it visits all triangles.
template <std::uint32_t kFeatures, class Visit>
inline void visit_near(const View& view, const Vec3& p, double bound, const Visit& visit) {
  if ((kFeatures & layout::feature_search) == 0 || view.search == nullptr) {
    for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) visit(t, bound);
    return;
  }
  struct Entry {
    std::uint32_t node;
    double distance;
  } stack[layout::kMaxSearchDepth + 1], next{0, 0};
  const PointOnGrid at(view.search_grid, p);
  int top = 0;
  for (;;) {
    if (next.distance < bound) {
      const layout::SearchNode& n = view.search[next.node];
      const std::uint32_t first = n.first(), count = n.count();
      if (count == 0) {
        Entry left{first, at.squared_distance(view.search[first])};
        Entry right{first + 1, at.squared_distance(view.search[first + 1])};
        const bool left_first = left.distance <= right.distance;
        const Entry& later = left_first ? right : left;
        if (later.distance < bound) stack[top++] = later;
        next = left_first ? left : right;
        continue;
      }
      for (std::uint32_t t = first; t < first + count; ++t) visit(t, bound);
    }
    if (top == 0) return;
    next = stack[--top];
  }
}

inline Closest closest_on_triangle(const View& view, std::uint32_t triangle, const Vec3& p, double most) {
  const auto& v = view.triangle(triangle).vertex;
  return closest_on_triangle(p, vertex(view, v[0]), vertex(view, v[1]), vertex(view, v[2]), most);
}

/// Angle-weighted sum of the face normals about corner `k` (Baerentzen and Aanaes 2005): its sign separates inside from
/// outside.
inline Vec3 vertex_pseudonormal(const View& view, std::uint32_t triangle, int k) {
  constexpr int kMostFaces = 512;  // of one fan
  Vec3 sum;
  std::uint32_t t = triangle;
  const std::uint32_t centre = view.triangle(triangle).vertex[k];
  for (int step = 0; step < kMostFaces; ++step) {
    const layout::SurfaceTriangle face = view.triangle(t);
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

/// A vector whose side decides the sign of the distance at a closest point.
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
  const Vec3 own = unit_face_normal(view, at.triangle);
  if (zeros == 0) return own;
  return own + unit_face_normal(view, view.triangle(at.triangle).neighbour[zero]);
}

inline Location unsigned_location(const View& view, std::uint32_t triangle, const Closest& closest) {
  Location found;
  found.at = {triangle, {closest.bary[0], closest.bary[1], closest.bary[2]}};
  found.point = position(view, found.at);
  found.signed_distance = std::sqrt(closest.squared);
  return found;
}

}  // namespace detail

/// Whether p lies inside the body, whose closest point to p is `closest`.
inline bool is_inside(const View& view, const Vec3& p, const Location& closest) {
  return dot(p - closest.point, detail::pseudonormal(view, closest.at)) < 0;
}

namespace detail {

inline Location location(const View& view, const Vec3& p, std::uint32_t triangle, const Closest& closest) {
  Location found = unsigned_location(view, triangle, closest);
  if (is_inside(view, p, found)) found.signed_distance = -found.signed_distance;
  return found;
}

}  // namespace detail

/// Closest point to p among the triangles whose own closest point is accepted: `accept` takes a point (m). False where
/// there is none within `reach` (m).
template <std::uint32_t kFeatures = layout::feature_all, class Accept>
inline bool closest_point_where(const View& view, const Vec3& p, const Accept& accept, double reach, Location& found) {
  detail::Closest best;
  best.squared = reach * reach;
  std::uint32_t triangle = view.meta->triangle_count;
  detail::visit_near<kFeatures>(view, p, best.squared, [&](std::uint32_t t, double& bound) {
    const detail::Closest on = detail::closest_on_triangle(view, t, p, bound);
    if (!(on.squared < bound)) return;
    if (!accept(position(view, {t, {on.bary[0], on.bary[1], on.bary[2]}}))) return;
    best = on;
    triangle = t;
    bound = on.squared;
  });
  if (triangle == view.meta->triangle_count) return false;
  found = detail::location(view, p, triangle, best);
  return true;
}

/// Accepts every point.
struct AnyPoint {
  bool operator()(const Vec3& /*point*/) const { return true; }
};

/// Closest point of the whole surface to p, which lies within 1e6 m. `near`: any point of the surface; the result does
/// not depend on it, the time does.
template <std::uint32_t kFeatures = layout::feature_all>
PALPATE_NOINLINE inline Location closest_point(const View& view, const Vec3& p, const BodyPoint& near = {}) {
  constexpr double kSlack = 1 + 1e-9;  // rounding must not exclude `near` itself
  Location found;
  if (!closest_point_where<kFeatures>(view, p, AnyPoint(), kSlack * length(p - position(view, near)), found)) {
    closest_point_where<kFeatures>(view, p, AnyPoint(), HUGE_VAL, found);
  }
  return found;
}

namespace detail {

/// End of a walk from triangle to triangle.
struct Walk {
  std::uint32_t triangle = 0;
  Closest closest;
};

/// The walk to the point that is closest to p among the triangles around it: a local minimum of the distance. It
/// depends on the triangle in which it starts, not on the place in it.
PALPATE_NOINLINE inline Walk walk(const View& view, std::uint32_t start, const Vec3& p) {
  constexpr int kMostSteps = 32, kMostFaces = 16;  // of the walk; of a fan about a vertex
  Walk end{start, closest_on_triangle(view, start, p, HUGE_VAL)};
  const auto improves = [&](std::uint32_t next) {
    const Closest on = closest_on_triangle(view, next, p, end.closest.squared);
    if (!(on.squared < (1 - 1e-12) * end.closest.squared)) return false;
    end = {next, on};
    return true;
  };
  const auto step = [&] {
    const double(&bary)[3] = end.closest.bary;
    for (int k = 0; k < 3; ++k) {
      if (bary[k] > 0) continue;
      // On the edge opposite corner k, or at a corner: the neighbour, or the fan about the corner.
      const int corner = bary[(k + 1) % 3] > 0 ? (k + 1) % 3 : (k + 2) % 3;
      const bool edge = bary[3 - k - corner] > 0;
      const std::uint32_t from = end.triangle, centre = view.triangle(from).vertex[corner];
      std::uint32_t next = view.triangle(from).neighbour[edge ? k : (corner + 1) % 3];
      for (int i = 0; i < (edge ? 1 : kMostFaces) && next != from; ++i) {
        if (improves(next)) return true;
        const layout::SurfaceTriangle face = view.triangle(next);
        const int j = face.vertex[0] == centre ? 0 : face.vertex[1] == centre ? 1 : 2;
        next = face.neighbour[(j + 1) % 3];
      }
      return false;
    }
    return false;
  };
  for (int i = 0; i < kMostSteps && step(); ++i) {
  }
  return end;
}

}  // namespace detail

/// The closest point that a walk from triangle to triangle reaches from `start`: a local minimum of the distance,
/// without a search. The sign is that of the side of the surface there.
inline Location local_closest_point(const View& view, const BodyPoint& start, const Vec3& p) {
  const detail::Walk end = detail::walk(view, start.triangle, p);
  return detail::location(view, p, end.triangle, end.closest);
}

/// The nearer of the points that walks from two places reach. The distance has no sign.
inline Location local_closest_point(const View& view, const BodyPoint& one, const BodyPoint& other, const Vec3& p) {
  detail::Walk end = detail::walk(view, one.triangle, p);
  if (other.triangle != one.triangle) {
    const detail::Walk second = detail::walk(view, other.triangle, p);
    if (second.closest.squared < end.closest.squared) end = second;
  }
  return detail::unsigned_location(view, end.triangle, end.closest);
}

/// The closest point of a point that moves. A search keeps the triangles that can be closest while the point stays
/// within some distance of where it was; until it leaves that ball only these are measured. The points are those of
/// closest_point(), for a few times less; the distances have no sign.
/// kMost: triangles that are kept; a vertex has about six.
template <std::uint32_t kFeatures = layout::feature_all, int kMost = 10>
class ClosestPointTracker {
public:
  /// Forgets the last search.
  void reset() { count_ = 0; }

  /// The Location closest to p. `near`: any point of the surface, the nearer the faster.
  [[nodiscard]] Location at(const View& view, const Vec3& p, const BodyPoint& near) {
    const Vec3 way = p - centre_;
    if (count_ == 0 || !(dot(way, way) <= radius_ * radius_)) collect(view, p, near);
    detail::Closest best;
    std::uint32_t triangle = kept_[0].triangle;
    for (int k = 0; k < count_; ++k) {
      if (measure(view, kept_[k], p, best)) triangle = kept_[k].triangle;
    }
    return detail::unsigned_location(view, triangle, best);
  }

private:
  /// A triangle with what its tests need: the weights of the corners at p are affine in p.
  struct Kept {
    std::uint32_t triangle = 0;
    bool flat = false;        ///< has an area to project on
    Vec3 corner;              ///< m
    Vec3 weight[2], height;   ///< 1/m, 1/m, unit normal
    double altitude[3];       ///< m^2, squares of the distances of the corners from the edges opposite
  };

  /// True where the triangle is nearer than `best`, which it becomes.
  static bool measure(const View& view, const Kept& kept, const Vec3& p, detail::Closest& best) {
    detail::Closest on;
    bool inside = false;
    if (kept.flat) {
      const Vec3 gap = p - kept.corner;
      const double wb = dot(gap, kept.weight[0]), wc = dot(gap, kept.weight[1]), h = dot(gap, kept.height);
      if (h * h >= best.squared) return false;
      inside = wb >= 0 && wc >= 0 && wb + wc <= 1;
      on = {h * h, {1 - wb - wc, wb, wc}};
      if (!inside) {
        const double across = best.squared + detail::kSlack * dot(gap, gap) - h * h;
        for (int k = 0; k < 3; ++k) {
          if (on.bary[k] < 0 && on.bary[k] * on.bary[k] * kept.altitude[k] >= across) return false;
        }
      }
    }
    if (!inside) on = detail::closest_on_triangle(view, kept.triangle, p, best.squared);
    if (!(on.squared < best.squared)) return false;
    best = on;
    return true;
  }

  [[nodiscard]] static Kept keep(const View& view, std::uint32_t triangle) {
    const auto& v = view.triangle(triangle).vertex;
    Kept kept;
    kept.triangle = triangle;
    kept.corner = vertex(view, v[0]);
    const Vec3 ab = vertex(view, v[1]) - kept.corner, ac = vertex(view, v[2]) - kept.corner, n = cross(ab, ac);
    const double area = dot(n, n), longest = dot(ab, ab) + dot(ac, ac);
    kept.flat = area > 1e-8 * longest * longest;
    if (!kept.flat) return kept;
    kept.weight[0] = (1 / area) * cross(ac, n);
    kept.weight[1] = (1 / area) * cross(n, ab);
    kept.height = (1 / std::sqrt(area)) * n;
    const Vec3 opposite[3] = {ac - ab, ac, ab};
    for (int k = 0; k < 3; ++k) kept.altitude[k] = area / dot(opposite[k], opposite[k]);
    return kept;
  }

  /// Keeps the nearest triangles, and the radius of the ball in which no other triangle can be closest: with d (m) the
  /// distance to the closest and `next` to the nearest that is not kept, a point moved by r is at most d + r from the
  /// former and at least next - r from the latter.
  PALPATE_NOINLINE void collect(const View& view, const Vec3& p, const BodyPoint& near) {
    constexpr double kWidest = 0.05;  // of the depth scale, of the ball's radius
    const double widest = 2 * kWidest * view.meta->depth_scale;
    double distance = length(p - position(view, near)) * (1 + 1e-9);
    double squared[kMost + 1] = {distance * distance};
    std::uint32_t ids[kMost + 1] = {near.triangle};
    int count = 0;
    const double first = distance + widest;
    detail::visit_near<kFeatures>(view, p, first * first, [&](std::uint32_t t, double& bound) {
      const detail::Closest on = detail::closest_on_triangle(view, t, p, bound);
      if (!(on.squared < bound)) return;
      int k = count <= kMost ? count++ : kMost;
      for (; k > 0 && squared[k - 1] > on.squared; --k) {
        squared[k] = squared[k - 1];
        ids[k] = ids[k - 1];
      }
      squared[k] = on.squared;
      ids[k] = t;
      if (k == 0 && on.squared < distance * distance) {
        distance = std::sqrt(on.squared);
        bound = smaller(bound, (distance + widest) * (distance + widest));
      }
      if (count > kMost) bound = smaller(bound, squared[kMost]);
    });
    distance = std::sqrt(squared[0]);
    double next = distance + widest;
    if (count > kMost) next = smaller(next, std::sqrt(squared[kMost]));
    count_ = 0;
    for (int k = 0; k < count && k < kMost; ++k) {
      if (squared[k] < next * next || k == 0) kept_[count_++] = keep(view, ids[k]);
    }
    centre_ = p;
    radius_ = larger(0.0, 0.5 * (1 - 1e-9) * (next - distance));
  }

  Vec3 centre_;  ///< m
  double radius_ = 0;
  int count_ = 0;
  Kept kept_[kMost];
};

}  // namespace palpate::runtime
