// SPDX-License-Identifier: GPL-3.0-or-later
// The material of a scene.
#pragma once

#include "formats/scene/scene.hpp"
#include "precompute/fem/materials/material.hpp"

namespace palpate::fem {

/// `scene` as read_scene leaves it: ranges and the shear modulus are checked there.
Material make_material(const MaterialScene& scene);

}  // namespace palpate::fem
