// SPDX-License-Identifier: GPL-3.0-or-later
// The closed surface round the voxels of a label.
#pragma once

#include "formats/image/label_image.hpp"
#include "formats/surface/surface.hpp"

#include <string>

namespace palpate::geometry {

/// Closed, manifold, outward surface with the voxels' own volume; one part called "label".
///
/// The voxels' indicator is smoothed by about one voxel, resampled to a lattice of about equal steps (thick slices are
/// interpolated, a fine image of a large organ is coarsened) and cut at the level that encloses the voxels' volume. The
/// cut is faired, so that no steps are left; no vertex moves by more than half a voxel. The surface of a ball of at
/// least four voxels in radius lies within 0.35 voxels of the ball.
/// Throws Error(bad_input) naming `name` where the label is too thin: parts of less than about two voxels.
Surface label_surface(const LabelMask& mask, const std::string& name);

}  // namespace palpate::geometry
