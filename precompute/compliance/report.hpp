// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of a baked compliance.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace palpate::compliance {

/// Error of the compliance between sites at one number of modes.
struct ComplianceError {
  int modes = 0;
  double median = 0.0, p95 = 0.0, worst = 0.0;  ///< of 3x3 blocks, over the median compliance of a site itself
};

/// Pairs of tools that were pressed at once.
struct StiffeningReport {
  double stiffening = 0.0;     ///< layout::ComplianceHead
  std::size_t pairs = 0;       ///< solved
  double error = 0.0;          ///< of what a tool loses to the other, mean, over its force alone
  double error_without = 0.0;  ///< the same with dents in proportion to the forces
  std::string cause;           ///< where no pair was solved: why
};

struct ComplianceReport {
  std::size_t nodes = 0;     ///< of the mesh
  std::size_t columns = 0;   ///< sites whose columns were solved, those left out among them
  std::size_t left_out = 0;  ///< of these, sites that the modes were not made from
  double load_radius = 0.0;  ///< m
  double self = 0.0;         ///< m/N, median compliance of a site itself under its own load
  bool reached = false;      ///< the tolerance is met
  ComplianceError chosen;
  StiffeningReport stiffening;
  std::vector<ComplianceError> errors;  ///< on the columns left out, from 0 modes to 128
};

}  // namespace palpate::compliance
