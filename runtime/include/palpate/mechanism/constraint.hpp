// SPDX-License-Identifier: MIT
// Constraints between tools, bodies and the ground: trocar, hinge, weld, suture, two bodies in contact.
#pragma once

#include "palpate/math/pose.hpp"
#include "palpate/shared/compliance.hpp"

#include <array>
#include <cmath>

namespace palpate::runtime {

/// A body that rests at a pose, with the compliance of its file.
struct CompliantBody {
  /// `file`: has layout::feature_compliance, and must outlive this. `at`: body to world.
  explicit CompliantBody(const View& file, const Pose& at = {}) : view(&file), compliance(file), pose(at) {}

  const View* view;
  Compliance compliance;
  Pose pose;

  /// The point of the surface with its part of the compliance.
  [[nodiscard]] CompliancePoint locate(const BodyPoint& at) const {
    CompliancePoint point;
    compliance.locate(at, point);
    return point;
  }
  [[nodiscard]] Vec3 position(const CompliancePoint& point) const {
    const double* p = point.place.position;
    return pose.apply({p[0], p[1], p[2]});
  }
  /// m (world), displacement of the surface at `to` by a force (N, world) at `from`.
  [[nodiscard]] Vec3 displacement(const CompliancePoint& from, const CompliancePoint& to, const Vec3& force) const {
    return pose.rotate(compliance.between(from, to) * pose.unrotate(force));
  }
};

/// One of the two sides that a constraint joins.
struct Side {
  int handle = -1;                         ///< index of a handle, or -1
  Vec3 point;                              ///< m: of the tool's frame; of the world for ground and bodies
  const CompliantBody* body = nullptr;     ///< or null; it must outlive the constraint
  const CompliancePoint* place = nullptr;  ///< of the body; it must outlive the constraint
  /// m, radius of the patch on which the force acts, above 0. It decides the compliance of the place itself.
  double radius = 0.005;

  static Side ground(const Vec3& point) { return {-1, point, nullptr, nullptr, 0}; }
  static Side tool(int handle, const Vec3& point) { return {handle, point, nullptr, nullptr, 0}; }
  static Side surface(const CompliantBody& body, const CompliancePoint& place, double radius) {
    return {-1, body.position(place), &body, &place, radius};
  }

  [[nodiscard]] bool can_move() const { return handle >= 0 || body != nullptr; }
  /// Returns null, or the member that is wrong.
  [[nodiscard]] const char* validate() const {
    if (!finite(point)) return "point of a side is not finite";
    if ((body == nullptr) != (place == nullptr)) return "a side has a body without a place, or a place without a body";
    if (body != nullptr && !(radius > 0 && radius <= 1e6)) return "radius of a side's patch is outside (0, 1e6] m";
    return nullptr;
  }
};

enum class RowKind : unsigned char {
  none,
  bilateral,   ///< gap = 0
  unilateral,  ///< force >= 0 and gap >= 0
  friction,    ///< |force| <= limit
  contact      ///< unilateral, and the two other directions have Coulomb friction of coefficient `limit`
};

enum class DirectionFrame : unsigned char {
  world,
  tool,  ///< of side a
  line   ///< from a to b, for the first direction alone
};

/// Up to three rows between two sides:
///
///     gap_i = direction_i . (a - b) + offset_i                 the force along direction_i acts on a, and reversed on
///     b
///
/// It keeps its forces and the offsets of its friction rows from tick to tick. A copy continues with them.
struct Constraint {
  Side a, b;
  Vec3 direction[3];  ///< unit, orthogonal
  DirectionFrame frame = DirectionFrame::world;
  RowKind kind[3] = {RowKind::none, RowKind::none, RowKind::none};
  double limit = 0;       ///< N of a friction row; coefficient of a contact
  double offset[3] = {};  ///< m
  /// False before its first tick: then friction rows begin unstretched, and a unilateral row whose gap is below 0
  /// begins without force at that gap. It counts from there until it opens, so that a row that is found late gives no
  /// energy.
  bool begun = false;
  double late = 0;       ///< m, by which such a row began late and has not opened since
  double force[3] = {};  ///< N

