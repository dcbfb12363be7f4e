// SPDX-License-Identifier: GPL-3.0-or-later
// The closed surface round the voxels of a label.
#pragma once

#include "formats/label_image.hpp"
#include "formats/surface.hpp"

#include <string>

namespace palpate {

/// Level set of the voxels' indicator, smoothed over one voxel (binomial weights 1 4 6 4 1 along each axis) so that no
/// steps are left, at the level that encloses the voxels' own volume. Closed, manifold, outward; one part called
/// `name`. Of a ball four voxels in radius and larger it lies within 0.35 voxels.
/// Throws Error(bad_input) naming `name` where the label is too thin for that: parts of less than about two voxels.
Surface label_surface(const LabelMask& mask, const std::string& name);

}  // namespace palpate
