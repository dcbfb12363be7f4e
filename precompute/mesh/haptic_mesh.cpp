// SPDX-License-Identifier: GPL-3.0-or-later
// Sites by surface adaptation, and the properties of the body at each.
#include "precompute/mesh/haptic_mesh.hpp"

#include "formats/error.hpp"
#include "precompute/mesh/adapt_surface.hpp"
#include "precompute/mesh/site_spacing.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace palpate {
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
  options.chord = 0.35;  // the spacing rules; the contact surface follows the shape
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
  return mesh;
}

}  // namespace palpate
