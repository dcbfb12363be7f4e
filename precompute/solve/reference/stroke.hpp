// SPDX-License-Identifier: GPL-3.0-or-later
// A stroke: a tool drawn through given places against a body, with Coulomb friction at every point of the contact. It
// may touch, stick, slip in part, slide, turn round, deepen, lift and let go in any order.
#pragma once

#include "formats/journal/samples.hpp"
#include "precompute/common/body.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "precompute/tool/tool.hpp"

#include <Eigen/Core>
#include <string>
#include <vector>

namespace palpate::solve {

struct StrokePath {
  /// m, where the tool goes from where it just touches the undeformed surface, in the contact's frame: -z is the depth
  /// at the frame's origin. Straight from place to place, in order, without turning. At least one that is in contact.
  std::vector<Eigen::Vector3d> stations;
  double friction = 0.3;  ///< Coulomb coefficient, (0, 2]
};

/// The equilibrium at a station.
struct StrokeStep {
  Eigen::Vector3d station{0, 0, 0};                   ///< m, as given
  Eigen::Vector3d force{0, 0, 0};                     ///< N on the tool, contact frame
  double slipping = 0.0;                              ///< share of the friction limit at points that slip
  bool gross = false;                                 ///< the contact slips as a whole (FrictionReport::gross)
  std::uint32_t points = 0;                           ///< integration points in contact; 0: the tool is free
  bool resolved = false;                              ///< enough of them for an accurate force (GateLimits)
  double work = 0.0, stored = 0.0, dissipated = 0.0;  ///< J since before the first touch
};

struct StrokeResult {
  bool usable = false;  ///< every station was reached and passed its gates
  std::string cause;    ///< why not; the steps before it are valid
  std::vector<StrokeStep> steps;
  double contact_radius = 0.0;  ///< m, nominal, of the deepest station
  double imbalance = 0.0;       ///< (work - stored - dissipated) over the most work so far, at the end
  std::uint32_t nodes = 0, factorisations = 0;
};

/// Draws the tool past the body, on a mesh that is refined wherever the stroke presses. Throws
/// Error(usage) for a path out of its ranges, never for a numerical failure.
StrokeResult solve_stroke(const ContactCase& contact, const StrokePath& path, const PairOptions& options);

}  // namespace palpate::solve
