// SPDX-License-Identifier: GPL-3.0-or-later
// Requirements of recordings and laws on the tool that they name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/io/error.hpp"
#include "precompute/tool/tool.hpp"

namespace palpate::bake {

/// The index of a scene's tool. Throws Error(bad_input) "where: ..." where there is none of that name.
inline std::uint32_t find_tool(const std::vector<tool::Tool>& tools, const std::string& name,
                               const std::string& where) {
  std::string all;
  for (std::uint32_t k = 0; k < tools.size(); ++k) {
    if (tools[k].name == name) return k;
    all.append(k == 0 ? "'" : ", '").append(tools[k].name).append("'");
  }
  throw Error(ExitCode::bad_input, where + ": there is no tool '" + name + "'; the scene has " + all);
}

/// Throws Error(bad_input) "where: ..." for a tool that holds on.
inline void refuse_grasps(const tool::Tool& tool, const std::string& where) {
  if (!(tool.scene.grasp_depth > 0)) return;
  throw Error(ExitCode::bad_input,
              where + ": the tool '" + tool.name + "' holds on (grasp_depth): how it is pulled has to be solved");
}

}  // namespace palpate::bake
