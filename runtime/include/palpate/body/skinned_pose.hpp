// SPDX-License-Identifier: MIT
// A shape that a host gives the body: rotations of its sites, positions of its surface, and a search tree for these.
#pragma once

#include "palpate/format/validate_common.hpp"
#include "palpate/geometry/surface.hpp"
#include "palpate/math/pose.hpp"

#include <cmath>
#include <initializer_list>

namespace palpate::runtime {

/// A rotation as a quaternion; of length 1 unless stated otherwise.
struct Quaternion {
  double w = 1, x = 0, y = 0, z = 0;
};

inline double dot(const Quaternion& a, const Quaternion& b) { return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z; }
inline Quaternion operator+(const Quaternion& a, const Quaternion& b) {
  return {a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Quaternion operator*(double s, const Quaternion& a) { return {s * a.w, s * a.x, s * a.y, s * a.z}; }
/// The rotation b, then a.
inline Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
inline Quaternion normalised(const Quaternion& a) { return (1 / std::sqrt(dot(a, a))) * a; }
/// The linear blend of a and b, with `share` of b, along the shorter way. Its length is any.
inline Quaternion mixed(const Quaternion& a, const Quaternion& b, double share) {
  return (1 - share) * a + (dot(a, b) < 0 ? -share : share) * b;
}
inline Pose to_pose(const Quaternion& q, const Vec3& translation) {
  return Pose::from_quaternion(q.w, q.x, q.y, q.z, translation);
}

/// Whether a shape was accepted.
struct ShapeResult {
  bool ok = false;
  char error[160] = {};  ///< names the fault and where it is; empty when ok
  explicit operator bool() const { return ok; }
};

/// One shape of a body: its file's view with vertices and search tree of its own, and the rotation of every site.
struct SkinnedPose {
  View view;
  const Quaternion* rotations = nullptr;
  double seconds = 0;             ///< s, from the shape before to this one
  double displacement_bound = 0;  ///< m: no point has moved farther since it was baked
};

/// The shape's rotation at a point: those of the patch's sites, blended by their weights.
inline Quaternion rotation_at(const SkinnedPose& shape, const BodyPoint& at) {
  double weights[3];
  site_weights(shape.view, at, weights);
  const auto& site = shape.view.triangle(at.triangle).site;
  const Quaternion& first = shape.rotations[site[0]];
  Quaternion sum{0, 0, 0, 0};
  for (int k = 0; k < 3; ++k) {
    const Quaternion& q = shape.rotations[site[k]];
    sum = sum + (dot(q, first) < 0 ? -weights[k] : weights[k]) * q;
  }
  return normalised(sum);
}

namespace detail {

/// A = sum of (moved edge) (baked edge)^T over the patches about a site, by columns.
struct EdgeSum {
  Vec3 column[3];

  void add(const Vec3& moved, const Vec3& baked) {
    column[0] = column[0] + baked.x * moved;
    column[1] = column[1] + baked.y * moved;
    column[2] = column[2] + baked.z * moved;
  }
  /// The trace of R^T A.
  [[nodiscard]] double agreement(const Pose& r) const {
    const double* m = r.rotation;
    return dot({m[0], m[3], m[6]}, column[0]) + dot({m[1], m[4], m[7]}, column[1]) + dot({m[2], m[5], m[8]}, column[2]);
  }
};

/// The rotation nearest to A, from a start, by the method of Mueller, Bender, Chentanez and Macklin (A robust method to
/// extract the rotational part of deformations, Motion in Games 2016). It needs no inverse, so edges in a plane suffice.
inline Quaternion nearest_rotation(const EdgeSum& a, Quaternion start) {
  // Half a turn away from the solution the iteration has no direction.
  Quaternion q = start;
  double best = -HUGE_VAL;
  for (const Quaternion& half : {Quaternion{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}) {
    const Quaternion candidate = start * half;
    const double agrees = a.agreement(to_pose(candidate, {}));
    if (!(agrees > best)) continue;
    best = agrees;
    q = candidate;
  }
  constexpr int kSteps = 60;  // the error is at least halved each time
  for (int i = 0; i < kSteps; ++i) {
    const Pose r = to_pose(q, {});
    const double* m = r.rotation;
    const Vec3 off = cross({m[0], m[3], m[6]}, a.column[0]) + cross({m[1], m[4], m[7]}, a.column[1]) +
                     cross({m[2], m[5], m[8]}, a.column[2]);
    const double agrees = std::fabs(a.agreement(r));
    if (!(dot(off, off) > 1e-24 * agrees * agrees)) break;
    const Vec3 step = 0.5 / (agrees + 1e-12 * length(off)) * off;
    q = normalised(Quaternion{1, step.x, step.y, step.z} * q);
  }
  return q;
}

/// Edges of a patch from its first site.
struct Edges {
  Vec3 a, b;
};

/// Largest and least principal stretch of a patch, squared; 1 where the baked patch has no area.
inline void squared_stretches(const Edges& baked, const Edges& now, double& most, double& least) {
  most = least = 1;
  const double size = length(baked.a);
  const Vec3 x = unit(baked.a, {});
  const double along = dot(baked.b, x), height = length(baked.b - along * x);
  if (!(height > 1e-6 * size) || !(size > 1e-6 * height)) return;
  const Vec3 f1 = (1 / size) * now.a, f2 = (1 / height) * (now.b - (along / size) * now.a);
  const double mean = 0.5 * (dot(f1, f1) + dot(f2, f2)), half = 0.5 * (dot(f1, f1) - dot(f2, f2));
  const double off = std::sqrt(half * half + dot(f1, f2) * dot(f1, f2));
  most = mean + off;
  least = mean - off;
}

}  // namespace detail

/// Range of a patch's stretch. Responses were baked for the unstretched body and mean little beyond.
inline constexpr double kLeastStretch = 0.5, kMostStretch = 1.75;

/// Makes shapes from positions of the sites. The surface between sites moves by linear blend skinning (Magnenat-
/// Thalmann, Laperriere and Thalmann 1988) with the weights of the responses, so a body that is moved rigidly keeps its
/// shape. Allocates nothing; memory is the caller's.
class SkinnedPoseMaker {
public:
  /// Scratch memory of a site.
  struct Work {
    detail::EdgeSum edges;
    Pose motion;  ///< from where it was baked to where it is
  };

  /// `owners`: as many as the contact surface has vertices; each becomes a triangle that has the vertex. `work`: as many
  /// as there are sites.
  SkinnedPoseMaker(const View& view, std::uint32_t* owners, Work* work) : view_(&view), owners_(owners), work_(work) {
    for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
      for (const std::uint32_t v : view.triangle(t).vertex) owners_[v] = t;
    }
    volume_ = volume([&](std::uint32_t i) { return baked(i); });
  }

  /// Writes rotations, vertices, nodes and grid of the shape in which the sites lie at `positions` (m). `before`:
  /// rotations of a similar shape, to start from. Returns the reason where the positions are no shape of this body.
  ShapeResult make(const Vec3* positions, const Quaternion* before, Quaternion* rotations, layout::Point* vertices,
                   layout::SearchNode* nodes, layout::SearchGrid& grid) {
    ShapeResult result;
    detail::Fault fault(result.error, sizeof result.error);
    result.ok = check_positions(positions, fault) && check_volume(positions, fault);
    if (!result.ok) return result;
    find_rotations(positions, before, rotations);
    result.ok = check_patches(positions, rotations, fault);
    if (!result.ok) return result;
    for (std::uint32_t v = 0; v < view_->meta->vertex_count; ++v) skin(v, vertices[v].xyz);
    refit(vertices, nodes, grid);
    return result;
  }

private:
  using Corners = std::uint32_t[3];

  /// Calls each(sites) for every patch until it returns false; returns whether it never did.
  template <class Each>
  bool each_patch(const Each& each) const {
    for (std::uint32_t i = 0; i < view_->meta->patch_count; ++i) {
      Corners site;
      view_->patch_sites(i, site);
      if (!each(site)) return false;
    }
    return true;
  }

  [[nodiscard]] Vec3 baked(std::uint32_t site) const { return vertex(*view_, site); }

  bool check_positions(const Vec3* positions, detail::Fault& fault) const {
    for (std::uint32_t i = 0; i < view_->meta->site_count; ++i) {
      const float p[3] = {static_cast<float>(positions[i].x), static_cast<float>(positions[i].y),
                          static_cast<float>(positions[i].z)};
      if (!detail::in_range(p)) return fault.fail("site %: position is not finite, or beyond 1e5 m", i);
    }
    return true;
  }

  bool check_volume(const Vec3* positions, detail::Fault& fault) const {
    const bool inside = volume_ > 0 && !(volume([&](std::uint32_t i) { return positions[i]; }) > 0);
    return !inside || fault.fail("the body is inside out, or without volume");
  }

  void find_rotations(const Vec3* positions, const Quaternion* before, Quaternion* rotations) {
    for (std::uint32_t i = 0; i < view_->meta->site_count; ++i) work_[i].edges = {};
    each_patch([&](const Corners& site) {
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t i = site[k], j = site[(k + 1) % 3];
        const Vec3 now = positions[j] - positions[i], then = baked(j) - baked(i);
        work_[i].edges.add(now, then);
        work_[j].edges.add(now, then);  // the signs of the opposite directions cancel
      }
      return true;
    });
    for (std::uint32_t i = 0; i < view_->meta->site_count; ++i) {
      rotations[i] = detail::nearest_rotation(work_[i].edges, before[i]);
      Pose& motion = work_[i].motion;
      motion = to_pose(rotations[i], {});
      motion.translation = positions[i] - motion.rotate(baked(i));
    }
  }

  bool check_patches(const Vec3* positions, const Quaternion* rotations, detail::Fault& fault) const {
    constexpr double kMostApart = 0.70710678;  // cosine of half of the largest rotation of a site against another
    return each_patch([&](const Corners& s) {
      const auto is = [&](const char* what) {
        return fault.fail("the patch of sites %, % and % is %", s[0], s[1], s[2], what);
      };
      const detail::Edges then{baked(s[1]) - baked(s[0]), baked(s[2]) - baked(s[0])};
      const detail::Edges now{positions[s[1]] - positions[s[0]], positions[s[2]] - positions[s[0]]};
      double most = 1, least = 1;
      detail::squared_stretches(then, now, most, least);
      if (!(least >= kLeastStretch * kLeastStretch)) return is("pressed to less than half");
      if (!(most <= kMostStretch * kMostStretch)) return is("stretched to more than 1.75 times");
      for (int k = 0; k < 3; ++k) {
        const Vec3 normal = work_[s[k]].motion.rotate(cross(then.a, then.b));
        if (dot(normal, cross(now.a, now.b)) < 0) return is("turned over at one of them");
        if (!(std::fabs(dot(rotations[s[k]], rotations[s[(k + 1) % 3]])) >= kMostApart)) {
          return is("turned by more than a right angle between two of them");
        }
      }
      return true;
    });
  }

  template <class Position>
  [[nodiscard]] double volume(const Position& position) const {
    double six = 0;
    const Vec3 origin = position(0);
    each_patch([&](const Corners& s) {
      six += dot(position(s[0]) - origin, cross(position(s[1]) - origin, position(s[2]) - origin));
      return true;
    });
    return six / 6;
  }

  void skin(std::uint32_t index, float (&out)[3]) const {
    BodyPoint at;
    at.triangle = owners_[index];
    const layout::SurfaceTriangle t = view_->triangle(at.triangle);
    for (int k = 0; k < 3; ++k) at.bary[k] = t.vertex[k] == index ? 1 : 0;
    double weights[3];
    site_weights(*view_, at, weights);
    const Vec3 then = vertex(*view_, index);
    Vec3 now;
    for (int k = 0; k < 3; ++k) {
      if (!(weights[k] > 0)) continue;
      now = now + weights[k] * work_[t.site[k]].motion.apply(then);
    }
    out[0] = static_cast<float>(now.x);
    out[1] = static_cast<float>(now.y);
    out[2] = static_cast<float>(now.z);
  }

  /// The file's tree with a grid and boxes for these vertices. Children come after their parents, so boxes are made
  /// backwards.
  void refit(const layout::Point* vertices, layout::SearchNode* nodes, layout::SearchGrid& grid) const {
    if (view_->search == nullptr) return;
    grid = layout::grid_over(vertices, view_->meta->vertex_count);
    for (std::uint32_t i = view_->meta->search_nodes; i-- > 0;) {
      layout::SearchNode& node = nodes[i];
      node = layout::kEmptyNode;
      node.place = view_->search[i].place;
      const std::uint32_t first = node.first(), count = node.count();
      for (std::uint32_t t = first; t < first + count; ++t) {
        for (const std::uint32_t v : view_->triangle(t).vertex) layout::hold_point(grid, vertices[v].xyz, node);
      }
      for (std::uint32_t child = first; count == 0 && child < first + 2; ++child) layout::hold_box(nodes[child], node);
    }
  }

  const View* view_;
  std::uint32_t* owners_;
  Work* work_;
  double volume_ = 0;  ///< m^3, as baked
};

}  // namespace palpate::runtime