  /// Whether direction k has a row.
  [[nodiscard]] bool has_row(int k) const { return kind[k] != RowKind::none || kind[0] == RowKind::contact; }
  /// Returns null, or the member that is wrong. Indices of handles are checked by the mechanism.
  [[nodiscard]] const char* validate() const {
    for (const Side* side : {&a, &b}) {
      if (const char* wrong = side->validate()) return wrong;
    }
    if (!a.can_move() && !b.can_move()) return "both sides of a constraint are ground";
    if (!(limit >= 0 && std::isfinite(limit))) return "limit of a constraint is negative or not finite";
    if (!(late >= 0 && std::isfinite(late))) return "late gap of a constraint is negative or not finite";
    for (int k = 0; k < 3; ++k) {
      if (const char* wrong = validate_row(k)) return wrong;
    }
    return nullptr;
  }

private:
  [[nodiscard]] const char* validate_row(int k) const {
    if (!std::isfinite(offset[k]) || !std::isfinite(force[k])) return "offset or force of a constraint is not finite";
    if (k > 0 && kind[k] != RowKind::none && (kind[k] == RowKind::contact || kind[0] == RowKind::contact)) {
      return "a contact is not the first row of its constraint, or has rows besides";
    }
    if (!has_row(k)) return nullptr;
    if (k > 0 && frame == DirectionFrame::line) return "a constraint along a line has more than one row";
    constexpr double kLoose = 5e-3;  // the axes of a valid pose are nearer
    for (int j = 0; j <= k; ++j) {
      if (has_row(j) && !(std::fabs(dot(direction[j], direction[k]) - (j == k ? 1 : 0)) < kLoose)) {
        return "directions of a constraint are not orthonormal within 5e-3";
      }
    }
    return nullptr;
  }
};

namespace constraint_detail {

/// m, between the points of a joint that stop its rotation. Bilateral rows are eliminated exactly, so it changes no
/// force: 0.005, 0.05 and 0.5 agree in 12 digits for a hinge and a weld.
inline constexpr double kLever = 0.05;

inline Constraint joint(int a, const Vec3& on_a, int b, const Vec3& on_b, const Pose& frame, int free) {
  Constraint c;
  c.a = Side::tool(a, on_a);
  c.b = Side::tool(b, on_b);
  c.frame = DirectionFrame::tool;
  const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int k = 0; k < 3; ++k) {
    c.direction[k] = frame.rotate(axes[k]);
    c.kind[k] = (free >> k & 1) != 0 ? RowKind::none : RowKind::bilateral;
  }
  return c;
}

}  // namespace constraint_detail

/// The shaft of a tool passes through a point: no motion across it, friction of at most `friction` (N) along it.
/// `shaft`: frame of the tool whose z axis is the shaft. `at`: ground, or the surface of a body (a compliant wall).
inline Constraint trocar(int handle, const Pose& shaft, const Side& at, double friction = 0) {
  Constraint c = constraint_detail::joint(handle, shaft.translation, -1, {}, shaft, 0);
  c.b = at;
  c.kind[2] = friction > 0 ? RowKind::friction : RowKind::none;
  c.limit = friction;
  return c;
}

/// Two tools turn about one axis: the z axes of the two frames, each of its own tool, coincide with their origins.
inline std::array<Constraint, 2> hinge(int a, const Pose& on_a, int b, const Pose& on_b) {
  using namespace constraint_detail;
  const Vec3 z{0, 0, kLever};
  return {joint(a, on_a.translation, b, on_b.translation, on_a, 0), joint(a, on_a.apply(z), b, on_b.apply(z), on_a, 4)};
}

/// Two tools are one: the two frames, each of its own tool, coincide.
inline std::array<Constraint, 3> weld(int a, const Pose& on_a, int b, const Pose& on_b) {
  using namespace constraint_detail;
  const Vec3 x{kLever, 0, 0}, z{0, 0, kLever};
  return {joint(a, on_a.translation, b, on_b.translation, on_a, 0), joint(a, on_a.apply(z), b, on_b.apply(z), on_a, 4),
          joint(a, on_a.apply(x), b, on_b.apply(x), on_a, 5)};
}

/// A thread between two places, at most `length` (m, at least 0) long. A thread of length 0 is a knot that holds them
/// together.
inline Constraint suture(const Side& a, const Side& b, double length = 0) {
  Constraint c;
  c.a = a;
  c.b = b;
  c.direction[0] = {1, 0, 0};
  c.direction[1] = {0, 1, 0};
  c.direction[2] = {0, 0, 1};
  c.frame = length > 0 ? DirectionFrame::line : DirectionFrame::world;
  c.offset[0] = length;
  c.kind[0] = length > 0 ? RowKind::unilateral : RowKind::bilateral;
  c.kind[1] = c.kind[2] = length > 0 ? RowKind::none : RowKind::bilateral;
  return c;
}

/// Two facing places that may touch: a lies `normal` (unit, world) of b. `friction`: coefficient.
inline Constraint touching(const Side& a, const Side& b, const Vec3& normal, double friction = 0) {
  Constraint c;
  c.a = a;
  c.b = b;
  c.direction[0] = normal;
  c.direction[1] = any_orthogonal(normal);
  c.direction[2] = cross(normal, c.direction[1]);
  c.kind[0] = friction > 0 ? RowKind::contact : RowKind::unilateral;
  c.limit = friction;
  return c;
}

}  // namespace palpate::runtime
