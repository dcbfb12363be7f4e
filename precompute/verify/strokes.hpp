// SPDX-License-Identifier: GPL-3.0-or-later
// Strokes that try what a hand does to a contact: tangential motion before, during and after deepening, stuck, slipping
// in part and sliding, turned round, lifted under load.
#pragma once

#include "precompute/solve/reference/stroke.hpp"

#include <string>
#include <vector>

namespace palpate::verify {

struct NamedStroke {
  std::string name;
  solve::StrokePath path;
};

struct StrokeScale {
  double depth = 0.0;           ///< m, deepest, > 0
  double contact_radius = 0.0;  ///< m, there, > 0
  double friction = 0.3;        ///< Coulomb coefficient, (0, 2]
  double poisson = 0.49;        ///< of the body
  double angle = 0.0;           ///< rad, of the main way, from the contact frame's x to its y
};

/// "press" (in, shear, slide, back, out), "deepen" (shear, deeper, shear across, lift under load, slide, out),
/// "oblique" (slides in at 45 degrees, sticks, back, slides out) and "graze" (slides while it deepens and lifts). Each
/// begins and ends free and stays within 3 contact radii of where it began.
std::vector<NamedStroke> standard_strokes(const StrokeScale& scale);

}  // namespace palpate::verify
