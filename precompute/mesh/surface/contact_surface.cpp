// SPDX-License-Identifier: GPL-3.0-or-later
// Patches on the body's surface, decimated until nothing crosses and the tolerance holds.
#include "precompute/mesh/surface/contact_surface.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/feature_normals.hpp"
#include "precompute/geometry/intersections.hpp"
#include "precompute/geometry/query.hpp"
#include "precompute/mesh/surface/decimate_layout.hpp"
#include "precompute/mesh/surface/patch_layout.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;
using Corners = std::array<std::int32_t, 3>;

constexpr int kWeightSteps = 255;   // the most that a response file allows
constexpr int kAttempts = 12;       // of decimation; each keeps what crossed in the last one

Surface surface_of(const std::vector<Vector3d>& points, const std::vector<Corners>& triangles) {
  Surface s;
  s.vertices = points;
  s.triangles = triangles;
  s.parts.assign(triangles.size(), 0);
  s.part_names = {"contact surface"};
  return s;
}

// Per triangle of `from` the largest distance of points spread over it to `to`.
std::vector<double> distances(const Surface& from, const geometry::SurfaceQuery& to) {
  constexpr int kSteps = 4;
  std::vector<double> largest(from.triangles.size(), 0.0);
  for (std::size_t t = 0; t < largest.size(); ++t) {
    const Corners& v = from.triangles[t];
    const Vector3d &a = from.vertices[v[0]], &b = from.vertices[v[1]], &c = from.vertices[v[2]];
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const Vector3d p = (i * a + j * b + (kSteps - i - j) * c) / kSteps;
        largest[t] = std::max(largest[t], to.closest(p).distance);
      }
    }
  }
  return largest;
}

double largest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

// Weights of the sites of a patch at a point of the layout: those of the closest point of the patch, and on a path
// those of the closest point of its side. The closest point of a triangle is a continuous function.
Vector3d weights_at(const PatchLayout& layout, const std::vector<Vector3d>& sites, const Corners& patch,
                    std::int32_t v) {
  const Vector3d& p = layout.points[std::size_t(v)];
  const PathPlace& place = layout.places[std::size_t(v)];
  const auto unit = [&](std::int32_t site) {
    return Vector3d(Vector3d::Unit(std::find(patch.begin(), patch.end(), site) - patch.begin()));
  };
  constexpr double kLeast = 1.0 / kWeightSteps;  // off a path no weight is 0, on it those of its sites are not
  if (place.site >= 0) return unit(place.site);
  if (place.side >= 0) {
    const auto [a, b] = layout.sides[std::size_t(place.side)];
    const Vector3d start = sites[std::size_t(a)], along = sites[std::size_t(b)] - start;
    const double share = std::clamp((p - start).dot(along) / along.squaredNorm(), kLeast, 1 - kLeast);
    return (1 - share) * unit(a) + share * unit(b);
  }
  const auto corner = [&](int k) -> const Vector3d& { return sites[std::size_t(patch[k])]; };
  const Vector3d w = geometry::closest_on_triangle(p, corner(0), corner(1), corner(2)).weights.cwiseMax(kLeast);
  return w / w.sum();
}

// Whole numbers that sum to `steps`; what is not zero stays so.
std::array<int, 3> rounded(const Vector3d& weights, int steps) {
  std::array<int, 3> whole{};
  int rest = steps;
  for (int k = 0; k < 3; ++k) {
    if (!(weights[k] > 0)) continue;
    whole[k] = std::max(1, static_cast<int>(std::floor(weights[k] * steps)));
    rest -= whole[k];
  }
  const auto error = [&](int k) { return weights[k] * steps - whole[k]; };
  for (; rest != 0; rest += rest > 0 ? -1 : 1) {
    int best = -1;
    for (int k = 0; k < 3; ++k) {
      if (!(weights[k] > 0) || (rest < 0 && whole[k] < 2)) continue;
      if (best < 0 || (rest > 0 ? error(k) > error(best) : error(k) < error(best))) best = k;
    }
    whole[best] += rest > 0 ? 1 : -1;
  }
  return whole;
}

ContactSurface with_weights(const PatchLayout& layout, const std::vector<Vector3d>& sites,
                            const std::vector<Corners>& patches) {
  ContactSurface result;
  result.points = layout.points;
  result.patches = patches;
  const bool plain = std::all_of(layout.places.begin(), layout.places.end(), [](const auto& p) { return p.site >= 0; });
  result.weight_steps = plain ? 1 : kWeightSteps;
  for (std::size_t t = 0; t < layout.triangles.size(); ++t) {
    ContactTriangle triangle;
    triangle.vertices = layout.triangles[t];
    triangle.patch = layout.patch[t];
    for (int k = 0; k < 3; ++k) {
      const Vector3d weights = weights_at(layout, sites, patches[std::size_t(triangle.patch)], triangle.vertices[k]);
      const std::array<int, 3> whole = rounded(weights, result.weight_steps);
      triangle.grid[k] = {static_cast<std::uint8_t>(whole[0]), static_cast<std::uint8_t>(whole[1])};
    }
    result.triangles.push_back(triangle);
  }
  return result;
}

