// SPDX-License-Identifier: GPL-3.0-or-later
// Where a tool can make first contact at all: clear of supports, and not in a fold narrower than itself.
#pragma once

#include "precompute/body.hpp"
#include "precompute/tool/tool.hpp"

namespace palpate {

/// True when a contact of `radius` (m) round frame.origin reaches a held part of the surface: no pair is planned
/// there, since the tool would press on what cannot move.
bool reaches_support(const Body& body, const ContactFrame& frame, double radius);

/// Deepest overlap (m, >= 0) of the undeformed body's surface with the tool that touches frame.origin by `vertex`.
double overlap_at_touch(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame);

/// True when the tool can touch frame.origin first: its overlap with the body's surface there is at most a fifth
/// of its radius (bumps and averaged normals), else it meets the walls of a fold before.
bool can_touch_first(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame);

}  // namespace palpate
