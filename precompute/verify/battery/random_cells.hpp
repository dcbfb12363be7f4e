// SPDX-License-Identifier: GPL-3.0-or-later
// Random contacts: bodies, materials, supports and tools drawn over wide ranges.
#pragma once

#include "precompute/verify/battery/battery_cell.hpp"

#include <cstdint>
#include <vector>

namespace palpate::verify {

/// Cell number k of a seed is the same for every `count`.
///
/// - bodies: blocks, balls, slabs and ellipsoids of 1 mm to 1 m
/// - E 100 Pa to 10 GPa, nu 0 to 0.499; neo-Hookean, Mooney-Rivlin, Ogden, Veronda-Westmann and the linear law
/// - spheres and capsules of 1e-4 to 2 of the thickness, punches to 0.3, tips of cones to 0.05
/// - a third has a ball of another stiffness inside, 1e-3 to 1e3 times the body's
/// - held below by a plane or a box, on a spring bed, or at two sides
/// - two fifths have friction, 0.05 to 1.3
std::vector<BatteryCell> random_cells(std::uint64_t seed, std::size_t count);

}  // namespace palpate::verify
