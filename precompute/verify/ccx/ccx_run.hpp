// SPDX-License-Identifier: GPL-3.0-or-later
// Runs CalculiX on a deck, on one thread and under limits.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::verify {

struct CcxLimits {
  double cpu_time = 3600.0;                     ///< s of processor time
  std::size_t memory = std::size_t{12} << 30U;  ///< bytes
};

struct CcxResult {
  bool usable = false;
  std::string cause;                    ///< why not: what ccx said last, a limit, forces that do not balance
  std::vector<Eigen::Vector3d> forces;  ///< N on the tool, a step of the deck each
  int iterations = 0;                   ///< of Newton's method, in all steps
  double seconds = 0.0;                 ///< of processor time
};

/// `ccx` in one of the folders of PATH; empty where there is none.
std::filesystem::path find_ccx();

/// Runs a deck of `steps` steps (ccx_deck.hpp) in a folder of its own, which is removed. Never throws for what ccx
/// does; Error(io) where the system refuses (ccx cannot be started, no space).
CcxResult run_ccx(const std::filesystem::path& ccx, const std::string& deck, std::size_t steps,
                  const CcxLimits& limits = {});

}  // namespace palpate::verify
