// SPDX-License-Identifier: GPL-3.0-or-later
// Vertices of an even remeshing, each with the profile that a flat body would meet there; sharp edges.
#include "precompute/tool/mesh_tool.hpp"

#include "formats/io/error.hpp"
#include "formats/surface/surface_io.hpp"
#include "precompute/geometry/topology.hpp"
#include "precompute/mesh/surface/remesh.hpp"
#include "precompute/tool/mesh_shape.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

namespace palpate::tool {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

constexpr double kRounding = 1.0 / 20;  // of the smallest extent: a tenth of a ball's radius, as of a punch's
constexpr double kEdgeSize = 0.8;       // elements at an edge over its radius: those of a punch's rim
constexpr double kSharp = geometry::kFeatureAngle * kPi / 180;  // rad: edges beyond have no radius but the rounding's
constexpr double kSmooth = 0.15;                      // rad: edges below are facets of something round
constexpr double kSmallRadius = 0.25;  // of the smallest extent: rounder places need no elements of their own

void check_closed(const Surface& surface, const Tool& tool) {
  const geometry::Topology found = geometry::topology(surface);
  const auto fail = [&](const std::string& what) {
    throw Error(ExitCode::bad_input, tool.scene.surface.file.string() + ": tool '" + tool.name + "': " + what);
  };
  if (!found.closed_manifold()) {
    fail("the mesh is not closed and manifold (" + std::to_string(found.boundary_edges) + " open edges, " +
         std::to_string(found.nonmanifold_edges) + " of more than two triangles, " +
         std::to_string(found.flipped_edges) + " between triangles that face opposite ways, " +
         std::to_string(found.degenerate + found.duplicates) + " triangles without area or doubled)");
  }
  if (!(geometry::signed_volume(surface) > 0)) fail("its triangles face inward");
}

// Onto the smoothed surface, along its gradient.
Vector3d on_surface(const MeshShape& shape, Vector3d point) {
  for (int k = 0; k < 20; ++k) {
    const DistanceSample s = shape.distance(point);
    point -= s.value * s.gradient / std::max(s.gradient.squaredNorm(), 0.1);
  }
  return point;
}

// Half the least width of the tool at heights above the plane that touches it in `v`, seen along its normal.
std::vector<ToolVertex::Width> profile_at(const MeshShape& shape, const ToolVertex& v, double rounding) {
  constexpr int kAxes = 8;
  constexpr double kGrow = 1.2;
  const double size = shape.bounds().diagonal().norm();
  const Vector3d across = v.normal.cross(v.tangent);
  std::vector<ToolVertex::Width> profile;
  for (double height = 0.02 * rounding; height < size; height *= kGrow * kGrow) profile.push_back({size, height});
  for (int axis = 0; axis < kAxes; ++axis) {
    std::vector<double> width(profile.size(), 0.0);
    for (const double side : {1.0, -1.0}) {
      const double angle = kPi * axis / kAxes;
      const Vector3d along = side * (std::cos(angle) * v.tangent + std::sin(angle) * across);
      double last_width = 0, last_height = 0;
      std::size_t level = 0;
      for (double r = rounding / 4; level < profile.size(); r *= kGrow) {
        const auto hit = shape.query().ray(v.point + r * along + size * v.normal, -v.normal, 0.0);
        const double height = hit ? std::max(*hit - size, 0.0) : 2 * size;
        for (; level < profile.size() && profile[level].height <= height; ++level) {
          // Past the rim there is nothing to meet: the width ends between the two places.
          const double t = hit ? (profile[level].height - last_height) / (height - last_height) : 0.5;
          width[level] += (last_width + t * (r - last_width)) / 2;
        }
        last_width = r;
        last_height = std::max(height, last_height);
      }
    }
    for (std::size_t k = 0; k < profile.size(); ++k) profile[k].half = std::min(profile[k].half, width[k]);
  }
  return profile;
}

void set_sharpness(const MeshShape& shape, double rounding, ToolVertex& v) {
  v.profile = profile_at(shape, v, rounding);
  const auto wide =
      std::find_if(v.profile.begin(), v.profile.end(), [&](const auto& w) { return w.half >= 2 * rounding; });
  const double largest = shape.bounds().diagonal().norm() / 2;
  v.curvature_radius = largest;
  if (wide == v.profile.begin()) v.flat_radius = wide->half;  // a fiftieth of the rounding high, and wide already
  if (wide != v.profile.end() && v.flat_radius == 0) {
    v.curvature_radius = std::clamp(wide->half * wide->half / (2 * wide->height), rounding, largest);
  }
  v.edge_radius = rounding;
}

// Convex edges that are sharp, or whose facets follow a small radius.
void add_edges(Tool& tool, const Surface& surface, double rounding, double extent) {
  const auto middle = [&](std::size_t t) {
    Vector3d m = Vector3d::Zero();
    for (const auto c : surface.triangles[t]) m += surface.vertices[std::size_t(c)] / 3;
    return m;
  };
  geometry::for_each_edge(geometry::sorted_sides(surface), [&](auto edge) {
    const Vector3d &a = surface.vertices[std::size_t(edge[0].low)], &b = surface.vertices[std::size_t(edge[0].high)];
    const Vector3d n = geometry::triangle_normal(surface, std::size_t(edge[0].triangle)),
                   m = geometry::triangle_normal(surface, std::size_t(edge[1].triangle));
    const double turn = std::atan2(n.cross(m).norm(), n.dot(m)), length = (b - a).norm();
    if (turn < kSmooth || n.dot(middle(std::size_t(edge[1].triangle)) - a) > 0) return;  // smooth, or hollow
    const double radius = turn > kSharp ? rounding : std::max(rounding, std::min(n.norm(), m.norm()) / length / turn);
    if (radius > kSmallRadius * extent) return;
    const double size = kEdgeSize * radius;
    const int count = std::max(1, static_cast<int>(std::ceil(length / size)));
    for (int k = 0; k < count; ++k) tool.edges.push_back({a + (k + 0.5) / count * (b - a), size});
  });
}

}  // namespace

