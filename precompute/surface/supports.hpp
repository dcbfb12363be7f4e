// SPDX-License-Identifier: GPL-3.0-or-later
// Default supports of a body, and a check whether the scene's own supports can hold it.
#pragma once

#include "precompute/common/body.hpp"

namespace palpate::surface {

/// The lowest tenth of the surface along z.
SupportScene default_support(const Surface& surface);

/// `body` has its surface and its supports. Throws Error(bad_input) where a support holds nothing, all together
/// leave nothing free, or a component of the body is held by none of the scene's: it would float away.
void check_supports(const Body& body, const Scene& scene);

}  // namespace palpate::surface
