// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of a prepared surface and their text.
#include "precompute/surface/repair/report.hpp"

#include "precompute/geometry/feature_normals.hpp"
#include "precompute/geometry/topology.hpp"
#include "precompute/surface/repair/cavities.hpp"
#include "precompute/surface/repair/kernel.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace palpate::surface {
namespace {

constexpr std::size_t thickness_points = 500;

// The largest of the lowest `share` of sorted values.
double quantile(const std::vector<double>& sorted, double share) {
  return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(share * double(sorted.size())))];
}

// Two facets whose middles are c apart and that turn by an angle stand for a surface of radius c / angle; the middle of
// an equilateral facet lies c^2 / 2 over that radius below it. The mean over smooth edges, weighted by their length.
double mean_facet_depth(const Surface& surface) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> seen;
  double sum = 0.0, total = 0.0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto middle = [&](std::size_t triangle) {
      Eigen::Vector3d m = Eigen::Vector3d::Zero();
      for (const auto c : surface.triangles[triangle]) m += surface.vertices[std::size_t(c)] / 3;
      return m;
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = surface.triangles[t][k], b = surface.triangles[t][(k + 1) % 3];
      const auto [other, first] = seen.try_emplace(std::minmax(a, b), t);
      if (first) continue;
      const Eigen::Vector3d n = geometry::triangle_normal(surface, t),
                            m = geometry::triangle_normal(surface, other->second);
      const double turn = std::atan2(n.cross(m).norm(), n.dot(m));
      if (turn > geometry::kFeatureAngle * std::numbers::pi / 180) continue;
      const double length = (surface.vertices[std::size_t(b)] - surface.vertices[std::size_t(a)]).norm();
      sum += length * (middle(t) - middle(other->second)).norm() * turn / 2;
      total += length;
    }
  }
  return total > 0 ? sum / total : 0.0;
}

}  // namespace

std::vector<SurfacePoint> spread_points(const Surface& surface, std::size_t count) {
  std::vector<double> until;
  double total = 0.0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    total += geometry::triangle_normal(surface, t).norm();
    until.push_back(total);
  }
  std::vector<SurfacePoint> result;
  if (!(total > 0.0)) return result;
  for (std::size_t i = 0; i < count; ++i) {
    const double wanted = (double(i) + 0.5) / double(count) * total;
    const auto t =
        std::min(std::size_t(std::upper_bound(until.begin(), until.end(), wanted) - until.begin()), until.size() - 1);
    // A two-dimensional Weyl sequence (plastic number) inside the triangles.
    double u = std::fmod(0.5 + 0.7548776662466927 * double(i), 1.0);
    double v = std::fmod(0.5 + 0.5698402909980532 * double(i), 1.0);
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    const auto& corners = surface.triangles[t];
    const auto& a = surface.vertices[std::size_t(corners[0])];
    result.push_back(
        {a + u * (surface.vertices[std::size_t(corners[1])] - a) + v * (surface.vertices[std::size_t(corners[2])] - a),
         geometry::triangle_normal(surface, t).normalized(), std::int32_t(t)});
  }
  return result;
}

void measure(const geometry::SurfaceQuery& query, SurfaceReport& report) {
  const auto& surface = query.surface();
  report.vertices = surface.vertices.size();
  report.triangles = surface.triangles.size();
  Eigen::AlignedBox3d box;
  for (const auto& vertex : surface.vertices) box.extend(vertex);
  if (!box.isEmpty()) report.extents = box.sizes();
  report.volume = geometry::signed_volume(surface);
  report.area = geometry::area(surface);
  report.facet_depth = mean_facet_depth(surface);
  std::vector<double> thickness;
  for (const auto& p : spread_points(surface, thickness_points))
    thickness.push_back(query.thickness(p.point, p.normal));
  std::sort(thickness.begin(), thickness.end());
  if (!thickness.empty()) {
    report.thickness_min = thickness.front();
    report.thickness_p05 = quantile(thickness, 0.05);
    report.thickness_median = quantile(thickness, 0.5);
  }
  const bool thin = report.thickness_median < geometry::diagonal(surface) / 20.0;
  const bool sheet = report.thickness_median * report.area < 3.0 * report.volume;
  report.thin_bag = thin && sheet && cavity_triangles(surface).empty() && report.volume < 0.35 * hull_volume(surface);
}

std::pair<double, double> distances(const Surface& from, const geometry::SurfaceQuery& to) {
  double largest = 0.0, sum = 0.0;
  std::size_t count = 0;
  const auto add = [&](const Eigen::Vector3d& point) {
    const double distance = to.closest(point).distance;
    largest = std::max(largest, distance);
    sum += distance;
    ++count;
  };
  for (const auto& vertex : from.vertices) add(vertex);
  for (const auto& t : from.triangles) {
    add((from.vertices[std::size_t(t[0])] + from.vertices[std::size_t(t[1])] + from.vertices[std::size_t(t[2])]) / 3.0);
  }
  return {largest, count == 0 ? 0.0 : sum / double(count)};
}

std::string text(const SurfaceReport& report) {
  std::string result =
      fmt::format("surface {}: {} vertices, {} triangles\n", report.action, report.vertices, report.triangles);
  for (const auto& finding : report.findings) result += "  found: " + finding + "\n";
  result +=
      fmt::format("  moved: largest {:.3g} mm, mean {:.3g} mm\n", report.largest_move * 1e3, report.mean_move * 1e3);
  result += fmt::format("  extents {:.4g} x {:.4g} x {:.4g} mm\n", report.extents.x() * 1e3, report.extents.y() * 1e3,
                        report.extents.z() * 1e3);
  result += fmt::format("  volume {:.4g} mL, area {:.4g} cm2\n", report.volume * 1e6, report.area * 1e4);
  result += fmt::format("  wall thickness: least {:.3g} mm, 5 % below {:.3g} mm, median {:.3g} mm\n",
                        report.thickness_min * 1e3, report.thickness_p05 * 1e3, report.thickness_median * 1e3);
  if (report.thin_bag) {
    result += "  WARNING: this is a thin closed shell, not a solid organ; wrap it together with the meshes inside it\n";
  }
  return result;
}

std::string text(const Body& body) {
  std::string result = text(body.report);
  for (const auto& inclusion : body.inclusions) {
    if (inclusion.report.findings.empty()) continue;
    result += "region '" + inclusion.name + "': " + text(inclusion.report);
  }
  return result;
}

}  // namespace palpate::surface
