// SPDX-License-Identifier: GPL-3.0-or-later
// The height of the surface over each facet, then least squares for each vertex.
#include "precompute/mesh/surface/balance_facets.hpp"

#include "precompute/algebra/spectrum.hpp"
#include "precompute/geometry/intersections.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace palpate::mesh {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kAgree = 0.3;    // least cosine between a facet's normal and the original's over it
constexpr double kHighest = 0.2;  // of the facet's longest edge: higher surfaces are folds
// Least eigenvalue of a direction in which a vertex moves, in the largest one of its squares. A crease of 50 degrees
// has 0.2 across the first direction, a round part less.
constexpr double kSecond = 0.15;
constexpr int kRounds = 3;  // of putting back what crosses

// Height (m) of the original over each facet, along the facet's normal, in the mean. The mean over the middles of the
// edges is exact for a quadratic surface.
std::vector<double> heights(const Surface& facets, const geometry::SurfaceQuery& original) {
  struct Over {
    Vector3d way, normal;  // m, to the original; of the original, unit
  };
  std::map<std::pair<std::int32_t, std::int32_t>, Over> edges;
  const Surface& surface = original.surface();
  const auto over = [&](std::int32_t a, std::int32_t b) -> const Over& {
    const auto [found, fresh] = edges.try_emplace(std::minmax(a, b));
    if (fresh) {
      const Vector3d middle = (facets.vertices[std::size_t(a)] + facets.vertices[std::size_t(b)]) / 2;
      const geometry::ClosestPoint on = original.closest(middle);
      const auto& t = surface.triangles[std::size_t(on.triangle)];
      const Vector3d &p = surface.vertices[std::size_t(t[0])], &q = surface.vertices[std::size_t(t[1])],
                     &r = surface.vertices[std::size_t(t[2])];
      found->second = {on.point - middle, (q - p).cross(r - p).normalized()};
    }
    return found->second;
  };
  std::vector<double> heights;
  for (const auto& t : facets.triangles) {
    const Vector3d &a = facets.vertices[std::size_t(t[0])], &b = facets.vertices[std::size_t(t[1])],
                   &c = facets.vertices[std::size_t(t[2])];
    const Vector3d normal = (b - a).cross(c - a).normalized();
    const double highest =
        kHighest * std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Over& there = over(t[k], t[(k + 1) % 3]);
      if (there.normal.dot(normal) > kAgree) sum += std::clamp(there.way.dot(normal), -highest, highest) / 3;
    }
    heights.push_back(sum);
  }
  return heights;
}

// The sum over the facets round a vertex of area (n . move - height)^2.
struct Squares {
  Matrix3d matrix = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();

  [[nodiscard]] Vector3d least() const {
    const auto [values, vectors] = algebra::spectrum<3>(matrix);
    Vector3d move = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      if (values[k] > kSecond * values[2]) move += vectors.col(k).dot(right) / values[k] * vectors.col(k);
    }
    return move;
  }
};

}  // namespace

Surface balance_facets(const Surface& adapted, const geometry::SurfaceQuery& original,
                       const std::vector<std::int32_t>& anchors) {
  const std::vector<double> height = heights(adapted, original);
  std::vector<Squares> squares(adapted.vertices.size());
  for (std::size_t k = 0; k < adapted.triangles.size(); ++k) {
    const auto& t = adapted.triangles[k];
    const Vector3d& a = adapted.vertices[std::size_t(t[0])];
    const Vector3d cross = (adapted.vertices[std::size_t(t[1])] - a).cross(adapted.vertices[std::size_t(t[2])] - a);
    const double area = cross.norm();
    if (!(area > 0)) continue;
    const Vector3d normal = cross / area;
    for (const std::int32_t v : t) {
      squares[std::size_t(v)].matrix += area * normal * normal.transpose();
      squares[std::size_t(v)].right += area * height[k] * normal;
    }
  }
  std::vector<char> stays(adapted.vertices.size(), 0);
  for (const std::int32_t v : anchors) stays[std::size_t(v)] = 1;
  Surface balanced = adapted;
  for (std::size_t v = 0; v < stays.size(); ++v) {
    if (!stays[v]) balanced.vertices[v] += squares[v].least();
  }
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<std::int32_t> crossing = geometry::crossing_triangles(balanced);
    if (crossing.empty()) return balanced;
    for (const std::int32_t t : crossing) {
      for (const std::int32_t v : adapted.triangles[std::size_t(t)]) {
        balanced.vertices[std::size_t(v)] = adapted.vertices[std::size_t(v)];
      }
    }
  }
  return geometry::crossing_triangles(balanced).empty() ? balanced : adapted;
}

}  // namespace palpate::mesh
