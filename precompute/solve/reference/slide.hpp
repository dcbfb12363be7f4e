// SPDX-License-Identifier: GPL-3.0-or-later
// Gross sliding: a tool pressed on the body and drawn along its surface, with Coulomb friction at every point of the
// contact and the mesh refined along the whole path.
#pragma once

#include "formats/journal/samples.hpp"
#include "precompute/common/body.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "precompute/tool/tool.hpp"

#include <Eigen/Core>
#include <string>
#include <vector>

namespace palpate::solve {

/// The path of a slide. The tool keeps its direction and its depth, measured everywhere from its first touch of the
/// undeformed surface.
struct SlidePath {
  double depth = 0.0;     ///< m, > 0
  double friction = 0.3;  ///< Coulomb coefficient, > 0
  double angle = 0.0;     ///< rad, of the way from the frame's x to its y
  double radii = 4.0;     ///< length of the way in contact radii, > 0
  double approach = 0.0;  ///< rad, between the tool's way in and the inward normal, towards the way; (-1.5, 1.5)
  double step = 0.1;      ///< of the tool, in contact radii, (0, 1]
  int press_steps = 6;    ///< of the way in, evenly spaced in sqrt(depth), >= 2
};

/// One equilibrium of the way along the surface.
struct SlideStep {
  double travelled = 0.0;          ///< m; 0: the end of the way in
  Eigen::Vector3d force{0, 0, 0};  ///< N on the tool: against the way, across it, along the outward normal
  double slipping = 0.0;           ///< share of the friction limit at points that slip
  bool gross = false;              ///< the contact slips as a whole (FrictionReport::gross)
  double local_ratio = 0.0;        ///< sum of the tractions over sum of the pressures: mu where all slip
  double predicted = 0.0;          ///< mu times ContactEnergy::slip_ratio: the force ratio from the slopes alone
  double work = 0.0, stored = 0.0, dissipated = 0.0;  ///< J since the end of the way in
  std::uint32_t points = 0;                           ///< integration points in contact
  std::uint32_t iterations = 0;
};

struct SlideResult {
  bool usable = false;
  std::string cause;  ///< why not, or why the way ended early
  std::vector<SlideStep> steps;
  double contact_radius = 0.0;  ///< m, nominal, the unit of the way
  double gross_at = -1.0;       ///< m travelled until all points slip; -1: never
  double ratio = 0.0;           ///< mean of force against the way over normal force, in the last half of the way
  double spread = 0.0;          ///< largest deviation from it there, relative
  double local_ratio = 0.0;     ///< mean there
  double predicted = 0.0;       ///< mean there
  double imbalance = 0.0;       ///< (work - stored - dissipated) / work at the end
  std::uint32_t nodes = 0, factorisations = 0;
};

/// Presses the tool on the body, in from the side where the path says so, and slides. Usable where every
/// step passed its gates and the whole contact slipped over the last half of the way. Throws Error(usage) for a path
/// out of its ranges, never for a numerical failure.
SlideResult solve_slide(const ContactCase& contact, const SlidePath& path, const PairOptions& options);

}  // namespace palpate::solve
