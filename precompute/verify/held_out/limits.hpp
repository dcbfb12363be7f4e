// SPDX-License-Identifier: GPL-3.0-or-later
// The limits that a user sets a verification, and what breaks them.
#pragma once

#include "precompute/verify/held_out/statistics.hpp"

#include <optional>
#include <string>

namespace palpate::verify {

struct VerifyLimits {
  std::optional<double> p95{};             ///< 95th percentile of the normal indentations' error
  std::optional<double> p95_tangential{};  ///< of the tangential pushes'
  std::optional<double> p95_spins{};      ///< of pushes at sampled pairs between their spins
  std::optional<double> refused_share{};  ///< of the held-out contacts; 0.1 where another limit is set
};

/// The broken limits, one sentence each; empty where all that are set are met. A limit on a quantity that was not
/// measured is broken, and so is any where too many contacts were refused: the solved ones are then a selection.
std::optional<std::string> broken_limits(const VerifyStatistics& statistics, const VerifyLimits& limits);

}  // namespace palpate::verify
