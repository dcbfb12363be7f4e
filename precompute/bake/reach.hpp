// SPDX-License-Identifier: GPL-3.0-or-later
// Places where a tool can make first contact: clear of supports, and not in a fold narrower than itself.
#pragma once

#include "precompute/common/body.hpp"
#include "precompute/solve/pair/contact_case.hpp"
#include "precompute/tool/tool.hpp"

namespace palpate::bake {

/// True when the contact at `depth` (m) round its first touch reaches a held part of the surface, or any other
/// part of the tool there would sink into one: no pair is planned, since the tool would press on what cannot move.
bool reaches_support(const solve::ContactCase& contact, double depth);

/// How a tool that comes along -frame.n gets to the pose in which its vertex touches frame.origin, on the undeformed
/// body.
struct TouchReach {
  double overlap = 0.0;  ///< m, >= 0, deepest overlap of body and tool in that pose
  double lift = 0.0;     ///< m, >= 0, how far out it first touches something
  bool blocked = false;  ///< it overlaps the body even when lifted by its diameter: a wall is in the way
};

TouchReach touch_reach(const solve::ContactCase& contact);

/// True when the tool can touch frame.origin first: its way is free, and it overlaps the body's surface there by at
/// most a fifth of its radius (bumps and averaged normals), else it meets the walls of a fold before.
bool can_touch_first(const solve::ContactCase& contact);

/// Both: the tool touches first and can be pressed to `depth` (m).
bool can_be_pressed(const solve::ContactCase& contact, double depth);

}  // namespace palpate::bake
