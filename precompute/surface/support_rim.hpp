// SPDX-License-Identifier: GPL-3.0-or-later
// The rim of what the supports hold: elements there decide how much of the surface a mesh really holds.
#pragma once

#include "precompute/common/body.hpp"

namespace palpate::surface {

/// Points along the rim of the held surface of `body` (its query and supports set), at most one per cell of `size`,
/// and the edge length that resolves it: half of held area over rim length (an eighth of a disc's diameter), between
/// 1/64 and 1/8 of the body's diagonal. Empty where nothing, or everything, is held.
SupportRim support_rim(const Body& body);

}  // namespace palpate::surface
