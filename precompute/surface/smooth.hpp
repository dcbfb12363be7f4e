// SPDX-License-Identifier: GPL-3.0-or-later
// Finer, rounder triangles through the vertices of a coarse organ file, whose facets a small tip would feel.
#pragma once

#include "formats/surface.hpp"

namespace palpate {

/// `rounds` of modified butterfly subdivision (Zorin, Schroeder and Sweldens 1996): four triangles for one in every
/// round, through all vertices. The surface must be closed and manifold; part names stay, the labels are to be made
/// anew.
Surface smooth(const Surface& surface, int rounds);

}  // namespace palpate
