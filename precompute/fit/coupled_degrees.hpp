// SPDX-License-Identifier: GPL-3.0-or-later
// Which order and degrees of the coupled model a scene needs: the fewest coefficients that answer samples left out.
#pragma once

#include <functional>
#include <vector>

#include "precompute/fit/pair_fit.hpp"

namespace palpate::fit {

struct DegreeWish {
  int order = 0;            ///< 2 to 4; 0: the least that does
  double tolerance = 0.05;  ///< of the 95th percentile of the relative error at samples left out
  bool spring = false;      ///< coupled::kSpring, whatever its error
};

/// Relative errors at samples left out: of straight and sideways pushes, over a draw of the pairs.
struct HeldOutFigures {
  std::size_t samples = 0;
  double median = 0.0, p95 = 0.0, worst = 0.0;
};

struct DegreeChoice {
  coupled::Degrees degrees;
  int bits = 16;  ///< of a coefficient: the fewest that add no more than a tenth of the tolerance to the error
  HeldOutFigures held_out;
  bool met = false;  ///< the tolerance; else the degrees are the ones of least 95th percentile
};

/// Fits every candidate to four fifths of the samples of up to 24 pairs, drawn evenly, and compares it with the rest.
/// `lateral`: straight pushes push sideways, and the law has to say so. Throws Error(numerical) when not one of the
/// pairs can be fitted.
DegreeChoice choose_degrees(const std::vector<const std::vector<Sample>*>& pairs, ModelScales scales, bool lateral,
                            const DegreeWish& wish);

/// Samples of a pair in two parts, the same ones for every model: what a fit may read, and every fifth of the others.
/// The shallowest and the deepest straight push and every path are kept by the first.
struct SampleSplit {
  std::vector<Sample> kept, left_out;
};
SampleSplit split_samples(const std::vector<Sample>& samples);

/// Force (N) at a deflection (m), both in the site's frame.
using ForceLaw = std::function<Eigen::Vector3d(const Eigen::Vector3d& deflection)>;
/// A law fitted to samples; throws Error(numerical) where it cannot be.
using LawFitter = std::function<ForceLaw(const std::vector<Sample>& samples)>;

/// Errors of what `fit` makes of the kept parts at the parts left out. Pairs that cannot be fitted are passed over.
HeldOutFigures held_out_figures(const std::vector<const std::vector<Sample>*>& pairs, const LawFitter& fit);

/// The same of a response model.
HeldOutFigures held_out_figures(const std::vector<const std::vector<Sample>*>& pairs, const ModelScales& model);

}  // namespace palpate::fit