// The patches as triangles of their own.
PatchLayout flat_layout(const std::vector<Vector3d>& sites, const std::vector<Corners>& patches) {
  PatchLayout layout;
  layout.points = sites;
  for (std::size_t k = 0; k < sites.size(); ++k) layout.places.push_back({static_cast<std::int32_t>(k), -1});
  layout.triangles = patches;
  for (std::size_t k = 0; k < patches.size(); ++k) layout.patch.push_back(static_cast<std::int32_t>(k));
  layout.sides = patch_sides(patches);
  return layout;
}

// A response file has 32-bit floats: what is checked is what it holds.
void round_points(PatchLayout& layout) {
  for (Vector3d& p : layout.points) p = p.cast<float>().cast<double>();
}

// Points of a layout that a decimation has to keep, because it went wrong round them.
class KeptPoints {
public:
  explicit KeptPoints(const PatchLayout& full) : full_(full), flags(full.points.size(), 0) {}

  /// True where a point was not kept before.
  bool keep_round(const Surface& surface, std::size_t triangle, double reach) {
    Eigen::AlignedBox3d box;
    for (const std::int32_t v : surface.triangles[triangle]) box.extend(surface.vertices[std::size_t(v)]);
    box.min().array() -= reach;
    box.max().array() += reach;
    bool any = false;
    for (std::size_t k = 0; k < flags.size(); ++k) {
      if (flags[k] != 0 || !box.contains(full_.points[k])) continue;
      flags[k] = 1;
      any = true;
    }
    return any;
  }
  bool keep_far(const Surface& surface, const std::vector<double>& distances, double tolerance) {
    bool any = false;
    for (std::size_t t = 0; t < distances.size(); ++t) {
      if (distances[t] > tolerance && keep_round(surface, t, tolerance)) any = true;
    }
    return any;
  }

private:
  const PatchLayout& full_;

public:
  std::vector<char> flags;  // per point
};

ContactSurface decimated(const Surface& body, const PatchLayout& full, const std::vector<Vector3d>& sites,
                         const std::vector<Corners>& patches, double tolerance) {
  constexpr double kMargin = 0.97;  // the decimater measures at fewer points
  const geometry::SurfaceQuery query(body);
  KeptPoints kept(full);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    PatchLayout coarse = decimate(full, query, kMargin * tolerance, kept.flags);
    round_points(coarse);
    const Surface surface = surface_of(coarse.points, coarse.triangles);
    const std::vector<std::int32_t> crossing = geometry::crossing_triangles(surface);
    for (const std::int32_t t : crossing) kept.keep_round(surface, std::size_t(t), tolerance);
    if (!crossing.empty()) continue;
    const std::vector<double> there = distances(surface, query),
                              back = distances(body, geometry::SurfaceQuery(surface));
    const double distance = std::max(largest(there), largest(back));
    const bool far = kept.keep_far(surface, there, tolerance), behind = kept.keep_far(body, back, tolerance);
    if ((far || behind) && attempt + 1 < kAttempts) continue;
    ContactSurface result = with_weights(coarse, sites, patches);
    result.distance = distance;
    return result;
  }
  throw Error(ExitCode::numerical, "contact surface: every decimation of the body's surface crosses itself");
}

}  // namespace

ContactSurface make_contact_surface(const Surface& body, const std::vector<Vector3d>& sites,
                                    const std::vector<Corners>& patches, double tolerance) {
  std::string fault;
  try {
    PatchLayout full = lay_out_patches(body, sites, patches);
    round_points(full);
    return decimated(body, full, sites, patches, tolerance);
  } catch (const Error& error) {
    if (error.code() != ExitCode::numerical) throw;
    fault = error.what();
  }
  PatchLayout flat = flat_layout(sites, patches);
  round_points(flat);
  const Surface surface = surface_of(flat.points, flat.triangles);
  if (!geometry::crossing_triangles(surface).empty())
    throw Error(ExitCode::numerical, fault + "; the mesh of patches crosses itself");
  ContactSurface result = with_weights(flat, sites, patches);
  result.distance = std::max(largest(distances(surface, geometry::SurfaceQuery(body))),
                             largest(distances(body, geometry::SurfaceQuery(surface))));
  result.fault = fault;
  return result;
}

}  // namespace palpate::mesh
