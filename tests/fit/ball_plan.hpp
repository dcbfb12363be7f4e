// SPDX-License-Identifier: GPL-3.0-or-later
// A closed haptic mesh (an octahedron refined on the unit ball, scaled) and the plan of all its sites.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <utility>

#include "precompute/bake/plan.hpp"
#include "precompute/mesh/surface/contact_surface.hpp"
#include "precompute/sites/haptic_mesh.hpp"

namespace palpate::test {

/// 6, 18, 66, 258 ... sites for 0, 1, 2, 3 refinements; k = 1: the contact surface is the haptic mesh itself.
inline sites::HapticMesh ball_mesh(int refinements, double radius, double depth) {
  sites::HapticMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) mesh.points.push_back(sign * Eigen::Vector3d::Unit(axis));
  }
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int round = 0; round < refinements; ++round) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(mesh.points.size()));
      if (fresh) mesh.points.push_back((mesh.points[a] + mesh.points[b]).normalized());
      return at->second;
    };
    std::vector<std::array<std::int32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& t :
           {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}}) {
        finer.push_back(t);
      }
    }
    mesh.triangles = finer;
  }
  for (Eigen::Vector3d& p : mesh.points) {
    mesh.normals.push_back(p);
    mesh.tangents.push_back(p.unitOrthogonal());
    p *= radius;
  }
  const std::size_t n = mesh.points.size();
  mesh.thickness.assign(n, 2 * radius);
  mesh.depth.assign(n, depth);
  mesh.held.assign(n, 0);
  mesh.selected.assign(n, 1);
  return mesh;
}

/// The patches themselves.
inline mesh::ContactSurface ball_surface(const sites::HapticMesh& mesh) {
  mesh::ContactSurface surface;
  surface.points = mesh.points;
  surface.patches = mesh.triangles;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    surface.triangles.push_back({mesh.triangles[k], static_cast<std::int32_t>(k), {{{1, 0}, {0, 1}, {0, 0}}}});
  }
  return surface;
}

/// Every site of the mesh planned for one tool vertex.
inline bake::Plan ball_plan(const sites::HapticMesh& mesh) {
  bake::Plan plan;
  for (std::uint32_t k = 0; k < mesh.points.size(); ++k) {
    bake::PlanSite site;
    site.frame = {mesh.points[k], mesh.tangents[k], mesh.normals[k].cross(mesh.tangents[k]), mesh.normals[k]};
    site.depth = mesh.depth[k];
    site.area = 1e-4;
    plan.sites.push_back(site);
    plan.pairs.push_back({k, 0, 0, site.frame, site.depth});
  }
  plan.inputs.tools.push_back(hash128("tool"));
  return plan;
}

}  // namespace palpate::test
