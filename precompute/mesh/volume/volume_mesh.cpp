// SPDX-License-Identifier: GPL-3.0-or-later
// The ladder of meshing attempts: adapted surfaces and TetGen first, other sizes, then CGAL Mesh_3.
#include "precompute/mesh/volume/volume_mesh.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/intersections.hpp"
#include "precompute/geometry/topology.hpp"
#include "precompute/mesh/surface/adapt_surface.hpp"
#include "precompute/mesh/surface/balance_facets.hpp"
#include "precompute/mesh/volume/interior_points.hpp"
#include "precompute/mesh/volume/mesh3.hpp"
#include "precompute/mesh/volume/quadratic.hpp"
#include "precompute/mesh/volume/tet_checks.hpp"
#include "precompute/mesh/volume/tetgen_client.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;
using Backend = VolumeMeshOptions::Backend;

// One rung: the adaptation of the surfaces and the options of TetGen.
struct Rung {
  double scale;         // of every size
  double cap;           // longest edge over the body's diagonal
  bool bound_dihedral;  // TetGen's second -q bound
};

constexpr Rung kRungs[] = {
    {1.0, 1.0, true}, {1.0, 1.0, false}, {0.93, 1.0, true}, {0.9, 0.06, true}, {0.8, 0.04, true}};

// An inclusion's stiffness goes with its volume, so it is followed closer than the body.
constexpr double kInclusionChord = 0.05;

struct AdaptedBody {
  Surface outer;
  std::vector<Surface> inner;
};

// A surface of the size field, its facets round `original` instead of inside it.
Surface facets_of(const Surface& base, const geometry::SurfaceQuery& original, const SizeField& size,
                  const std::vector<Vector3d>& anchors, const AdaptOptions& options) {
  const AdaptedSurface adapted = adapt_surface(base, original, size, anchors, options);
  return balance_facets(adapted.surface, original, adapted.anchors);
}

AdaptedBody adapt_body(const Body& body, const SizeField& size, const std::vector<Vector3d>& anchors, double largest) {
  AdaptedBody adapted;
  double cap = largest;
  for (int attempt = 0; attempt < 4; ++attempt, cap /= 2) {
    AdaptOptions options;
    options.largest = cap;
    adapted.outer = facets_of(body.base, *body.query, size, anchors, options);
    adapted.inner.clear();
    options.chord = kInclusionChord;
    bool apart = true;
    for (const Inclusion& inclusion : body.inclusions) {
      adapted.inner.push_back(facets_of(inclusion.base, *inclusion.query, size, {}, options));
      apart = apart && !geometry::surfaces_intersect(adapted.inner.back(), adapted.outer);
      for (std::size_t k = 0; k + 1 < adapted.inner.size(); ++k) {
        apart = apart && !geometry::surfaces_intersect(adapted.inner.back(), adapted.inner[k]);
      }
    }
    if (apart) return adapted;
  }
  throw Error(ExitCode::numerical, "surfaces of body and inclusions cross at every size tried");
}

// s of processor time.
double attempt_limit(const VolumeMeshOptions& options) {
  if (options.deadline == nullptr) return options.time_limit;
  return std::clamp(options.deadline->left(), 0.0, options.time_limit);
}

// `size`, which all surfaces and points are made by, throwing once the time is up. Its clock is read at every so many
// calls, because reading it takes as long as a size.
SizeField until(Deadline& deadline, const SizeField& size) {
  constexpr unsigned kCalls = 64;
  return [&deadline, &size, calls = 0U](const Vector3d& p) mutable {
    if (++calls % kCalls == 0) deadline.check();
    return size(p);
  };
}

MesherAnswer mesh_by_tetgen(const AdaptedBody& adapted, const SizeField& size, const VolumeMeshOptions& options,
                            bool bound_dihedral) {
  TetgenInput input;
  SurfaceTriangles outer;
  std::vector<SurfaceTriangles> inner;
  const auto add = [&](const Surface& s) {
    const auto first = static_cast<std::int32_t>(input.vertices.size());
    SurfaceTriangles triangles;
    input.vertices.insert(input.vertices.end(), s.vertices.begin(), s.vertices.end());
    for (const auto& t : s.triangles) triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    input.facets.insert(input.facets.end(), triangles.begin(), triangles.end());
    return triangles;
  };
  outer = add(adapted.outer);
  for (const Surface& s : adapted.inner) inner.push_back(add(s));
  std::vector<const Surface*> surfaces{&adapted.outer};
  for (const Surface& s : adapted.inner) surfaces.push_back(&s);
  // TetGen interpolates sizes between surfaces. Without points inside, tetrahedra under a contact are several times as
  // large as the field says: a force is 2 to 5 % too large where the contact's radius is 1/130 of the thickness.
  const std::vector<Vector3d> interior = interior_points(surfaces, size);
  input.vertices.insert(input.vertices.end(), interior.begin(), interior.end());
  for (const Vector3d& v : input.vertices) input.sizes.push_back(size(v));

  char switches[64];
  if (bound_dihedral) {
    std::snprintf(switches, sizeof switches, "pq%.3g/%.3gmYAQ", options.radius_edge, options.min_dihedral);
  } else {
    std::snprintf(switches, sizeof switches, "pq%.3gmYAQ", std::max(options.radius_edge, 1.4));
  }
  input.switches = switches;
  MesherAnswer answer = run_tetgen(input, attempt_limit(options));
  if (options.deadline != nullptr) options.deadline->spend(answer.helper_seconds);
  if (answer.cause.empty()) answer.cause = orient_tets(answer.tets);
  if (answer.cause.empty()) answer.cause = find_regions(answer.tets, outer, inner);
  return answer;
}

