// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the degrees of a scene's responses: the fewest coefficients that meet the tolerance, at the samples that they
// are fitted to and at samples left out.
#pragma once

#include <functional>
#include <vector>

#include "precompute/fit/laws/pair_fit.hpp"

namespace palpate::fit {

/// Relative errors at normal and tangential samples of several pairs.
struct SampleFigures {
  std::size_t samples = 0;
  double median = 0.0, p95 = 0.0, worst = 0.0;
};

struct DegreeChoice {
  response::Degrees degrees;
  int bits = 16;           ///< of a coefficient: the fewest that add at most a tenth of the tolerance to each error
  SampleFigures held_out;  ///< at the samples left out
  bool met = false;  ///< the tolerance is met; else the degrees have the least 95th percentile
};

/// Fits every candidate to four fifths of the samples of up to 24 pairs, drawn evenly. Its error is the larger 95th
/// percentile of two: at these samples (too few coefficients miss the deepest), and at the rest (too many miss those
/// between). Its normal part is fitted alone to `pushes`, up to 240 pairs of a normal indentation alone: where they are
/// missed by more, theirs is the candidate's error. `scales`: Z and X. `bias`: normal indentations have a tangential
/// force that the responses must hold. `tolerance`: of the 95th percentile of the relative error. Pairs with too few
/// samples to leave any out get usual degrees, 16 bits and no figures. Throws Error(numerical) when no pair can be
/// fitted.
DegreeChoice choose_degrees(const std::vector<const std::vector<Sample>*>& pairs,
                            const std::vector<const std::vector<Sample>*>& pushes, ResponseScales scales, bool bias,
                            double tolerance);

/// Samples of a pair in two parts, the same for every model: those that a fit reads, and every fifth of the others.
/// The first part keeps the shallowest and the deepest normal sample and every path.
struct SampleSplit {
  std::vector<Sample> kept, left_out;
};
SampleSplit split_samples(const std::vector<Sample>& samples);

/// Force (N) at a deflection (m), both in the site's frame.
using ForceLaw = std::function<Eigen::Vector3d(const Eigen::Vector3d& deflection)>;
/// A law fitted to samples; throws Error(numerical) where it cannot be.
using LawFitter = std::function<ForceLaw(const std::vector<Sample>& samples)>;

/// Errors of a law at both parts of the samples.
struct PartFigures {
  SampleFigures fitted, left_out;
};
/// Errors of laws that `fit` fits to the kept parts. Pairs that cannot be fitted are passed over.
PartFigures part_figures(const std::vector<const std::vector<Sample>*>& pairs, const LawFitter& fit);

/// The same for the quadratic potential.
PartFigures part_figures(const std::vector<const std::vector<Sample>*>& pairs, const ResponseScales& scales);

}  // namespace palpate::fit
