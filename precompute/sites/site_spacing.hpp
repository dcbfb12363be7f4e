// SPDX-License-Identifier: GPL-3.0-or-later
// Distance between sites over a body: smaller where it is sharply curved or thin.
#pragma once

#include "formats/scene/scene.hpp"
#include "precompute/common/body.hpp"
#include "precompute/mesh/size_field.hpp"

namespace palpate::sites {

/// The field between margin_spacing and spacing; it changes by at most half the distance moved. Constant where
/// margin_spacing = spacing.
mesh::SizeField site_spacing(const SamplingScene& sampling, const Body& body);

}  // namespace palpate::sites
