// SPDX-License-Identifier: GPL-3.0-or-later
// Closes what a plane cut open: an image's border, a planar cut.
#pragma once

#include "formats/surface/surface.hpp"

#include <string>
#include <vector>

namespace palpate::surface {

/// Closes every rim that lies flat: its points are within half of its mean edge, and 3 % of the diagonal, of one plane,
/// and its outline in that plane does not cross itself. A rim inside another of the same plane bounds a hole in the
/// cap. Cap triangles have the part of a triangle at the rim, and any orientation. Appends one line a cap to `notes`.
Surface cap_flat_rims(const Surface& surface, std::vector<std::string>& notes);

}  // namespace palpate::surface
