// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/laws/pair_fit.hpp"

#include "precompute/fit/laws/pair_samples.hpp"
#include "precompute/fit/laws/path_errors.hpp"
#include "precompute/fit/laws/slip_softening.hpp"

namespace palpate::fit {

PairResponse fit_pair(const std::vector<Sample>& samples, const ResponseScales& scales, const std::string& what) {
  PairResponse response;
  response.coefs = fit_potential(samples, scales, what);
  const Potential potential(response.coefs, scales);
  const auto sticking = [&](const Eigen::Vector3d& deflection) { return potential.force(deflection); };
  response.softening = slip_softening(samples, sticking, scales.depth);
  // Errors are those of the file. Rounding to 16 bits changes none of their digits.
  if (scales.bits < 16) response.coefs = rounded(response.coefs, scales.degrees, scales.bits, what);
  return response;
}

FitErrors fit_errors(const PairResponse& response, const ResponseScales& scales, const std::vector<Sample>& samples) {
  FitErrors errors;
  const PairSamples data = sort_samples(samples, "errors");
  const Potential potential(response.coefs, scales);
  const auto error = [&](const Sample* s) {
    return (potential.force(s->deflection) - s->force).norm() * data.weight(*s);
  };
  for (const Sample* s : data.normal) errors.normal.push_back(error(s));
  for (const Sample* s : data.tangential) errors.tangential.push_back(error(s));
  if (!scales.friction()) return errors;
  errors.paths = path_errors(
      samples, data, [&](const Eigen::Vector2d& e, double depth) { return potential.force(e, depth); },
      [&](double from, double to, const Eigen::Vector2d& e) { return potential.deepened(from, to, e); });
  return errors;
}

}  // namespace palpate::fit
