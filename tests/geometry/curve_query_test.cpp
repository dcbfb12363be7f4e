// SPDX-License-Identifier: GPL-3.0-or-later
// Tangents of straight curves, of circles and arcs, and where curves branch.
#include "precompute/geometry/curve_query.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

Curves arc(int count, double radius, double angle, bool closed) {
  Curves c;
  for (int k = 0; k < count + (closed ? 0 : 1); ++k) {
    const double a = angle * k / count;
    c.points.emplace_back(radius * std::cos(a), radius * std::sin(a), 0);
  }
  for (int k = 0; k < count; ++k) c.pieces.push_back({k, (k + 1) % int(c.points.size())});
  return c;
}

// Angle between lines.
double between(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), std::abs(a.dot(b))); }

TEST(CurveQuery, AStraightCurveHasItsOneDirection) {
  const Vector3d direction = Vector3d(1, 2, -0.5).normalized();
  Curves c;
  for (const double at : {-1.0, -0.3, 0.1, 0.9}) c.points.emplace_back(at * direction);
  c.pieces = {{0, 1}, {2, 1}, {2, 3}};  // one runs the other way
  const CurveQuery query(c);
  for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(3, 1, 1), Vector3d(-4, 0, 2), Vector3d(0.1, 0.3, 0)}) {
    EXPECT_LT(between(query.tangent(p), direction), 4e-16 * 10);
    EXPECT_NEAR(query.tangent(p).norm(), 1, 1e-15);
  }
}

TEST(CurveQuery, TangentsOfACircle) {
  const int count = 24;
  const double radius = 0.03;
  const CurveQuery query(arc(count, radius, 2 * std::numbers::pi, true));
  for (int k = 0; k < 500; ++k) {
    const double a = 0.0471 * k;
    const Vector3d out(std::cos(a), std::sin(a), 0), along(-std::sin(a), std::cos(a), 0);
    EXPECT_LT(between(query.tangent(radius * out), along), 1e-3);
    // Off the circle the places nearest to a chord lie a little beside those nearest to the arc.
    EXPECT_LT(between(query.tangent(1.2 * radius * out + Vector3d(0, 0, 0.01)), along), 0.2 * std::numbers::pi / count);
  }
}

// At loose ends the circle goes on, and unequal pieces keep its tangents.
TEST(CurveQuery, TangentsOfAnArcToItsEnds) {
  Curves c;
  for (const double a : {0.0, 0.1, 0.35, 0.5, 0.9}) c.points.emplace_back(std::cos(a), std::sin(a), 0);
  c.pieces = {{0, 1}, {1, 2}, {2, 3}, {3, 4}};
  const CurveQuery query(c);
  for (const double a : {0.0, 0.1, 0.35, 0.5, 0.9}) {
    EXPECT_LT(between(query.tangent({std::cos(a), std::sin(a), 0}), {-std::sin(a), std::cos(a), 0}), 2e-3) << a;
  }
}

TEST(CurveQuery, BranchesKeepTheirOwnDirections) {
  Curves c;
  c.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  c.pieces = {{0, 1}, {0, 2}, {3, 0}};
  const CurveQuery query(c);
  EXPECT_LT(between(query.tangent({0.05, 0, 0}), Vector3d::UnitX()), 1e-15);
  EXPECT_LT(between(query.tangent({0, 0.05, 0}), Vector3d::UnitY()), 1e-15);
  EXPECT_LT(between(query.tangent({0, 0, 3}), Vector3d::UnitZ()), 1e-15);
}

}  // namespace
}  // namespace palpate::geometry
