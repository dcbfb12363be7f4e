// SPDX-License-Identifier: GPL-3.0-or-later
// The contacts on which our solver is compared with CalculiX.
#pragma once

#include "precompute/common/body.hpp"
#include "precompute/fem/materials/material.hpp"
#include "precompute/tool/tool.hpp"
#include "precompute/verify/ccx/ccx_deck.hpp"

#include <string>
#include <vector>

namespace palpate::verify {

/// A block of 8 x 8 x 4 tip radii, held at its bottom, under a tip in the middle of its top face (z = 0).
struct CcxCase {
  std::string name;
  tool::Tool tool;
  Body body;
  double base = 1.0;  ///< size of the base mesh's elements over those of the settings
  Body quarter;       ///< its part in x, y >= 0
  CcxMaterial law;
  fem::Material material;      ///< the same energy for our elements
  std::vector<double> depths;  ///< m, evenly spaced to 40 % of the tip's radius
};

/// Sphere and punch of 5 mm (its rim rounded by a fifth), neo-Hookean and Mooney-Rivlin (30 % of the shear modulus in
/// I2), nu 0.3 and 0.45; Young's modulus at small strain 5 kPa.
std::vector<CcxCase> ccx_cases(int depths = 6);

}  // namespace palpate::verify
