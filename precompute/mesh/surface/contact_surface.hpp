// SPDX-License-Identifier: GPL-3.0-or-later
// The surface that a response file holds: a decimated copy of the body's, each point of which lies in a patch.
#pragma once

#include "formats/surface/surface.hpp"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace palpate::mesh {

/// A triangle of the contact surface, within one patch.
struct ContactTriangle {
  std::array<std::int32_t, 3> vertices{};              ///< of ContactSurface::points, counter-clockwise from outside
  std::int32_t patch = 0;                              ///< of the haptic mesh
  std::array<std::array<std::uint8_t, 2>, 3> grid{};   ///< per corner: weight_steps times its weights of the patch's
                                                       ///< first two sites
};

/// Closed and manifold; does not cross itself when its points are rounded to 32-bit floats.
struct ContactSurface {
  std::vector<Eigen::Vector3d> points;  ///< m; the sites come first
  std::vector<ContactTriangle> triangles;
  std::vector<std::array<std::int32_t, 3>> patches;  ///< of the haptic mesh: sites
  std::int32_t weight_steps = 1;                     ///< weights are multiples of 1 / weight_steps, [1, 255]
  double distance = 0.0;  ///< m, largest found between this surface and the body's, in either direction
  std::string fault;      ///< why the patches themselves stand for the body's surface; empty: they do not
};

/// The contact surface of `body` (closed, manifold, without crossings) that is nowhere farther than `tolerance` (m, >
/// 0) from it. `sites` are points on the body (m), `patches` a closed manifold mesh of them. If patches cannot be
/// laid out on the body's surface, the result is the mesh of patches itself, with the fault. Deterministic. Throws
/// Error(numerical) where that mesh crosses itself too.
ContactSurface make_contact_surface(const Surface& body, const std::vector<Eigen::Vector3d>& sites,
                                    const std::vector<std::array<std::int32_t, 3>>& patches, double tolerance);

}  // namespace palpate::mesh
