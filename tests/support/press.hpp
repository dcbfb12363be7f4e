// SPDX-License-Identifier: GPL-3.0-or-later
// One pair at the origin, through the entry point that the bake uses.
#pragma once

#include "precompute/solve/pair/pair.hpp"
#include "tests/support/bodies.hpp"

namespace palpate::test {

/// The first vertex of the scene's tool along `path` into the top of a block.
inline PairResult press(const Body& body, const ToolScene& scene, const PairPath& path, const PairOptions& options) {
  const Tool tool = make_tool(scene);
  return solve_pair({body, tool, tool.vertices[0], ContactFrame{}}, path, options);
}

}  // namespace palpate::test
