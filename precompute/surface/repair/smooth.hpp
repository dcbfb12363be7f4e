// SPDX-License-Identifier: GPL-3.0-or-later
// Finer, rounder triangles through the vertices of a coarse organ file, whose facets a small tip would feel.
#pragma once

#include "formats/surface/surface.hpp"

namespace palpate::surface {

struct Smoothed {
  Surface surface;
  std::size_t kept_edges = 0;  ///< left straight: rounded, the surface would cross itself there
};

/// `rounds` of modified butterfly subdivision (Zorin, Schroeder and Sweldens 1996): four triangles for one in every
/// round, through all vertices. If the rounded surface would cross itself, as in a fold of a wrapped organ, the edges
/// there are halved without rounding, so that no new crossing arises. The surface must be closed and manifold; part
/// names stay, the labels are to be made anew.
Smoothed smooth(const Surface& surface, int rounds);

}  // namespace palpate::surface
