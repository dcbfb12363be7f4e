// SPDX-License-Identifier: GPL-3.0-or-later
// Which part of a closed surface is the wall of a cavity.
#pragma once

#include "formats/surface/surface.hpp"

#include <vector>

namespace palpate::surface {

/// Per triangle of a closed, oriented surface: on a component that faces inward. Empty: none is.
std::vector<char> cavity_triangles(const Surface& surface);

}  // namespace palpate::surface
