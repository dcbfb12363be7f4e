// SPDX-License-Identifier: GPL-3.0-or-later
// Sites by surface adaptation, and the properties of the body at each.
#include "precompute/sites/haptic_mesh.hpp"

#include "formats/io/error.hpp"
#include "precompute/mesh/surface/adapt_surface.hpp"
#include "precompute/sites/site_spacing.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

namespace palpate::sites {
namespace {

using Eigen::Vector3d;

Vector3d tangent_of(const Vector3d& normal) {
  // Close to the x axis its projection turns fast; y takes over there.
  const Vector3d axis = std::abs(normal.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
  return (axis - axis.dot(normal) * normal).normalized();
}

EdgeLengths edge_lengths(const HapticMesh& mesh) {
  std::vector<double> lengths;
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      // Either triangle of an edge sees it; one of them counts it.
      if (t[k] > t[(k + 1) % 3]) continue;
      lengths.push_back((mesh.points[t[k]] - mesh.points[t[(k + 1) % 3]]).norm());
      sum += lengths.back();
    }
  }
  std::sort(lengths.begin(), lengths.end());
  return {lengths.front(), lengths[lengths.size() / 2], sum / static_cast<double>(lengths.size()), lengths.back()};
}

// How far in there is something that a push could squeeze: the wall, and behind the wall of a cavity the cavity with
// it, which collapses until its walls meet.
double room(const Body& body, const Vector3d& point, const Vector3d& normal, double thickness) {
  const Vector3d behind = point - thickness * normal;
  if (!body.in_cavity(behind)) return thickness;
  const double skip = 1e-3 * thickness;
  const std::optional<double> near = body.query->ray(point, -normal, skip);
  if (!near || !body.in_cavity(point - *near * normal)) return thickness;
  const std::optional<double> far = body.query->ray(point, -normal, *near + skip);
  return std::max(thickness, far.value_or(thickness));
}

// The commonest cause of a spacing that does not suit a body.
std::string size_of(const Body& body) {
  char text[100];
  std::snprintf(text, sizeof text, "; the body measures %.3g m across: is body.units right?", body.diagonal);
  return text;
}

// sampling.sites on the body's surface.
std::vector<Vector3d> given_sites(const SamplingScene& sampling, const Body& body) {
  std::vector<Vector3d> on_surface;
  for (const Vector3d& site : sampling.sites) {
    const geometry::ClosestPoint on = body.query->closest(site);
    if (on.distance > sampling.depth) {
      char text[160];
      std::snprintf(
          text, sizeof text,
          "sampling.sites: (%g, %g, %g) m is %.3g mm away from the body's surface; allowed: the depth, %.3g mm",
          site.x(), site.y(), site.z(), 1e3 * on.distance, 1e3 * sampling.depth);
      throw Error(ExitCode::bad_input, text);
    }
    on_surface.push_back(on.point);
  }
  return on_surface;
}

// Patches too wide for a body's folds may cross: then they are made smaller all over.
mesh::AdaptedSurface adapt_to_sites(const SamplingScene& sampling, const Body& body, mesh::AdaptOptions options) {
  const std::vector<Vector3d> given = given_sites(sampling, body);
  for (int halvings = 0;; ++halvings) {
    try {
      return mesh::adapt_surface(body.base, *body.query, site_spacing(sampling, body), given, options);
    } catch (const mesh::TooFine& error) {
      throw Error(ExitCode::bad_input, "sampling.spacing " +
                                           std::to_string(options.largest > 0 ? options.largest : sampling.spacing) +
                                           " m: " + error.what() + "; try a larger one" + size_of(body));
    } catch (const Error& error) {
      if (error.code() != ExitCode::numerical) throw;
      if (halvings == 2) {
        throw Error(ExitCode::numerical, "sampling.spacing " + std::to_string(sampling.spacing) +
                                             " m and a quarter of it: " + error.what() + "; try a smaller one");
      }
    }
    options.largest = sampling.spacing / (2 << halvings);
  }
}

constexpr double kCoarsestStep = 1e-4;  // of the diagonal: below the facets of any surface

// A response file has places as 32-bit floats: far from the origin they are too coarse for the body.
void check_place(const Body& body) {
  double largest = 0;
  for (const Vector3d& v : body.query->surface().vertices) largest = std::max(largest, v.cwiseAbs().maxCoeff());
  const double step = largest * 0x1p-23;
  if (!(step > kCoarsestStep * body.diagonal)) return;
  char text[240];
  std::snprintf(
      text, sizeof text,
      "the body lies %.4g m from the origin, where a response file's places have steps of %.2g mm; allowed: at "
      "most %.3g m; move the surface",
      largest, 1e3 * step, kCoarsestStep * body.diagonal * 0x1p23);
  throw Error(ExitCode::bad_input, text);
}

// Appends a site at a point of the surface.
void add_site(const Scene& scene, const Body& body, const Vector3d& point, HapticMesh& mesh) {
  const SamplingScene& sampling = scene.sampling;
  const Vector3d normal = body.query->normal(point, normal_radius(scene));
  mesh.points.push_back(point);
  mesh.normals.push_back(normal);
  mesh.tangents.push_back(tangent_of(normal));
  mesh.thickness.push_back(body.query->thickness(point, normal));
  mesh.depth.push_back(
      std::min(sampling.depth, sampling.depth_fraction * room(body, point, normal, mesh.thickness.back())));
  mesh.held.push_back(body.held(point) ? 1 : 0);
  mesh.selected.push_back(within_box(scene, point) && !body.in_cavity(point) ? 1 : 0);
}

SiteEdge edge_of(const std::array<std::int32_t, 3>& patch, int k) {
  const std::int32_t a = patch[k], b = patch[(k + 1) % 3];
  return {std::min(a, b), std::max(a, b)};
}

// The edge of a patch that is longest; of equal ones the same from either side.
int longest_edge(const HapticMesh& mesh, const std::array<std::int32_t, 3>& patch) {
  const auto rank = [&](int k) {
    const SiteEdge e = edge_of(patch, k);
    return std::pair{(mesh.points[e[0]] - mesh.points[e[1]]).squaredNorm(), e};
  };
  int best = 0;
  for (int k = 1; k < 3; ++k) {
    if (rank(k) > rank(best)) best = k;
  }
  return best;
}

// The point of the body nearest to `flat` (m) on its own side of the body; `flat` itself where none is within `reach`.
Vector3d place(const Body& body, const Vector3d& flat, const Vector3d& normal, double reach) {
  const geometry::ClosestPoint on = body.query->closest(flat);
  if (on.distance <= reach && body.query->normal(on.point, 0.0).dot(normal) > 0) return on.point;
  // In a thin part the other wall may be nearer: look along the normal, out and in.
  const std::optional<double> out = body.query->ray(flat, normal, 0.0), in = body.query->ray(flat, -normal, 0.0);
  const double along_out = out.value_or(2 * reach), along_in = in.value_or(2 * reach);
  if (std::min(along_out, along_in) > reach) return flat;
  return along_out <= along_in ? Vector3d(flat + along_out * normal) : Vector3d(flat - along_in * normal);
}

// A patch with sites on some of its edges (-1: none), the longest among them where there are any, in two to four.
void split_patch(const HapticMesh& mesh, const std::array<std::int32_t, 3>& patch,
                 const std::map<SiteEdge, std::int32_t>& middles, std::vector<std::array<std::int32_t, 3>>& out) {
  const auto middle = [&](int k) {
    const auto at = middles.find(edge_of(patch, k));
    return at == middles.end() ? -1 : at->second;
  };
  const int longest = longest_edge(mesh, patch);
  const std::int32_t m = middle(longest);
  if (m < 0) return out.push_back(patch);
  const std::int32_t a = patch[longest], b = patch[(longest + 1) % 3], c = patch[(longest + 2) % 3];
  const std::int32_t on_bc = middle((longest + 1) % 3), on_ca = middle((longest + 2) % 3);
  if (on_ca < 0) {
    out.push_back({a, m, c});
  } else {
    out.push_back({a, m, on_ca});
    out.push_back({on_ca, m, c});
  }
  if (on_bc < 0) {
    out.push_back({m, b, c});
  } else {
    out.push_back({m, b, on_bc});
    out.push_back({m, on_bc, c});
  }
}

}  // namespace

