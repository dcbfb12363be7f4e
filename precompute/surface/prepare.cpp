// SPDX-License-Identifier: GPL-3.0-or-later
// prepare_body: reads, joins and cleans the scene's surfaces, places inclusions and supports.
#include "formats/io/error.hpp"
#include "formats/surface/surface_io.hpp"
#include "precompute/common/body.hpp"
#include "precompute/geometry/intersections.hpp"
#include "precompute/geometry/topology.hpp"
#include "precompute/mesh/surface/remesh.hpp"
#include "precompute/surface/repair/cavities.hpp"
#include "precompute/surface/repair/clean.hpp"
#include "precompute/surface/repair/examine.hpp"
#include "precompute/surface/repair/report.hpp"
#include "precompute/surface/repair/weld.hpp"
#include "precompute/surface/sources.hpp"
#include "precompute/surface/support_rim.hpp"
#include "precompute/surface/supports.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

namespace palpate::surface {
namespace {

constexpr double base_triangles = 4000.0;  // of the body's coarse copy; inclusions get a quarter

[[noreturn]] void fail(const std::string& message) { throw Error(ExitCode::bad_input, message); }

std::string file_names(const BodyScene& body) {
  std::set<std::string> names;
  for (const auto& source : body.surfaces) names.insert(source.file.string());
  if (!body.labels.file.empty()) names.insert(body.labels.file.string());
  if (names.empty()) return "the body";
  return fmt::format("{}", fmt::join(names, " + "));
}

// Edge length at which equilateral triangles tile the area `count` times.
double edge_for(double area, double count) { return std::sqrt(area / count * 4.0 / std::sqrt(3.0)); }

// Coarse copy that has kept its shape: a thin margin that was folded is tried again with shorter edges. That it
// does not cross itself is what remesh_uniform sees to.
Surface coarse_copy(const Surface& surface, double& edge, const std::string& name) {
  const double volume = geometry::signed_volume(surface);
  std::string cause;
  for (int attempt = 0; attempt < 4; ++attempt, edge *= 0.7) {
    auto base = mesh::remesh_uniform(surface, edge);
    const SurfaceFaults faults{geometry::topology(base), 0, geometry::signed_volume(base)};
    const double error = std::abs(faults.volume - volume) / volume;
    if (faults.clean() && error < 0.05) return base;
    cause = faults.clean() ? fmt::format("volume off by {:.1f} %", error * 100) : joined(faults.lines());
  }
  throw Error(ExitCode::numerical, name + ": no coarse copy of the surface keeps its shape: " + cause);
}

// Null where the fibres have one direction, or there are none.
std::shared_ptr<const geometry::CurveQuery> fibres_of(const MaterialScene& material, const Surface& around) {
  if (material.centreline.file.empty()) return nullptr;
  const Curves curves = read_curves(material.centreline);
  Eigen::AlignedBox3d box, lines;
  for (const auto& v : around.vertices) box.extend(v);
  for (const auto& p : curves.points) lines.extend(p);
  const double size = box.diagonal().norm(), length = lines.diagonal().norm();
  if (lines.exteriorDistance(box) > size || length < 0.02 * size || length > 50 * size) {
    fail(fmt::format("{}: its curves, {:.3g} m in all, do not fit what they run in, {:.3g} m; is 'units' right?",
                     material.centreline.file.string(), length, size));
  }
  return std::make_shared<const geometry::CurveQuery>(curves);
}

Inclusion make_inclusion(const RegionScene& region, const Body& body, SceneSurfaces& files, double& edge) {
  const std::string path = region.surface.file.empty() ? region.labels.file.string() : region.surface.file.string();
  const auto label = "region '" + region.name + "'" + (path.empty() ? path : " (" + path + ")");
  const Surface given = files.region(region);
  const auto cleaned = clean_surface(given, {}, label);
  // A wrap of a shell that is open goes round it inside, too: a hollow region where a solid one is meant.
  if (cleaned.report.action == "wrapped" && geometry::topology(given).boundary_edges > 0) {
    fail(
        fmt::format("{}: its surface is open, and no repair closes it ({}); close its holes in the file, or give the "
                    "region by its measures",
                    label, joined(cleaned.report.findings)));
  }
  Inclusion inclusion;
  inclusion.report = cleaned.report;
  inclusion.report.findings.insert(inclusion.report.findings.begin(), given.notes.begin(), given.notes.end());
  inclusion.name = region.name;
  inclusion.query = cleaned.query;
  inclusion.material = region.material;
  inclusion.fibres = fibres_of(region.material, inclusion.query->surface());
  const auto& surface = inclusion.query->surface();
  const auto count = geometry::crossings(surface, body.query->surface());
  if (count > 0) fail(fmt::format("{}: it intersects the body's surface ({} pairs of triangles)", label, count));
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const double distance = body.query->signed_distance(surface.vertices[v]);
    if (!(distance < -1e-6 * body.diagonal)) {
      fail(fmt::format("{}: vertex {} is not strictly inside the body ({:.3g} mm {})", label, v,
                       std::abs(distance) * 1e3, distance > 0 ? "outside" : "from its surface"));
    }
  }
  for (const auto& other : body.inclusions) {
    if (geometry::surfaces_intersect(surface, other.query->surface()))
      fail(label + ": it intersects region '" + other.name + "'");
    if (other.query->signed_distance(surface.vertices.front()) < 0.0 ||
        inclusion.query->signed_distance(other.query->surface().vertices.front()) < 0.0) {
      fail(label + ": it lies inside region '" + other.name + "' or around it; regions must be side by side");
    }
  }
  edge = std::min(edge_for(cleaned.report.area, base_triangles / 4), geometry::diagonal(surface) / 8.0);
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
      for (std::size_t b = a + 1; apart && b < all.size(); ++b) apart = !geometry::surfaces_intersect(*all[a], *all[b]);
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

// m; 0 where every tool is a mesh.
double smallest_tip(const Scene& scene) {
  double radius = 0.0;
  for (const ToolScene& tool : scene.tools) {
    if (tool.shape == ToolScene::Shape::mesh) continue;
    radius = radius > 0 ? std::min(radius, tool.radius) : tool.radius;
  }
  return radius;
}

// Alpha of the wrap. It closes crevices that no tool can enter, because they make bad meshes.
double wrap_alpha(const Scene& scene, double diagonal) {
  return std::clamp(smallest_tip(scene), diagonal / 50.0, diagonal / 20.0);
}

// Facets this share of the tip's radius below the round surface make a shallow touch an accident of where it falls.
constexpr double kFeltFacet = 0.02;

void warn_of_facets(const Scene& scene, SurfaceReport& report) {
  const double tip = smallest_tip(scene);
  if (tip > 0 && scene.body.smooth == 0 && report.facet_depth > kFeltFacet * tip) {
    report.findings.push_back(
        fmt::format("facets {:.3g} mm deep on average: a tip of {:.3g} mm feels them; smooth = 2 "
                    "in [body] rounds them off",
                    1e3 * report.facet_depth, 1e3 * tip));
  }
}

constexpr double kSmallestBody = 1e-3, kLargestBody = 10.0;  // m, of the diagonal: beyond them hardly an organ

void warn_of_size(double diagonal, SurfaceReport& report) {
  if (diagonal >= kSmallestBody && diagonal <= kLargestBody) return;
  report.findings.push_back(fmt::format("the body measures {:.3g} m across: is body.units right?", diagonal));
}

}  // namespace

namespace {

// The walls of the scene's cavities, inward, as parts of the body's surface.
Surface with_cavities(const Scene& scene, const Surface& solid, SceneSurfaces& files, const std::string& name) {
  if (scene.cavities.empty()) return solid;
  const geometry::SurfaceQuery query(solid);
  const double margin = 1e-6 * geometry::diagonal(solid);
  std::vector<Surface> all{solid};
  for (const CavityScene& cavity : scene.cavities) {
    const auto label = "cavity '" + cavity.name + "' of " + name;
    Surface wall = clean_surface(files.cavity(cavity), {}, label).query->surface();
    for (const auto& v : wall.vertices) {
      const double distance = query.signed_distance(v);
      if (distance < -margin) continue;
      fail(fmt::format("{}: ({:.4g}, {:.4g}, {:.4g}) m is not strictly inside the body ({:.3g} mm {})", label, v.x(),
                       v.y(), v.z(), std::abs(distance) * 1e3, distance > 0 ? "outside" : "from its surface"));
    }
    for (std::size_t k = 1; k < all.size(); ++k) {
      if (geometry::surfaces_intersect(wall, all[k])) fail(label + ": it intersects another cavity");
    }
    for (auto& t : wall.triangles) std::swap(t[1], t[2]);
    all.push_back(std::move(wall));
  }
  return join(all);
}

Body prepare(const Scene& scene, const Surface& surface, SceneSurfaces& files) {
  const auto name = file_names(scene.body);
  const double alpha =
      scene.body.wrap_alpha > 0 ? scene.body.wrap_alpha : wrap_alpha(scene, geometry::diagonal(surface));
  auto cleaned = clean_surface(surface, {scene.body.repair, alpha, scene.body.wrap_offset, scene.body.smooth}, name);
  if (!scene.cavities.empty()) {
    cleaned.query =
        std::make_shared<const geometry::SurfaceQuery>(with_cavities(scene, cleaned.query->surface(), files, name));
    measure(*cleaned.query, cleaned.report);
  }
  cleaned.report.findings.insert(cleaned.report.findings.begin(), surface.notes.begin(), surface.notes.end());

  Body body;
  body.query = cleaned.query;
  body.report = cleaned.report;
  warn_of_facets(scene, body.report);
  body.material = scene.material;
  body.fibres = fibres_of(scene.material, body.query->surface());
  body.capsule_thickness = scene.body.capsule_thickness;
  body.capsule_young = scene.body.capsule_young;
  body.diagonal = geometry::diagonal(body.query->surface());
  warn_of_size(body.diagonal, body.report);
  body.prestress = scene.prestress;
  body.cavity = cavity_triangles(body.query->surface());
  body.base_size = std::min(body.diagonal / 25.0, edge_for(body.report.area, base_triangles));
  body.base = coarse_copy(body.query->surface(), body.base_size, name);

  std::vector<double> edges;
  for (const auto& region : scene.regions) {
    double edge = 0.0;
    body.inclusions.push_back(make_inclusion(region, body, files, edge));
    edges.push_back(edge);
  }
  separate_bases(body, edges, name);

  body.supports = scene.supports;
  if (body.supports.empty()) body.supports.push_back(default_support(body.query->surface()));
  for (const auto& support : body.supports) {
    const bool distance = support.kind == SupportScene::Kind::distance;
    body.support_surfaces.push_back(
        distance ? std::make_shared<const geometry::SurfaceQuery>(files.other(support.other)) : nullptr);
  }
  check_supports(body, scene);
  body.support_rim = support_rim(body);
  return body;
}

}  // namespace
}  // namespace palpate::surface

namespace palpate {

Body prepare_body(const Scene& scene) {
  surface::SceneSurfaces files(scene);
  const Surface surface = files.body();
  return surface::prepare(scene, surface, files);
}

Body prepare_body(const Scene& scene, const Surface& surface) {
  surface::SceneSurfaces files(scene);
  return surface::prepare(scene, surface, files);
}

}  // namespace palpate