// The cause when a volume is too far from that of the surface that it should fill. Facets of Mesh_3, and those of
// TetGen that could not be balanced, cut off 5 to 10 % of a round body and a quarter of a small inclusion: the limits
// are for meshes that lost a part.
std::string judge_volume(const std::string& what, double volume, const Surface& surface, double accepted) {
  const double error = volume / geometry::signed_volume(surface) - 1;
  if (std::abs(error) <= accepted) return {};
  char text[96];
  std::snprintf(text, sizeof text, ": volume off by %.1f %%, allowed %.1f %%", 100 * error, 100 * accepted);
  return what + text;
}

std::string judge_anchors(const std::vector<Vector3d>& anchors, const TetMesh& mesh) {
  for (const Vector3d& anchor : anchors) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::int32_t v = 0; v < mesh.corner_count; ++v) nearest = std::min(nearest, (mesh.nodes[v] - anchor).norm());
    if (nearest > 1e-6) {
      char text[96];
      std::snprintf(text, sizeof text, "nearest node to an anchor is %.3g m away, allowed 1e-06", nearest);
      return text;
    }
  }
  return {};
}

// Judges tetrahedra; fills `result` when they are good enough, else gives the cause.
std::string judge(const Body& body, const std::vector<Vector3d>& anchors, const VolumeMeshOptions& options,
                  const LinearTets& tets, VolumeMeshResult& result) {
  MeshQuality quality;
  quality.min_dihedral = min_dihedral(tets);
  if (quality.min_dihedral < options.accept_dihedral) {
    char text[96];
    std::snprintf(text, sizeof text, "smallest dihedral angle %.2f degrees, allowed %.2f", quality.min_dihedral,
                  options.accept_dihedral);
    return text;
  }
  const std::vector<double> volumes = region_volumes(tets, body.inclusions.size());
  for (std::size_t k = 0; k < volumes.size(); ++k) {
    if (!(volumes[k] > 0)) return "region " + std::to_string(k) + " has no tetrahedra";
    quality.volume += volumes[k];
  }
  quality.volume_error = quality.volume / geometry::signed_volume(body.query->surface()) - 1;
  std::string cause = judge_volume("the body", quality.volume, body.query->surface(), options.accept_volume);
  for (std::size_t k = 0; k < body.inclusions.size() && cause.empty(); ++k) {
    const Inclusion& inclusion = body.inclusions[k];
    cause = judge_volume("region '" + inclusion.name + "'", volumes[k + 1], inclusion.query->surface(),
                         options.accept_inclusion);
  }
  if (!cause.empty()) return cause;
  TetMesh mesh = make_quadratic(tets);
  cause = judge_anchors(anchors, mesh);
  if (!cause.empty()) return cause;
  result.usable = true;
  result.cause.clear();
  result.mesh = std::move(mesh);
  result.quality = quality;
  return {};
}

void add_cause(std::string& causes, const std::string& cause) {
  if (causes.find(cause) != std::string::npos) return;
  causes += (causes.empty() ? "" : "; ") + cause;
}

void try_tetgen(const Body& body, const SizeField& size, const std::vector<Vector3d>& anchors,
                const VolumeMeshOptions& options, VolumeMeshResult& result) {
  AdaptedBody adapted;
  const Rung* last = nullptr;
  bool surfaces_fit = false;
  for (const Rung& rung : kRungs) {
    const SizeField scaled = [&](const Vector3d& p) { return rung.scale * size(p); };
    if (last == nullptr || last->scale != rung.scale || last->cap != rung.cap) {
      surfaces_fit = false;
      try {
        adapted = adapt_body(body, scaled, anchors, rung.cap * body.diagonal);
        surfaces_fit = true;
      } catch (const Error& error) {
        if (error.code() != ExitCode::numerical) throw;
        add_cause(result.cause, error.what());
      }
    }
    last = &rung;
    if (options.deadline != nullptr && options.deadline->passed()) break;
    if (!surfaces_fit) continue;
    MesherAnswer answer = mesh_by_tetgen(adapted, scaled, options, rung.bound_dihedral);
    if (answer.cause.empty()) answer.cause = judge(body, anchors, options, answer.tets, result);
    if (result.usable) {
      result.backend = "tetgen";
      return;
    }
    add_cause(result.cause, answer.cause);
  }
}

}  // namespace

VolumeMeshResult mesh_volume(const Body& body, const SizeField& size, const std::vector<Vector3d>& anchors,
                             const VolumeMeshOptions& options) {
  VolumeMeshResult result;
  try {
    if (options.backend != Backend::mesh3) {
      try_tetgen(body, options.deadline != nullptr ? until(*options.deadline, size) : size, anchors, options, result);
    }
  } catch (const std::exception& error) {
    const auto* known = dynamic_cast<const Error*>(&error);
    if (known != nullptr && known->code() == ExitCode::io) throw;  // the installation's fault, not the surface's
    add_cause(result.cause, error.what());
  }
  if (result.usable || options.backend == Backend::tetgen) return result;
  try {
    MesherAnswer answer = mesh_by_mesh3(body, size, anchors, Deadline(attempt_limit(options)));
    if (answer.cause.empty()) answer.cause = orient_tets(answer.tets);
    if (answer.cause.empty()) answer.cause = judge(body, anchors, options, answer.tets, result);
    if (result.usable) {
      result.backend = "mesh3";
    } else {
      add_cause(result.cause, "Mesh_3: " + answer.cause);
    }
  } catch (const std::exception& error) {
    add_cause(result.cause, std::string("Mesh_3: ") + error.what());
  }
  return result;
}

}  // namespace palpate::mesh
