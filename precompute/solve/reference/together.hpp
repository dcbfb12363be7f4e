// SPDX-License-Identifier: GPL-3.0-or-later
// Several tools like each other on one body at once: the force of each in the dents of the others.
#pragma once

#include "formats/journal/samples.hpp"
#include "precompute/common/body.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "precompute/tool/tool.hpp"

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace palpate::solve {

struct TogetherPath {
  std::vector<ContactFrame>
      places;             ///< of the tools, at least one; nearer than they are wide they are one blunter tool
  double depth = 0.0;     ///< m, of each tool from where it first touches along its n, > 0
  int steps = 6;          ///< of the push, evenly spaced in sqrt(depth), >= 1
  bool sticking = false;  ///< the contacts stick; else they have no friction
  double aside = 0.0;     ///< m, of the first tool along its x once all are down; > 0 only where they stick
  double alone_depth = 0.0;  ///< m: single tools go on to this depth in a last step, if it is more than `depth`
};

/// A node of the body's surface.
struct SurfaceNode {
  Eigen::Vector3d rest{0, 0, 0}, moved{0, 0, 0};  ///< m, before any contact and at the end
};

struct TogetherResult {
  bool usable = false;
  std::string cause;                             ///< why not
  /// N on each tool at the end, in its own frame (x, y, n), without the compliance of the contact's penalty, as in a
  /// bake: each tool was pressed deeper by that.
  std::vector<Eigen::Vector3d> alone, together;
  std::vector<Eigen::Vector3d> deepest;  ///< m, translation of each tool at its depth, before it goes aside
  /// m and N along n: depths and forces at the steps of the push, of each tool alone and of each with the others; the
  /// last is the end, that of a tool alone at path.alone_depth.
  std::vector<std::vector<std::array<double, 2>>> pushed_alone, pushed_together;
  std::vector<SurfaceNode> surface;              ///< with all tools
  double difference = 0.0;  ///< of the sums of normal forces, over those of the tools alone: error of adding them
  std::uint32_t nodes = 0;
};

/// Presses `vertex` of a tool at each place alone, then at all at once, on one mesh, which is fine under all. Throws
/// Error(usage) for a path out of its ranges, never for a numerical failure.
TogetherResult solve_together(const Body& body, const tool::Tool& tool, const tool::ToolVertex& vertex,
                              const TogetherPath& path, const PairOptions& options);

}  // namespace palpate::solve
