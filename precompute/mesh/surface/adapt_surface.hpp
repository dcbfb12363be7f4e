// SPDX-License-Identifier: GPL-3.0-or-later
// Remeshes a closed surface so that its edges follow a size field: fine at a contact site, coarse away from it.
#pragma once

#include "formats/io/error.hpp"
#include "formats/surface/surface.hpp"
#include "precompute/geometry/query.hpp"
#include "precompute/mesh/size_field.hpp"

#include <vector>

namespace palpate::mesh {

struct AdaptOptions {
  int rounds = 5;        ///< of split, collapse, flip, relax; [1, 20]
  double chord = 0.12;   ///< largest distance from a triangle's middle to the surface, of the local edge length
  double largest = 0.0;  ///< m; caps the size field; 0: no cap
};

struct AdaptedSurface {
  Surface surface;                    ///< closed, manifold, does not cross itself; vertices on the original; one part
  std::vector<std::int32_t> anchors;  ///< the vertex of each anchor, at exactly its coordinates
};

/// The size field needs too many triangles: a smaller one would need more.
class TooFine : public Error {
public:
  using Error::Error;
};

/// Adapts `base` (closed, manifold, near `original`) to `size`. The feature lines of `original`
/// stay; their ends and branchings (corners) do not move. `anchors` are points on `original`; each becomes a
/// vertex. Deterministic; safe to call from several threads.
/// Throws Error(bad_input) for a base that is not a closed manifold, Error(numerical) where the size field gives
/// a length that is not finite and positive, TooFine (numerical) where it needs more than 300 000 triangles, and
/// Error(numerical) where every adaptation strays from the original or crosses itself.
AdaptedSurface adapt_surface(const Surface& base, const geometry::SurfaceQuery& original, const SizeField& size,
                             const std::vector<Eigen::Vector3d>& anchors, const AdaptOptions& options = {});

}  // namespace palpate::mesh
