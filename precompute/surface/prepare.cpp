// SPDX-License-Identifier: GPL-3.0-or-later
// prepare_body: reads, joins and cleans the scene's surfaces, places inclusions and checks supports.
#include "formats/error.hpp"
#include "formats/surface_io.hpp"
#include "precompute/body.hpp"
#include "precompute/mesh/remesh.hpp"
#include "precompute/surface/clean.hpp"
#include "precompute/surface/examine.hpp"
#include "precompute/surface/kernel.hpp"
#include "precompute/surface/topology.hpp"
#include "precompute/surface/weld.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

namespace palpate {
namespace {

constexpr double base_triangles = 4000.0;  // of the body's coarse copy; inclusions get a quarter

[[noreturn]] void fail(const std::string& message) { throw Error(ExitCode::bad_input, message); }

std::string file_names(const std::vector<SurfaceSource>& sources) {
  std::set<std::string> names;
  for (const auto& source : sources) names.insert(source.file.string());
  return fmt::format("{}", fmt::join(names, " + "));
}

// Edge length at which equilateral triangles tile the area `count` times.
double edge_for(double area, double count) { return std::sqrt(area / count * 4.0 / std::sqrt(3.0)); }

// Coarse copy that has kept its shape: a thin margin that was folded is tried again with shorter edges.
Surface coarse_copy(const Surface& surface, double& edge, const std::string& name) {
  const double volume = signed_volume(surface);
  std::string cause;
  for (int attempt = 0; attempt < 4; ++attempt, edge *= 0.7) {
    auto base = remesh_uniform(surface, edge);
    const auto faults = examine(base);
    const double error = std::abs(faults.volume - volume) / volume;
    if (faults.clean() && error < 0.05) return base;
    cause = faults.clean() ? fmt::format("volume off by {:.1f} %", error * 100) : joined(faults.lines());
  }
  throw Error(ExitCode::numerical, name + ": no coarse copy of the surface keeps its shape: " + cause);
}

std::string list_of(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ", ")); }

std::vector<std::string> present_parts(const Surface& surface) {
  std::set<std::string> names;
  for (const auto part : surface.parts) names.insert(surface.part_names[std::size_t(part)]);
  return {names.begin(), names.end()};
}

SupportScene default_support(const Surface& surface) {
  double low = surface.vertices.front().z(), high = low;
  for (const auto& vertex : surface.vertices) {
    low = std::min(low, vertex.z());
    high = std::max(high, vertex.z());
  }
  SupportScene support;
  support.kind = SupportScene::Kind::half_space;
  support.point = {0, 0, low + 0.1 * (high - low)};
  support.normal = {0, 0, 1};
  return support;
}

bool holds(const Body& body, std::size_t k, const Eigen::Vector3d& point) {
  const auto& support = body.supports[k];
  switch (support.kind) {
    case SupportScene::Kind::mesh: {
      const auto& surface = body.query->surface();
      const auto part = surface.parts[std::size_t(body.query->closest(point).triangle)];
      return surface.part_names[std::size_t(part)] == support.mesh;
    }
    case SupportScene::Kind::box:
      return (point.array() >= support.box_min.array()).all() && (point.array() <= support.box_max.array()).all();
    case SupportScene::Kind::half_space:
      return (point - support.point).dot(support.normal) <= 0.0;
    case SupportScene::Kind::distance:
      return body.support_surfaces[k]->closest(point).distance <= support.within;
  }
  return false;
}

// Every support must hold some of the surface, and all together must leave some of it free.
void check_supports(const Body& body, const Scene& scene) {
  const auto& surface = body.query->surface();
  std::vector<bool> held(surface.triangles.size(), false);
  for (std::size_t k = 0; k < body.supports.size(); ++k) {
    const auto& support = body.supports[k];
    const auto where = fmt::format("{}: support {}", scene.file.string(), k + 1);
    if (support.kind == SupportScene::Kind::mesh) {
      const auto names = present_parts(surface);
      if (std::find(names.begin(), names.end(), support.mesh) == names.end()) {
        fail(where + ": the body has no part named '" + support.mesh + "'; there are: " + list_of(names));
      }
    }
    bool any = false;
    for (std::size_t t = 0; t < held.size(); ++t) {
      const auto& c = surface.triangles[t];
      const Eigen::Vector3d centre = (surface.vertices[std::size_t(c[0])] + surface.vertices[std::size_t(c[1])] +
                                      surface.vertices[std::size_t(c[2])]) /
                                     3.0;
      const bool here = holds(body, k, centre);
      any = any || here;
      held[t] = held[t] || here;
    }
    for (std::size_t v = 0; !any && v < surface.vertices.size(); ++v) any = holds(body, k, surface.vertices[v]);
    if (!any) {
      Eigen::AlignedBox3d box;
      for (const auto& vertex : surface.vertices) box.extend(vertex);
      fail(fmt::format(
          "{} holds no point of the body, which lies from ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) m",
          where, box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z()));
    }
  }
  if (std::all_of(held.begin(), held.end(), [](bool h) { return h; })) {
    fail(scene.file.string() + ": the supports hold the whole surface: nothing is left to touch");
  }
}

