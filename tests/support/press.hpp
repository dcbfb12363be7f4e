// SPDX-License-Identifier: GPL-3.0-or-later
// One pair at the origin, through the entry point that the bake uses.
#pragma once

#include "precompute/solve/pair/pair.hpp"
#include "tests/support/bodies.hpp"

namespace palpate::test {

/// The first vertex of the scene's tool along `path` into the top of a block.
inline PairResult press(const Body& body, const ToolScene& scene, const solve::PairPath& path,
                        const solve::PairOptions& options) {
  const tool::Tool tool = tool::make_tool(scene);
  return solve::solve_pair({body, tool, tool.vertices[0], ContactFrame{}}, path, options);
}

}  // namespace palpate::test