bool within_box(const Scene& scene, const Vector3d& point) {
  const auto& box = scene.sampling.within_box;
  return !box || ((point.array() >= box->first.array()).all() && (point.array() <= box->second.array()).all());
}

double normal_radius(const Scene& scene) {
  double radius = scene.sampling.spacing / 3;
  for (const ToolScene& tool : scene.tools) {
    if (tool.shape != ToolScene::Shape::mesh) radius = std::min(radius, tool.radius);
  }
  return radius;
}

HapticMesh make_haptic_mesh(const Scene& scene, const Body& body) {
  check_place(body);
  const SamplingScene& sampling = scene.sampling;
  mesh::AdaptOptions options;
  options.rounds = 8;
  options.chord = 0.35;  // the spacing rules; the contact surface follows the shape
  const mesh::AdaptedSurface adapted = adapt_to_sites(sampling, body, options);
  HapticMesh mesh;
  mesh.triangles = adapted.surface.triangles;
  if (mesh.triangles.size() < 4) {
    throw Error(ExitCode::bad_input, "sampling.spacing " + std::to_string(sampling.spacing) +
                                         " m leaves fewer than four sites, allowed below " +
                                         std::to_string(body.diagonal / 3) + " m" + size_of(body));
  }
  for (const Vector3d& v : adapted.surface.vertices) add_site(scene, body, body.query->closest(v).point, mesh);
  for (const std::int32_t site : adapted.anchors) {
    mesh.depth[std::size_t(site)] = sampling.depth;
    mesh.selected[std::size_t(site)] = body.in_cavity(mesh.points[std::size_t(site)]) ? 0 : 1;
  }
  mesh.edges = edge_lengths(mesh);
  return mesh;
}

