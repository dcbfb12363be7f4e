// SPDX-License-Identifier: GPL-3.0-or-later
// Total forces of node sets, as CalculiX prints them in its .dat file.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace palpate::verify {

struct CcxTotal {
  std::string set;
  double time = 0.0;               ///< since the first step; each step lasts 1
  Eigen::Vector3d force{0, 0, 0};  ///< in the deck's unit
};

/// The totals in the order of the file. Throws Error(numerical) where a line is not what it should be: cut short, or
/// with a number that is none (ccx prints stars for what does not fit, and NaN).
std::vector<CcxTotal> read_ccx_totals(const std::string& dat);

}  // namespace palpate::verify
