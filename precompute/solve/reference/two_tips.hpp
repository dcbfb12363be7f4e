// SPDX-License-Identifier: GPL-3.0-or-later
// Two tips of one instrument on one body: what each feels of the other, which sums of single contacts leave out.
#pragma once

#include "formats/journal/samples.hpp"
#include "precompute/common/body.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "precompute/tool/tool.hpp"

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace palpate {

struct TwoTipsPath {
  double depth = 0.0;    ///< m, of each tip from where it first touches, > 0
  double spacing = 0.0;  ///< m between the tips, > 0; closer than they are wide they are one blunter tool
  double angle = 0.0;    ///< rad, of the second tip as seen from the first, from the frame's x to its y
  int steps = 6;         ///< of the push, evenly spaced in sqrt(depth), >= 1
};

struct TwoTipsResult {
  bool usable = false;
  std::string cause;                               ///< why not
  std::array<Eigen::Vector3d, 2> alone, together;  ///< N on each tip, in the contact frame (x, y, n)
  Eigen::Vector3d beside{0, 0, 0};                 ///< m, from the place of the first tip to that of the second
  std::vector<std::array<double, 2>> pushed;       ///< m and N along n: depths and forces of the first tip alone
  double difference = 0.0;  ///< of the sums, over that of the tips alone: what adding is wrong by
  std::uint32_t nodes = 0;
};

/// Presses `vertex` at `frame`, then a second tool like it beside it, then both, without friction and on the same mesh,
/// which is fine under both. Throws Error(usage) for a path out of its ranges, never for a numerical failure.
TwoTipsResult solve_two_tips(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame,
                             const TwoTipsPath& path, const PairOptions& options);

}  // namespace palpate
