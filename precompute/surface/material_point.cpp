// SPDX-License-Identifier: GPL-3.0-or-later
// From the prestressed surface back to the stress-free one: the same weights in the same triangle.
#include "precompute/common/body.hpp"
#include "precompute/geometry/feature_normals.hpp"
#include "precompute/geometry/topology.hpp"

#include <cmath>

namespace palpate {

MaterialPoint Body::material_point(const Eigen::Vector3d& point) const {
  if (!stress_free) return {point, 1.0};
  const std::int32_t triangle = query->closest(point).triangle;
  const Surface &now = query->surface(), &before = stress_free->query->surface();
  const auto& t = now.triangles[std::size_t(triangle)];
  const geometry::TrianglePoint on = geometry::closest_on_triangle(
      point, now.vertices[std::size_t(t[0])], now.vertices[std::size_t(t[1])], now.vertices[std::size_t(t[2])]);
  MaterialPoint from;
  from.point.setZero();
  for (int k = 0; k < 3; ++k) from.point += on.weights[k] * before.vertices[std::size_t(t[std::size_t(k)])];
  const double area = geometry::triangle_normal(before, std::size_t(triangle)).norm();
  if (area > 0) from.stretch = std::sqrt(geometry::triangle_normal(now, std::size_t(triangle)).norm() / area);
  return from;
}

}  // namespace palpate
