// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/laws/pair_samples.hpp"

#include <algorithm>
#include <cmath>

#include "formats/io/error.hpp"

namespace palpate::fit {
namespace {

constexpr double floor_share = 0.02;  // of the peak force, below which errors count absolutely

}  // namespace

double PairSamples::weight(const Sample& sample) const {
  return sample.weight / std::max(sample.force.norm(), floor_share * peak);
}

PairSamples sort_samples(const std::vector<Sample>& samples, const std::string& what) {
  PairSamples data;
  for (const Sample& sample : samples) {
    if (!sample.force.allFinite() || !sample.deflection.allFinite() || !std::isfinite(sample.friction_limit)) {
      throw Error(ExitCode::numerical, what + ": sample " + std::to_string(sample.index) + " is not finite");
    }
    if (sample.kind == SampleKind::normal) data.normal.push_back(&sample);
    if (sample.kind == SampleKind::tangential) data.tangential.push_back(&sample);
  }
  std::stable_sort(data.normal.begin(), data.normal.end(),
                   [](const Sample* a, const Sample* b) { return a->deflection.z() < b->deflection.z(); });
  for (const Sample* sample : data.normal) data.peak = std::max(data.peak, sample->force.norm());
  if (data.normal.size() < 2 || !(data.normal.front()->deflection.z() > 0) || !(data.peak > 0)) {
    throw Error(ExitCode::numerical,
                what + ": a fit needs at least two normal indentations deeper than 0 with a force; there are " +
                    std::to_string(data.normal.size()));
  }
  return data;
}

}  // namespace palpate::fit
