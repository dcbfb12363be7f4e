// SPDX-License-Identifier: GPL-3.0-or-later
// The sites of a body: a coarse triangle mesh whose vertices carry responses, and the fine surface of contact.
#pragma once

#include "formats/scene.hpp"
#include "precompute/body.hpp"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace palpate {

/// A triangle of the contact surface.
struct FineTriangle {
  std::array<std::int32_t, 3> vertices{};              ///< of fine_points, counter-clockwise from outside
  std::int32_t patch = 0;                              ///< coarse triangle
  std::array<std::array<std::uint16_t, 2>, 3> grid{};  ///< per corner: subdivision times its weights of the
                                                       ///< patch's first two corners
};

struct EdgeLengths {
  double shortest = 0.0, median = 0.0, mean = 0.0, longest = 0.0;  ///< m
};

/// Arrays from points to selected have one entry a site. Closed and manifold, as is the fine surface.
struct HapticMesh {
  std::vector<Eigen::Vector3d> points;    ///< m, on the body's surface
  std::vector<Eigen::Vector3d> normals;   ///< unit, outward, averaged over a third of the spacing
  std::vector<Eigen::Vector3d> tangents;  ///< unit, orthogonal to normals: the global x axis (y where n is near x)
  std::vector<double> thickness;          ///< m
  std::vector<double> depth;              ///< m: min(scene depth, depth_fraction * (thickness; over a cavity with it))
  std::vector<std::uint8_t> held;         ///< on a support
  std::vector<std::uint8_t> selected;     ///< inside sampling.within_box (or no box given) and not in a cavity
  std::vector<std::array<std::int32_t, 3>> triangles;

  std::int32_t subdivision = 1;              ///< k in [1, 8]
  std::vector<Eigen::Vector3d> fine_points;  ///< m, on the body's surface; the sites come first
  std::vector<FineTriangle> fine_triangles;  ///< k * k a patch
  double chordal_error = 0.0;                ///< m, largest distance of a fine triangle's middle to the body's surface,
                                             ///< over the patches with a site that is selected and not held
  EdgeLengths edges;                         ///< of the coarse mesh
};

/// Radius (m) over which the normals of sites are averaged: a third of sampling.spacing, and no more than the radius of
/// the smallest round tool.
double normal_radius(const Scene& scene);

/// Places sites about sampling.spacing apart, down to margin_spacing where the body is sharply curved or thinner
/// than 1.5 times the spacing; then chooses the smallest k in [1, 8] with a chordal error of at most 2 % of the
/// depth that all but 5 % of the selected sites reach (8 where none is fine enough). Deterministic.
/// The spacing has to be above 0. Throws Error(bad_input) where it leaves fewer than four sites or asks for more triangles than adapt_surface
/// makes, Error(numerical) as that.
HapticMesh make_haptic_mesh(const Scene& scene, const Body& body);

/// The same without the surface of contact.
HapticMesh place_sites(const Scene& scene, const Body& body);

/// Makes the surface of contact of the patches.
void make_contact_surface(const Body& body, HapticMesh& mesh);

/// Two sites of a patch, the lower first.
using SiteEdge = std::array<std::int32_t, 2>;

/// Puts a site on the body at the middle of each edge, and of the longest edge of every patch that one of them belongs
/// to, and splits the patches there, so that the mesh stays conforming and no angle shrinks beyond half. Earlier sites
/// keep their numbers. The surface of contact has to be made anew.
void split_edges(const Scene& scene, const Body& body, const std::vector<SiteEdge>& edges, HapticMesh& mesh);

}  // namespace palpate
