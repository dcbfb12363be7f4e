// SPDX-License-Identifier: GPL-3.0-or-later
// The part of surface preparation that CGAL does, behind plain types; two translation units implement it.
#pragma once

#include "formats/surface/surface.hpp"

#include <optional>

namespace palpate::surface {

struct MendOptions {
  double hole_area = 0.0;  ///< m^2; holes up to this area (of the fan round their middle) are closed
};

/// Orients a welded soup, stitches its borders, removes triangles without area, closes small holes and turns
/// closed parts outward (cavities inward). Parts follow their triangles. Empty when CGAL cannot make a mesh of it.
std::optional<Surface> mend(const Surface& surface, const MendOptions& options);

/// Closed manifold outer surface of any soup (CGAL alpha wrap): openings narrower than about `alpha` (m, > 0)
/// are closed, the result lies `offset` (m, > 0) outside. Parts are all 0: see label_parts.
Surface alpha_wrap(const Surface& soup, double alpha, double offset);

/// Volume of the convex hull of the vertices (m^3); 0 when they lie in a plane.
double hull_volume(const Surface& surface);

}  // namespace palpate::surface