Inclusion make_inclusion(const RegionScene& region, const Body& body, double& edge) {
  const auto label = "region '" + region.name + "' (" + region.surface.file.string() + ")";
  const auto cleaned = clean_surface(read_surface(region.surface), {}, label);
  Inclusion inclusion;
  inclusion.name = region.name;
  inclusion.query = cleaned.query;
  inclusion.material = region.material;
  const auto& surface = inclusion.query->surface();
  const auto count = crossings(surface, body.query->surface());
  if (count > 0) fail(fmt::format("{}: it intersects the body's surface ({} pairs of triangles)", label, count));
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const double distance = body.query->signed_distance(surface.vertices[v]);
    if (!(distance < -1e-6 * body.diagonal)) {
      fail(fmt::format("{}: vertex {} is not strictly inside the body ({:.3g} mm {})", label, v,
                       std::abs(distance) * 1e3, distance > 0 ? "outside" : "from its surface"));
    }
  }
  for (const auto& other : body.inclusions) {
    if (crossings(surface, other.query->surface()) > 0) fail(label + ": it intersects region '" + other.name + "'");
    if (other.query->signed_distance(surface.vertices.front()) < 0.0 ||
        inclusion.query->signed_distance(other.query->surface().vertices.front()) < 0.0) {
      fail(label + ": it lies inside region '" + other.name + "' or around it; regions must be side by side");
    }
  }
  edge = std::min(edge_for(cleaned.report.area, base_triangles / 4), diagonal(surface) / 8.0);
  inclusion.base = coarse_copy(surface, edge, label);
  return inclusion;
}

// The coarse copies of neighbours may cross where the surfaces do not: shorter edges bring them apart.
void separate_bases(Body& body, const std::vector<double>& edges, const std::string& name) {
  for (int attempt = 0; attempt < 4; ++attempt) {
    std::vector<const Surface*> all = {&body.base};
    for (const auto& inclusion : body.inclusions) all.push_back(&inclusion.base);
    bool apart = true;
    for (std::size_t a = 0; apart && a < all.size(); ++a) {
      for (std::size_t b = a + 1; apart && b < all.size(); ++b) apart = crossings(*all[a], *all[b]) == 0;
    }
    if (apart) return;
    const double shorter = std::pow(0.7, attempt + 1);
    double edge = body.base_size * 0.7;
    body.base = coarse_copy(body.query->surface(), edge, name);
    body.base_size = edge;
    for (std::size_t i = 0; i < body.inclusions.size(); ++i) {
      double length = edges[i] * shorter;
      body.inclusions[i].base = coarse_copy(body.inclusions[i].query->surface(), length, body.inclusions[i].name);
    }
  }
  throw Error(ExitCode::numerical,
              name + ": a region lies too close to the body's surface or to another region to be meshed");
}

// What no tool can enter need not be open: crevices that a wrap follows in vain make bad meshes.
double wrap_alpha(const Scene& scene, double diagonal) {
  double radius = 0.0;
  for (const ToolScene& tool : scene.tools) {
    if (tool.shape == ToolScene::Shape::mesh) continue;
    radius = radius > 0 ? std::min(radius, tool.radius) : tool.radius;
  }
  return std::clamp(radius, diagonal / 50.0, diagonal / 20.0);
}

}  // namespace

bool Body::held(const Eigen::Vector3d& surface_point) const {
  for (std::size_t k = 0; k < supports.size(); ++k) {
    if (holds(*this, k, surface_point)) return true;
  }
  return false;
}

Body prepare_body(const Scene& scene) {
  if (scene.body.surfaces.empty()) fail(scene.file.string() + ": the body has no surface");
  const auto name = file_names(scene.body.surfaces);
  std::vector<Surface> surfaces;
  for (const auto& source : scene.body.surfaces) surfaces.push_back(read_surface(source));
  const Surface joint = join(surfaces);
  const double alpha = scene.body.wrap_alpha > 0 ? scene.body.wrap_alpha : wrap_alpha(scene, diagonal(joint));
  const auto cleaned = clean_surface(joint, {scene.body.repair, alpha, scene.body.wrap_offset}, name);

  Body body;
  body.query = cleaned.query;
  body.report = cleaned.report;
  body.material = scene.material;
  body.diagonal = diagonal(body.query->surface());
  body.base_size = std::min(body.diagonal / 25.0, edge_for(body.report.area, base_triangles));
  body.base = coarse_copy(body.query->surface(), body.base_size, name);

  std::vector<double> edges;
  for (const auto& region : scene.regions) {
    double edge = 0.0;
    body.inclusions.push_back(make_inclusion(region, body, edge));
    edges.push_back(edge);
  }
  separate_bases(body, edges, name);

  body.supports = scene.supports;
  if (body.supports.empty()) body.supports.push_back(default_support(body.query->surface()));
  for (const auto& support : body.supports) {
    const bool distance = support.kind == SupportScene::Kind::distance;
    body.support_surfaces.push_back(distance ? std::make_shared<const SurfaceQuery>(read_surface(support.other))
                                             : nullptr);
  }
  check_supports(body, scene);
  return body;
}

}  // namespace palpate
