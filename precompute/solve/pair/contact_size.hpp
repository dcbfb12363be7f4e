// SPDX-License-Identifier: GPL-3.0-or-later
// The size field of a pair: fine over the patch of the body that the tool will cover, growing away from it.
#pragma once

#include "precompute/common/body.hpp"
#include "precompute/mesh/size_field.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "precompute/tool/tool.hpp"

#include <vector>

namespace palpate::solve {

/// Edge length for a push down to `depth` (m) with options.mesh_size * `scale` of
/// the contact radius over the footprint, and the supports' rims resolved. `further` are places (m, from frame.origin)
/// that the tool goes to at that depth: where there are any, the first touch gets no smaller elements of its own.
mesh::SizeField contact_size(const ContactCase& contact, double depth, double scale, const PairOptions& options,
                             const std::vector<Eigen::Vector3d>& further = {});

/// Longest edge (m) far from the contact: options.max_size, or an eighth of the body's diagonal and no more than twice
/// the body's median wall, which else bends too stiffly.
double longest_edge(const Body& body, const PairOptions& options);

}  // namespace palpate::solve
