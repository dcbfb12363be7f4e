// SPDX-License-Identifier: GPL-3.0-or-later
// Points inside a body, spaced by a size field, for a mesher that otherwise uses the sizes on surfaces only.
#pragma once

#include "formats/surface/surface.hpp"
#include "precompute/mesh/size_field.hpp"

#include <vector>

namespace palpate::mesh {

/// Leaf centres of an octree over the first surface (closed), its cells about `size` wide and shifted a little off
/// their lattice, of those that lie inside it and keep two thirds of the size away from every surface. Deterministic.
/// Throws Error(numerical) where that takes more than half a million cells.
std::vector<Eigen::Vector3d> interior_points(const std::vector<const Surface*>& surfaces, const SizeField& size);

}  // namespace palpate::mesh
