// SPDX-License-Identifier: GPL-3.0-or-later
// Rings along the tool's profile, six points more on each while they stand at equal distances.
#include "precompute/verify/ccx/ccx_tool.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace palpate::verify {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

struct Ring {
  double radius, z;  // m
  int count;         // of its points
};

int pieces(double length, double size) { return std::max(1, static_cast<int>(std::ceil(length / size - 1e-9))); }

std::vector<Ring> sphere_rings(double radius, double size) {
  constexpr double kWidest = 75 * kPi / 180;
  std::vector<Ring> rings;
  const int n = pieces(radius * kWidest, size);
  for (int k = 1; k <= n; ++k) {
    const double angle = kWidest * k / n;
    rings.push_back({radius * std::sin(angle), -radius * std::cos(angle), 6 * k});
  }
  return rings;
}

std::vector<Ring> punch_rings(double radius, double edge, double size) {
  std::vector<Ring> rings;
  const int flat = pieces(radius - edge, size), arc = pieces(edge * kPi / 2, size / 3), wall = pieces(radius, size);
  for (int k = 1; k <= flat; ++k) rings.push_back({(radius - edge) * k / flat, 0, 6 * k});
  for (int k = 1; k <= arc; ++k) {
    const double angle = kPi / 2 * k / arc;
    rings.push_back({radius - edge * (1 - std::sin(angle)), edge * (1 - std::cos(angle)), 6 * flat});
  }
  for (int k = 1; k <= wall; ++k) rings.push_back({radius, edge + radius * k / wall, 6 * flat});
  return rings;
}

Vector3d on(const tool::ToolShape& shape, Vector3d point) {
  for (int k = 0; k < 3; ++k) {
    const tool::DistanceSample s = shape.distance(point);
    point -= s.value * s.gradient;
  }
  return point;
}

// Triangles between two rings of points first..first + count - 1: always the shorter diagonal.
void join(std::int32_t inner, int few, std::int32_t outer, int many, std::vector<std::array<std::int32_t, 3>>& out) {
  for (int i = 0, j = 0; i < few || j < many;) {
    const auto at = [](std::int32_t first, int k, int count) { return first + k % count; };
    // The ring whose next point comes first, seen from the axis, moves on.
    if (j < many && (i == few || (2 * j + 1) * few <= (2 * i + 1) * many)) {
      out.push_back({at(inner, i, few), at(outer, j + 1, many), at(outer, j, many)});
      ++j;
    } else {
      out.push_back({at(inner, i, few), at(inner, i + 1, few), at(outer, j, many)});
      ++i;
    }
  }
}

}  // namespace

ToolFacets tool_facets(const tool::Tool& tool, double size) {
  const ToolScene& scene = tool.scene;
  const bool sphere = scene.shape == ToolScene::Shape::sphere;
  if (!sphere && scene.shape != ToolScene::Shape::punch) throw std::invalid_argument("neither a sphere nor a punch");
  const std::vector<Ring> rings =
      sphere ? sphere_rings(scene.radius, size) : punch_rings(scene.radius, scene.edge_radius, size);

  ToolFacets facets;
  facets.inside = {0, 0, sphere ? 0.0 : scene.radius};
  facets.nodes.emplace_back(0, 0, sphere ? -scene.radius : 0.0);
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::int32_t last = 0;
  int count = 1;
  for (const Ring& ring : rings) {
    const auto first = static_cast<std::int32_t>(facets.nodes.size());
    for (int k = 0; k < ring.count; ++k) {
      const double angle = 2 * kPi * k / ring.count;
      facets.nodes.emplace_back(ring.radius * std::cos(angle), ring.radius * std::sin(angle), ring.z);
    }
    if (count == 1) {
      for (int k = 0; k < ring.count; ++k) triangles.push_back({last, first + (k + 1) % ring.count, first + k});
    } else {
      join(last, count, first, ring.count, triangles);
    }
    last = first;
    count = ring.count;
  }
  facets.corner_count = static_cast<std::int32_t>(facets.nodes.size());
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
  const auto middle = [&](std::int32_t a, std::int32_t b) {
    const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(facets.nodes.size()));
    if (fresh) facets.nodes.push_back(on(*tool.shape, (facets.nodes[a] + facets.nodes[b]) / 2));
    return at->second;
  };
  for (const auto& [a, b, c] : triangles) facets.faces.push_back({a, b, c, middle(a, b), middle(b, c), middle(c, a)});
  return facets;
}

}  // namespace palpate::verify