void split_edges(const Scene& scene, const Body& body, const std::vector<SiteEdge>& edges, HapticMesh& mesh) {
  std::map<SiteEdge, std::int32_t> middles;
  for (const SiteEdge& edge : edges) middles.emplace(edge, -1);
  for (bool grown = true; grown;) {
    grown = false;
    for (const auto& patch : mesh.triangles) {
      if (middles.count(edge_of(patch, 0)) + middles.count(edge_of(patch, 1)) + middles.count(edge_of(patch, 2)) == 0) {
        continue;
      }
      grown = middles.emplace(edge_of(patch, longest_edge(mesh, patch)), -1).second || grown;
    }
  }
  for (auto& [edge, site] : middles) {
    const Vector3d flat = 0.5 * (mesh.points[edge[0]] + mesh.points[edge[1]]);
    const Vector3d normal = (mesh.normals[edge[0]] + mesh.normals[edge[1]]).normalized();
    const double reach = 0.5 * (mesh.points[edge[0]] - mesh.points[edge[1]]).norm();
    site = static_cast<std::int32_t>(mesh.points.size());
    add_site(scene, body, body.query->closest(place(body, flat, normal, reach)).point, mesh);
    mesh.split.emplace(site, edge);
  }
  std::vector<std::array<std::int32_t, 3>> patches;
  for (const auto& patch : mesh.triangles) split_patch(mesh, patch, middles, patches);
  mesh.triangles = std::move(patches);
  mesh.edges = edge_lengths(mesh);
}

}  // namespace palpate::sites
