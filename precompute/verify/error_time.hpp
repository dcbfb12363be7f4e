// SPDX-License-Identifier: GPL-3.0-or-later
// Error against run time of a solver over mesh sizes, and the ratio of two solvers' times at equal error.
#pragma once

#include <vector>

namespace palpate::verify {

/// Solves of one problem at mesh sizes that fall by one factor.
struct SizeStudy {
  std::vector<double> sizes;                ///< relative element sizes, at least three
  std::vector<std::vector<double>> values;  ///< per size the values of a curve, not 0
  std::vector<double> seconds;              ///< per size; 0: not timed
};

struct ErrorTime {
  double order = 0.0;           ///< of convergence over the last three sizes
  bool observed = false;        ///< false: what was seen lies outside [1, 4], and order is 2 by assumption
  std::vector<double> limit;    ///< Richardson's extrapolation of every value to size 0, from the last two sizes
  std::vector<double> errors;   ///< per size: root mean square over the curve of the relative distance to the limit
  std::vector<double> seconds;  ///< per size; 0: not timed
};

/// Throws std::invalid_argument unless there are three sizes in a constant ratio.
ErrorTime error_against_time(const SizeStudy& study);

/// Times at equal error.
struct TimeRatio {
  double error = 0.0;
  double ours = 0.0, other = 0.0;  ///< s
};

/// Both curves as power laws between timed sizes, at the smallest error that both reached, at the largest, and midway
/// (geometrically). Empty where their errors have no part in common.
std::vector<TimeRatio> time_ratios(const ErrorTime& ours, const ErrorTime& other);

}  // namespace palpate::verify
