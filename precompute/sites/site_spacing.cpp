// SPDX-License-Identifier: GPL-3.0-or-later
// Thickness and curvature measured at the base surface's vertices, graded, and interpolated in between.
#include "precompute/sites/site_spacing.hpp"

#include "precompute/geometry/feature_normals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace palpate::sites {
namespace {

using Eigen::Vector3d;

constexpr double kThin = 1.5;    // walls thinner than this many spacings get smaller ones
constexpr double kTurn = 0.8;    // largest turn of the normal along an edge, radians
constexpr double kGrowth = 0.5;  // of the spacing with distance

// Radius of curvature at every vertex, the smallest along its edges, from averaged normals: the turn of sharp
// edges counts over the averaging radius and not as infinite.
std::vector<double> curvature_radii(const Surface& base, const std::vector<Vector3d>& normals, double averaging) {
  std::vector<double> radii(base.vertices.size(), std::numeric_limits<double>::infinity());
  for (const auto& t : base.triangles) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = t[k], b = t[(k + 1) % 3];
      const double turn = std::acos(std::clamp(normals[a].dot(normals[b]), -1.0, 1.0));
      if (turn < 1e-6) continue;
      const double radius = std::max((base.vertices[a] - base.vertices[b]).norm(), averaging) / turn;
      radii[a] = std::min(radii[a], radius);
      radii[b] = std::min(radii[b], radius);
    }
  }
  return radii;
}

void limit_growth(const Surface& base, std::vector<double>& spacing) {
  bool changed = true;
  for (int pass = 0; pass < 100 && changed; ++pass) {
    changed = false;
    for (const auto& t : base.triangles) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t a = t[k], b = t[(k + 1) % 3];
        const double step = kGrowth * (base.vertices[a] - base.vertices[b]).norm();
        for (const auto& [low, high] : {std::pair{a, b}, std::pair{b, a}}) {
          const double most = spacing[low] + step;
          // Rounding must not keep the sweep alive.
          if (spacing[high] <= most * (1 + 1e-9)) continue;
          spacing[high] = most;
          changed = true;
        }
      }
    }
  }
}

}  // namespace

mesh::SizeField site_spacing(const SamplingScene& sampling, const Body& body) {
  const double widest = sampling.spacing;
  const double narrowest = sampling.margin_spacing > 0 ? sampling.margin_spacing : widest / 2;
  if (narrowest >= widest) return [widest](const Vector3d&) { return widest; };

  const Surface& base = body.base;
  const double averaging = widest / 3;
  std::vector<Vector3d> normals;
  for (const Vector3d& v : base.vertices) normals.push_back(body.query->normal(v, averaging));
  const std::vector<double> radii = curvature_radii(base, normals, averaging);
  auto spacing = std::make_shared<std::vector<double>>();
  for (std::size_t v = 0; v < base.vertices.size(); ++v) {
    const double by_thickness = body.query->thickness(body.query->closest(base.vertices[v]).point, normals[v]) / kThin;
    spacing->push_back(std::clamp(std::min(by_thickness, kTurn * radii[v]), narrowest, widest));
  }
  limit_growth(base, *spacing);
  const auto query = std::make_shared<const geometry::SurfaceQuery>(base);
  return [spacing, query](const Vector3d& p) {
    const Surface& s = query->surface();
    const auto& t = s.triangles[query->closest(p).triangle];
    const geometry::TrianglePoint on =
        geometry::closest_on_triangle(p, s.vertices[t[0]], s.vertices[t[1]], s.vertices[t[2]]);
    double h = 0;
    for (int k = 0; k < 3; ++k) h += on.weights[k] * (*spacing)[t[k]];
    return h;
  };
}

}  // namespace palpate::sites
