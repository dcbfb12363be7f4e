// SPDX-License-Identifier: GPL-3.0-or-later
// Motions of a tool's tip over a surface, as CSV: t,x,y,z,qw,qx,qy,qz (s, m, unit quaternion tool to body).
#pragma once

#include "datasets-synthetic/sites.hpp"

#include <string>

namespace palpate::synth {

struct MotionOptions {
  double rate = 1000.0;       ///< rows a second, > 0
  double depth = 0.004;       ///< m, deepest push
  double tangential = 0.001;  ///< m, probe only
  double clearance = 0.01;    ///< m above the surface at begin and end
  double tip_offset = 0.005;  ///< m from the tool's origin to its tip's pole along -z
};

/// Approach along the normal, press, slide and back, lift: 3 s.
std::string probe_motion(const Site& site, const MotionOptions& options);

/// Approach, then over the sites in their order at half the depth and 20 mm/s, then lift.
std::string scan_motion(const std::vector<Site>& sites, const MotionOptions& options);

}  // namespace palpate::synth
