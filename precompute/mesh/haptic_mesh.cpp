// SPDX-License-Identifier: GPL-3.0-or-later
// Sites by surface adaptation; the body's properties at a site; the subdivided contact surface.
#include "precompute/mesh/haptic_mesh.hpp"

#include "formats/error.hpp"
#include "precompute/mesh/adapt_surface.hpp"
#include "precompute/mesh/site_spacing.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <string>
#include <utility>

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr int kMostSubdivisions = 8;
constexpr double kChord = 0.02;    // of the depth
constexpr double kShallow = 0.05;  // share of the sites that may be shallower than the depth meant here: knife edges

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

// A point between sites, on the surface that faces the same way; the flat point where none is near.
Vector3d place(const Body& body, const Vector3d& flat, const Vector3d& normal, double reach) {
  const ClosestPoint on = body.query->closest(flat);
  if (on.distance <= reach && body.query->normal(on.point, 0.0).dot(normal) > 0) return on.point;
  // In a thin part the other wall may be nearer: look along the normal, out and in.
  const std::optional<double> out = body.query->ray(flat, normal, 0.0), in = body.query->ray(flat, -normal, 0.0);
  const double along_out = out.value_or(2 * reach), along_in = in.value_or(2 * reach);
  if (std::min(along_out, along_in) > reach) return flat;
  return along_out <= along_in ? Vector3d(flat + along_out * normal) : Vector3d(flat - along_in * normal);
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

bool touchable(const HapticMesh& mesh, std::int32_t site) { return mesh.selected[site] != 0 && mesh.held[site] == 0; }

// Largest distance that the middle of a fine triangle may have from the surface.
double chord_tolerance(const HapticMesh& mesh) {
  std::vector<double> depths;
  for (std::size_t site = 0; site < mesh.depth.size(); ++site) {
    if (touchable(mesh, static_cast<std::int32_t>(site))) depths.push_back(mesh.depth[site]);
  }
  if (depths.empty()) return std::numeric_limits<double>::infinity();
  std::sort(depths.begin(), depths.end());
  return kChord * depths[static_cast<std::size_t>(kShallow * static_cast<double>(depths.size()))];
}

// Subdivides every patch into k * k triangles with vertices on the surface.
void subdivide(const Body& body, int k, HapticMesh& mesh) {
  mesh.subdivision = k;
  mesh.fine_points = mesh.points;
  mesh.fine_triangles.clear();
  std::map<std::array<std::int32_t, 4>, std::int32_t> shared;  // low site, high site, step from low; or patch, i, j
  const auto vertex = [&](std::int32_t patch, int i, int j) {
    const auto& t = mesh.triangles[patch];
    const std::array<int, 3> weight{i, j, k - i - j};
    std::vector<std::pair<std::int32_t, int>> used;
    for (int c = 0; c < 3; ++c) {
      if (weight[c] > 0) used.emplace_back(t[c], weight[c]);
    }
    if (used.size() == 1) return used[0].first;
    std::sort(used.begin(), used.end());
    const std::array<std::int32_t, 4> key =
        used.size() == 2 ? std::array<std::int32_t, 4>{0, used[0].first, used[1].first, used[1].second}
                         : std::array<std::int32_t, 4>{1, patch, i, j};
    const auto [at, fresh] = shared.try_emplace(key, static_cast<std::int32_t>(mesh.fine_points.size()));
    if (fresh) {
      Vector3d flat = Vector3d::Zero(), normal = Vector3d::Zero();
      double reach = 0;
      for (const auto& [site, w] : used) {
        flat += static_cast<double>(w) / k * mesh.points[site];
        normal += static_cast<double>(w) / k * mesh.normals[site];
      }
      for (const auto& [site, w] : used) reach = std::max(reach, (mesh.points[site] - flat).norm());
      mesh.fine_points.push_back(place(body, flat, normal.normalized(), reach));
    }
    return at->second;
  };
  for (std::size_t p = 0; p < mesh.triangles.size(); ++p) {
    const auto patch = static_cast<std::int32_t>(p);
    const auto add = [&](std::array<std::array<int, 2>, 3> corners) {
      FineTriangle fine;
      fine.patch = patch;
      for (int c = 0; c < 3; ++c) {
        fine.vertices[c] = vertex(patch, corners[c][0], corners[c][1]);
        fine.grid[c] = {static_cast<std::uint16_t>(corners[c][0]), static_cast<std::uint16_t>(corners[c][1])};
      }
      mesh.fine_triangles.push_back(fine);
    };
    for (int i = 0; i < k; ++i) {
      for (int j = 0; j + i < k; ++j) {
        add({{{i + 1, j}, {i, j + 1}, {i, j}}});
        if (i + j + 2 <= k) add({{{i + 1, j}, {i + 1, j + 1}, {i, j + 1}}});
      }
    }
  }
  mesh.chordal_error = 0;
  for (const FineTriangle& t : mesh.fine_triangles) {
    const auto& patch = mesh.triangles[t.patch];
    if (std::none_of(patch.begin(), patch.end(), [&](std::int32_t site) { return touchable(mesh, site); })) continue;
    const Vector3d middle =
        (mesh.fine_points[t.vertices[0]] + mesh.fine_points[t.vertices[1]] + mesh.fine_points[t.vertices[2]]) / 3;
    mesh.chordal_error = std::max(mesh.chordal_error, body.query->closest(middle).distance);
  }
}

// The commonest cause of a spacing that does not suit a body.
std::string size_of(const Body& body) {
  char text[100];
  std::snprintf(text, sizeof text, "; the body measures %.3g m across: is body.units right?", body.diagonal);
  return text;
}

// Patches too wide for a body's folds may cross: then they are made smaller all over.
AdaptedSurface adapt_to_sites(const SamplingScene& sampling, const Body& body, AdaptOptions options) {
  for (int halvings = 0;; ++halvings) {
    try {
      return adapt_surface(body.base, *body.query, site_spacing(sampling, body), {}, options);
    } catch (const TooFine& error) {
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

}  // namespace

HapticMesh make_haptic_mesh(const Scene& scene, const Body& body) {
  check_place(body);
  const SamplingScene& sampling = scene.sampling;
  AdaptOptions options;
  options.rounds = 8;
  options.chord = 0.35;  // the spacing rules; the fine surface follows the shape
  const AdaptedSurface adapted = adapt_to_sites(sampling, body, options);
  HapticMesh mesh;
  mesh.triangles = adapted.surface.triangles;
  if (mesh.triangles.size() < 4) {
    throw Error(ExitCode::bad_input, "sampling.spacing " + std::to_string(sampling.spacing) +
                                         " m leaves fewer than four sites, allowed below " +
                                         std::to_string(body.diagonal / 3) + " m" + size_of(body));
  }
  for (const Vector3d& v : adapted.surface.vertices) {
    const Vector3d point = body.query->closest(v).point;
    const Vector3d normal = body.query->normal(point, sampling.spacing / 3);
    mesh.points.push_back(point);
    mesh.normals.push_back(normal);
    mesh.tangents.push_back(tangent_of(normal));
    mesh.thickness.push_back(body.query->thickness(point, normal));
    mesh.depth.push_back(
        std::min(sampling.depth, sampling.depth_fraction * room(body, point, normal, mesh.thickness.back())));
    mesh.held.push_back(body.held(point) ? 1 : 0);
    const auto& box = sampling.within_box;
    const bool inside =
        !box || ((point.array() >= box->first.array()).all() && (point.array() <= box->second.array()).all());
    mesh.selected.push_back(inside && !body.in_cavity(point) ? 1 : 0);
  }
  mesh.edges = edge_lengths(mesh);
  const double tolerance = chord_tolerance(mesh);
  for (int k = 1; k <= kMostSubdivisions; ++k) {
    subdivide(body, k, mesh);
    if (mesh.chordal_error <= tolerance) break;
  }
  return mesh;
}

}  // namespace palpate
