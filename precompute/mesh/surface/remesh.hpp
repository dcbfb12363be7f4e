// SPDX-License-Identifier: GPL-3.0-or-later
// Uniform remeshing of a closed surface: the coarse copies that all site meshes start from.
#pragma once

#include "formats/surface/surface.hpp"

namespace palpate::mesh {

/// Remeshes a closed, manifold surface without self-intersections to edges of about `edge` (m, > 0); its
/// feature lines (query.hpp) stay where they are. Every triangle gets the part of the nearest triangle of
/// `surface`. If that length folds thin parts onto themselves, a shorter one is taken, in the end
/// `surface` as it is. Throws Error(bad_input) for a surface that is not manifold or an edge <= 0.
Surface remesh_uniform(const Surface& surface, double edge);

}  // namespace palpate::mesh