void add_mesh(Tool& tool) {
  const Surface surface = read_surface(tool.scene.surface);
  check_closed(surface, tool);
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : surface.vertices) box.extend(v);
  if (tool.scene.edge_radius <= 0) tool.scene.edge_radius = kRounding * box.sizes().minCoeff();
  const double rounding = tool.scene.edge_radius;
  if (const double most = box.sizes().minCoeff() / 2; rounding > most) {
    throw Error(ExitCode::bad_input, tool.scene.surface.file.string() + ": tool '" + tool.scene.name +
                                         "': edge_radius = " + std::to_string(rounding) +
                                         " m; allowed up to half its smallest extent, " + std::to_string(most) + " m");
  }
  const auto shape = std::make_shared<const MeshShape>(surface, rounding);
  tool.shape = shape;
  const double spacing = tool.scene.spacing > 0 ? tool.scene.spacing : box.sizes().maxCoeff() / 3;
  const Surface coarse = mesh::remesh_uniform(surface, spacing);
  for (const Vector3d& point : coarse.vertices) {
    ToolVertex& v = tool.vertices.emplace_back(mesh_vertex(tool, point));
    v.name = std::string("v").append(std::to_string(tool.vertices.size() - 1));
  }
  tool.patches = coarse.triangles;
  add_edges(tool, surface, rounding, box.sizes().minCoeff());
}

ToolVertex mesh_vertex(const Tool& tool, const Vector3d& near) {
  const auto& shape = static_cast<const MeshShape&>(*tool.shape);  // of every mesh tool
  ToolVertex v;
  v.point = on_surface(shape, near);
  v.normal = shape.distance(v.point).normal();
  v.tangent = Vector3d::UnitZ() - v.normal.z() * v.normal;
  if (v.tangent.norm() < 1e-6) v.tangent = Vector3d::UnitX() - v.normal.x() * v.normal;
  v.tangent.normalize();
  set_sharpness(shape, tool.scene.edge_radius, v);
  return v;
}

}  // namespace palpate::tool
