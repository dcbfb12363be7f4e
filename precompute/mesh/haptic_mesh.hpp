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

/// Places sites about sampling.spacing apart, down to margin_spacing where the body is sharply curved or thinner
/// than 1.5 times the spacing; then chooses the smallest k in [1, 8] with a chordal error of at most 2 % of the
/// depth that all but 5 % of the selected sites reach (8 where none is fine enough). Deterministic.
/// Throws Error(bad_input) where the spacing leaves fewer than four sites or needs more triangles than adapt_surface
/// makes, Error(numerical) as that.
HapticMesh make_haptic_mesh(const Scene& scene, const Body& body);

}  // namespace palpate
