// SPDX-License-Identifier: GPL-3.0-or-later
// A contact to be solved: which body a tool touches, by which of its vertices, and where.
#pragma once

namespace palpate {
struct Body;
struct ContactFrame;
}  // namespace palpate

namespace palpate::tool {
struct Tool;
struct ToolVertex;
}  // namespace palpate::tool

namespace palpate::solve {

/// References: the objects outlive the case.
struct ContactCase {
  const Body& body;
  const tool::Tool& tool;
  const tool::ToolVertex& vertex;  ///< of the tool, or between its vertices: it touches first
  const ContactFrame& frame;  ///< of the first touch, at the body's surface
};

}  // namespace palpate::solve
