// SPDX-License-Identifier: GPL-3.0-or-later
// The cells of the stiff battery: contacts at and beyond the ends of every range that a scene allows.
#pragma once

#include "precompute/verify/battery/battery_cell.hpp"

#include <vector>

namespace palpate::verify {

/// All of them, in a fixed order; at least 300.
std::vector<BatteryCell> stiff_cells();

}  // namespace palpate::verify
