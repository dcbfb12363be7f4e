// SPDX-License-Identifier: GPL-3.0-or-later
// Sideways pushes with Coulomb friction: partial slip from the rim inwards, then gross slip, both solved.
#pragma once

#include "formats/samples.hpp"
#include "precompute/solve/coulomb_push.hpp"

#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// One push, from an equilibrium of the straight one.
struct SlipPush {
  PushState from;                ///< a contact without anchors begins unstressed
  Eigen::Vector3d direction;     ///< unit, body frame
  double depth = 0.0;            ///< m
  double corrected_depth = 0.0;  ///< m, of the sample of `from`
  double reach = 0.0;            ///< m, at the last point
  int points = 0;                ///< evenly spaced
  double contact_radius = 0.0;   ///< m
  double work_scale = 0.0;       ///< J
  CoulombOptions friction;
  std::function<Sample(std::uint32_t iterations)> sample;  ///< of where the push stands, without friction's share
};

struct SlipPushResult {
  std::vector<Sample> samples;
  std::string cause;  ///< why there are fewer than asked for; else empty
  std::uint32_t solves = 0;
};

/// Samples of kind `slipping`, each passed by its gates: the deflection less the elastic slip's own give, and where
/// every point slips the friction limit. The force of a contact that stuck while it was pushed is first brought within
/// the limit of every point.
SlipPushResult slip_push(Push& push, const ContactFrame& frame, const SlipPush& plan);

/// Sideways deflection over depth at which a contact on a half-space begins to slip as a whole (Mindlin 1949): the same
/// for a sphere, formed without friction, and a flat punch.
double gross_slip_reach(double friction, double poisson);

}  // namespace palpate
