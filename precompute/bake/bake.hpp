// SPDX-License-Identifier: GPL-3.0-or-later
// The bake loop: worker threads take pair after pair, samples go to the journal, a killed bake goes on.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "formats/journal/journal.hpp"
#include "precompute/solve/pair/pair.hpp"

namespace palpate::bake {

/// Solves one planned pair and hands every accepted sample to the sink; called from several threads. Must be
/// deterministic: a pair that was cut short is solved again and compared with what the journal holds.
using PairSolver = std::function<PairResult(const PairPlan&, const solve::SampleSink&)>;

struct BakeProgress {
  std::size_t total = 0;     ///< pairs in the plan
  std::size_t done = 0;      ///< finished, those of earlier runs among them
  std::size_t refused = 0;   ///< of those done
  double seconds = 0.0;      ///< since this run began
  double per_hour = 0.0;     ///< pairs an hour in this run; 0 while unknown
  double seconds_left = -1;  ///< -1 while unknown
};

struct BakeOptions {
  unsigned threads = 0;                               ///< 0: as many as the machine has cores
  std::function<void(const BakeProgress&)> progress;  ///< called by the calling thread; may be empty
  double interval = 1.0;                              ///< s between calls of progress
  std::function<bool()> stop;                         ///< true: no new pair is begun; those that run are finished
  std::function<bool(std::uint32_t)> wanted;          ///< a pair that it refuses is not solved; empty: all are
};

struct RefusedPair {
  std::uint32_t pair = 0;
  std::string cause;
};

struct BakeReport {
  std::size_t total = 0;             ///< that are wanted
  std::size_t resumed = 0;           ///< finished by earlier runs
  std::size_t accepted = 0;          ///< of all finished
  std::size_t shortened = 0;         ///< of the accepted: a tangential push ended before its last point
  std::vector<RefusedPair> refused;  ///< by pair
  std::uint64_t normal_solves = 0, tangential_solves = 0, factorisations = 0;  ///< of all finished
  std::uint64_t torn_bytes = 0;  ///< cut off the journal's tail on opening
  double seconds = 0.0;          ///< of this run
  bool stopped = false;          ///< by the stop flag, before every pair was finished

  [[nodiscard]] std::size_t finished() const { return accepted + refused.size(); }
};

/// Solves every wanted pair that has no outcome in the journal. Throws what the journal or the solver throws, and
/// Error(numerical) naming the pair when a pair solved again differs in any bit from what the journal holds.
/// Every pair that was accepted before the end or an exception is in the journal.
BakeReport bake_pairs(const std::vector<PairPlan>& pairs, const PairSolver& solve, Journal& journal,
                      const BakeOptions& options = {});

/// "pair 17 (site 5, tool 0, vertex 2)".
std::string describe(std::uint32_t pair, const PairPlan& plan);

}  // namespace palpate::bake
