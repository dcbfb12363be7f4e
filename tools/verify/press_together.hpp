// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime's tools moved as those of a solve.
#pragma once

#include "palpate/shared/tool_set.hpp"
#include "precompute/verify/contact_checks.hpp"
#include "tools/verify/block_response.hpp"

#include <array>
#include <cstddef>

namespace palpate::cli {

/// Presses all tools of a solve as it did, from a little above, and then moves the first aside by `aside` (m). Calls
/// see(poses, ticks) in every tick.
template <int Count, class See>
void press_together(runtime::ToolSet<Count>& tools, const ContactCase& c, const verify::CheckedTogether& solved,
                    double aside, const See& see) {
  constexpr int kTicks = 400, kAbove = 20;  // of the press, of which so many before the touch
  const double depth = c.contacts[solved.contact].depth;
  const auto tick = [&](double above, double way) {
    std::array<runtime::Pose, static_cast<std::size_t>(Count)> poses;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const ContactFrame& place = solved.places[i];
      Eigen::Isometry3d pose = tool::touching_pose(c.tool.vertices.at(0), place);
      pose.translation() = solved.result.deepest[i] + above * place.n + (i == 0 ? way : 0.0) * place.x;
      poses[i] = to_pose(pose);
    }
    see(poses, tools.tick(poses));
  };
  for (int k = -kAbove; k <= kTicks; ++k) tick(depth * (1 - double(k) / kTicks), 0);
  for (int k = 1; aside > 0 && k <= kTicks; ++k) tick(0, aside * k / kTicks);
}

}  // namespace palpate::cli
