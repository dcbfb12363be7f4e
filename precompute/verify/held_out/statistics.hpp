// SPDX-License-Identifier: GPL-3.0-or-later
// Error figures of a set of held-out contacts.
#pragma once

#include "precompute/verify/held_out/held_out.hpp"

namespace palpate::verify {

/// Relative errors of the forces of one kind of push, of torques, or of friction limits, over all of them.
struct ErrorStatistics {
  std::size_t count = 0;
  double median = 0.0, p95 = 0.0, worst = 0.0;
  std::size_t worst_contact = 0;  ///< index of the held-out contact of the worst
  double worst_depth = 0.0;       ///< m
  double within_1 = 0.0, within_2 = 0.0, within_5 = 0.0, within_10 = 0.0;  ///< share under 1, 2, 5, 10 %
};

struct VerifyStatistics {
  std::size_t contacts = 0, accepted = 0, refused = 0;
  ErrorStatistics normal, tangential, limit;
  ErrorStatistics paths;    ///< deeper or less deep under side load, followed by the model's own rule
  ErrorStatistics grasped;  ///< of tools that hold on
  ErrorStatistics turned;   ///< of their torques when they are turned
  ErrorStatistics spins;    ///< of pushes at sampled pairs between their spins, which are not among the others
};

VerifyStatistics summarise(const std::vector<HeldOut>& contacts);

/// The q-quantile (0 to 1) of values by linear interpolation between order statistics; 0 of nothing.
double quantile(std::vector<double> values, double q);

}  // namespace palpate::verify
