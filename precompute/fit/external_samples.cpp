// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fit/external_samples.hpp"

#include <algorithm>
#include <cmath>

#include "formats/io/error.hpp"
#include "formats/journal/journal.hpp"
#include "precompute/bake/bake.hpp"
#include "precompute/bake/plan.hpp"
#include "precompute/fit/closed_form.hpp"
#include "precompute/fit/fit.hpp"
#include "precompute/fit/laws/recorded_fit.hpp"

namespace palpate::fit {
namespace {

using SampleList = std::vector<Sample>;

constexpr std::size_t kDrawn = 12;  // by which degrees are chosen: recorded pairs, and others beside them

std::string name_of(const bake::Plan& plan, std::uint32_t pair, const ExternalSamples& external) {
  const std::string where = external.rows.empty() ? "" : external.rows.front() + ": ";  // the first of the contact
  return where + (external.measured ? "recorded " : "closed form, ") + bake::describe(pair, plan.pairs[pair]);
}

/// Runs `action`. If it refuses a recording, the ignored rows are added to the message: they may be the cause.
template <class Action>
auto telling_passed(const ExternalSamples& external, const Action& action) {
  try {
    return action();
  } catch (const Error& error) {
    if (external.passed.total() == 0) throw;
    throw Error(error.code(), std::string(error.what()) + "; " + to_text(external.passed));
  }
}

RecordedFit fit_rows(const bake::Plan& plan, std::uint32_t pair, const ExternalSamples& external,
                     const ResponseScales& scales) {
  return telling_passed(external, [&] {
    return fit_recorded(external.samples, plan.pairs[pair].depth, scales, name_of(plan, pair, external));
  });
}

/// Samples of a bake's path from a fit of many coefficients, as deep and as far aside as the recording went.
SampleList smoothed(const bake::Plan& plan, std::uint32_t pair, const ExternalSamples& external, ResponseScales scales,
                    bool bias, const FitSettings& settings) {
  scales.degrees = {5, bias ? 4 : 0, 3, 3, true};
  if (!scales.friction()) scales.degrees = {response::kMaxDegree, bias ? 4 : 0, 0, 0, false};
  const RecordedFit fitted = fit_rows(plan, pair, external, scales);
  double aside = 0;
  for (const Sample& s : external.samples) {
    if (s.kind == SampleKind::tangential) aside = std::max(aside, s.deflection.head<2>().norm());
  }
  solve::PairPath path = settings.path(fitted.depth);
  path.tangential_reach = std::min(path.tangential_reach, aside / fitted.depth);
  const Potential potential(fitted.response.coefs, scales);
  return sample_along(path, [&](const Eigen::Vector3d& deflection) { return potential.force(deflection); });
}

/// At most kDrawn of a list, evenly.
template <class T>
std::vector<T> drawn(const std::vector<T>& list) {
  const std::size_t count = std::min(kDrawn, list.size());
  std::vector<T> result;
  for (std::size_t k = 0; k < count; ++k) result.push_back(list[k * list.size() / count]);
  return result;
}

}  // namespace

std::string to_text(const Passed& passed) {
  std::string text = std::to_string(passed.total()) + " rows passed over: " + std::to_string(passed.out) +
                     " not in contact, " + std::to_string(passed.deep) + " deeper than sampling.depth, " +
                     std::to_string(passed.aside) + " too far aside";
  if (passed.weightless > 0) text += ", " + std::to_string(passed.weightless) + " of weight 0";
  return text;
}

ExternalCounts count_external(const PairSources& sources) {
  ExternalCounts counts;
  for (const auto& [pair, external] : sources.external) ++(external.measured ? counts.measured : counts.analytic);
  return counts;
}

const SampleList* samples_of(std::uint32_t pair, const JournalContent& journal, const PairSources& sources) {
  if (const auto external = sources.external.find(pair); external != sources.external.end())
    return &external->second.samples;
  if (!sources.solved(pair)) return nullptr;
  const JournalPair& solved = journal.pairs.at(pair);
  return solved.outcome->accepted ? &solved.samples : nullptr;
}

bool has_steady_bias(const std::vector<Sample>& samples, double threshold) {
  std::vector<double> depths;
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::normal) depths.push_back(s.deflection.z());
  }
  const auto median = [](std::vector<double>& list) {
    const auto middle = list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2);
    std::nth_element(list.begin(), middle, list.end());
    return *middle;
  };
  if (depths.empty()) return false;
  const double from = median(depths);
  std::vector<double> force[3];
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::normal || s.deflection.z() < from) continue;
    for (int k = 0; k < 3; ++k) force[k].push_back(s.force[k]);
  }
  return std::max(std::abs(median(force[0])), std::abs(median(force[1]))) >= threshold * std::abs(median(force[2]));
}

void check_external(const bake::Plan& plan, const PairSources& sources, bool friction) {
  for (const auto& [pair, external] : sources.external) {
    if (!external.measured) continue;
    const std::string what = name_of(plan, pair, external);
    telling_passed(external, [&, pair = pair, &external = external] {
      check_recorded(external.samples, plan.pairs[pair].depth, friction, what);
    });
  }
}

DegreeChoice choose_degrees(const bake::Plan& plan, const PairSources& sources,
                            const std::vector<const SampleList*>& exact, const std::vector<const SampleList*>& pushes,
                            const ResponseScales& scales, bool bias, const FitSettings& settings) {
  const double tolerance = kFitShare * settings.tolerance;
  std::vector<std::uint32_t> recorded;
  for (const auto& [pair, external] : sources.external) {
    if (external.measured) recorded.push_back(pair);
  }
  if (recorded.empty()) return choose_degrees(exact, pushes, scales, bias, tolerance);
  std::vector<SampleList> smooth;
  for (const std::uint32_t pair : drawn(recorded)) {
    smooth.push_back(smoothed(plan, pair, sources.external.at(pair), scales, bias, settings));
  }
  std::vector<const SampleList*> pairs = drawn(exact);
  for (const SampleList& samples : smooth) pairs.push_back(&samples);
  return choose_degrees(pairs, pushes, scales, bias, tolerance);
}

SiteResponse fit_external(const bake::Plan& plan, std::uint32_t pair, const ExternalSamples& external,
                          const ResponseScales& scales, FitReport& report,
                          std::vector<std::pair<double, std::uint32_t>>& laws) {
  const PairPlan& planned = plan.pairs[pair];
  if (!external.measured) {
    SiteResponse site{fit_pair(external.samples, scales, name_of(plan, pair, external)), planned.depth, {}, {}};
    const FitErrors errors = fit_errors(site.response, scales, external.samples);
    for (const auto* list : {&errors.normal, &errors.tangential}) {
      for (const double e : *list) laws.emplace_back(e, pair);
    }
    ++report.analytic;
    return site;
  }
  RecordedFit fitted = fit_rows(plan, pair, external, scales);
  RecordedFigures& figures = report.recorded.emplace_back();
  figures = {pair, external.rows.size(), {}, fitted.rms, fitted.worst, fitted.depth, external.passed};
  for (const std::size_t k : fitted.outliers) figures.outliers.push_back(external.rows[k]);
  return {std::move(fitted.response), fitted.depth, {}, {}};
}

}  // namespace palpate::fit
