// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of automatic sampling.
#pragma once

#include <cstddef>

namespace palpate::pipeline {

struct RoundLimits {
  double first_sites = 60;     ///< in the first round, on a body without margins or thin walls
  double least_edge = 0.2;     ///< of the smallest tool's radius: shorter edges are not split
  double full_share = 0.1;     ///< of the sites, that are solved in full
  std::size_t least_full = 8;  ///< sites solved in full
  std::size_t hidden = 40;     ///< hidden places of the first round
  std::size_t more = 8;        ///< of every later one
  double growth = 0.6;         ///< most edges split in a round, over the number of sites, far from the aim
  double least_growth = 0.1;   ///< the same, near it
  double aim = 0.8;            ///< of the tolerance: the 95th percentile between sites that ends the rounds; with
                               ///< fit::kFitShare, which is independent of it, 0.94
  int rounds = 12;             ///< at most
};

}  // namespace palpate::pipeline
