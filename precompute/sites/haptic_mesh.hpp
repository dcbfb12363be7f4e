// SPDX-License-Identifier: GPL-3.0-or-later
// The sites of a body: a coarse triangle mesh whose vertices carry responses.
#pragma once

#include "formats/scene/scene.hpp"
#include "precompute/common/body.hpp"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

namespace palpate::sites {

/// Two sites of a patch, the lower first.
using SiteEdge = std::array<std::int32_t, 2>;

struct EdgeLengths {
  double shortest = 0.0, median = 0.0, mean = 0.0, longest = 0.0;  ///< m
};

/// Arrays from points to selected have one entry a site. Closed and manifold.
struct HapticMesh {
  std::vector<Eigen::Vector3d> points;    ///< m, on the body's surface
  std::vector<Eigen::Vector3d> normals;   ///< unit, outward, averaged over a third of the spacing
  std::vector<Eigen::Vector3d> tangents;  ///< unit, orthogonal to normals: the global x axis (y where n is near x)
  std::vector<double> thickness;          ///< m
  std::vector<double> depth;              ///< m: min(scene depth, depth_fraction * (thickness; over a cavity with it)),
                                          ///< at sampling.sites the scene depth
  std::vector<std::uint8_t> held;         ///< on a support
  std::vector<std::uint8_t> selected;     ///< of sampling.sites, or inside its within_box (or no box given); not in a
                                          ///< cavity
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::map<std::int32_t, SiteEdge> split;  ///< by the site in its middle: the edges that were split

  EdgeLengths edges;  ///< of the coarse mesh
};

/// Whether a point (m) lies in sampling.within_box; true without a box.
bool within_box(const Scene& scene, const Eigen::Vector3d& point);

/// Radius (m) over which the normals of sites are averaged: a third of sampling.spacing, and no more than the radius of
/// the smallest round tool.
double normal_radius(const Scene& scene);

/// Places sites about sampling.spacing apart, down to margin_spacing where the body is sharply curved or thinner
/// than 1.5 times the spacing, which has to be above 0, and one at each of sampling.sites. Deterministic.
/// Throws Error(bad_input) where one of sampling.sites is more than the depth away from the surface, and where the
/// spacing leaves fewer than four sites or needs more triangles than adapt_surface makes, Error(numerical) as that.
HapticMesh make_haptic_mesh(const Scene& scene, const Body& body);

/// Puts a site on the body at the middle of each edge, and of the longest edge of every patch that one of them belongs
/// to, and splits the patches there, so that the mesh stays conforming and no angle shrinks beyond half. Earlier sites
/// keep their numbers.
void split_edges(const Scene& scene, const Body& body, const std::vector<SiteEdge>& edges, HapticMesh& mesh);

}  // namespace palpate::sites
