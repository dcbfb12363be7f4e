// SPDX-License-Identifier: GPL-3.0-or-later
// Fits every accepted pair, fills the others from neighbours, collects the errors.
#include "precompute/fit/fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <optional>

#include "formats/error.hpp"
#include "precompute/bake/bake.hpp"
#include "precompute/fit/fill.hpp"
#include "precompute/fit/given_pairs.hpp"
#include "precompute/fit/potential_degrees.hpp"

namespace palpate {
namespace {

using fit::PairResponse;
using fit::ResponseScales;
using fit::SiteResponse;
using SiteRow = std::vector<std::optional<SiteResponse>>;  // per site, of one tool vertex

const JournalPair* solved_pair(const JournalContent& journal, std::uint32_t pair) {
  const auto at = journal.pairs.find(pair);
  return at == journal.pairs.end() || !at->second.outcome ? nullptr : &at->second;
}

/// Number of the pairs to be solved. Throws where one has not been.
std::size_t check_finished(const Plan& plan, const JournalContent& journal, const PairSources& sources) {
  std::size_t open = 0, all = 0;
  for (std::uint32_t pair = 0; pair < plan.pairs.size(); ++pair) {
    if (!sources.solved(pair)) continue;
    ++all;
    open += solved_pair(journal, pair) == nullptr ? 1 : 0;
  }
  if (open > 0) {
    throw Error(ExitCode::bad_input, "the bake is not finished: " + std::to_string(open) + " of " +
                                         std::to_string(all) + " pairs have no outcome yet");
  }
  return all;
}

/// Throws with the causes, most frequent first, when more pairs are refused than allowed.
void check_refused(const Plan& plan, std::size_t planned, const std::vector<RefusedPair>& refused, double max_refused) {
  std::map<std::string, std::pair<std::size_t, std::string>> causes;  // text without figures: count, first pair
  for (const RefusedPair& pair : refused) {
    auto& [count, example] = causes[pair.cause.substr(0, pair.cause.find_first_of("0123456789"))];
    if (++count == 1) example = describe(pair.pair, plan.pairs[pair.pair]) + ": " + pair.cause;
  }
  const double share = static_cast<double>(refused.size()) / static_cast<double>(std::max<std::size_t>(planned, 1));
  if (share <= max_refused) return;
  std::vector<std::pair<std::size_t, std::string>> sorted;
  for (const auto& [kind, entry] : causes) sorted.push_back(entry);
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  char percent[64];
  std::snprintf(percent, sizeof percent, "%.1f %%, allowed %.1f %%", 100 * share, 100 * max_refused);
  std::string text = std::to_string(refused.size()) + " of " + std::to_string(planned) + " pairs were refused (" +
                     percent + "; scene: sampling.max_refused):";
  for (std::size_t k = 0; k < std::min<std::size_t>(sorted.size(), 8); ++k) {
    text += "\n  " + std::to_string(sorted[k].first) + " like " + sorted[k].second;
  }
  throw Error(ExitCode::numerical, text);
}

ResponseScales make_scales(const std::vector<const std::vector<Sample>*>& pairs, const FitSettings& settings) {
  ResponseScales scales;
  scales.depth = settings.depth_scale;
  if (!settings.friction) return scales;
  for (const std::vector<Sample>* samples : pairs) {
    for (const Sample& s : *samples) {
      if (s.kind == SampleKind::tangential) {
        scales.tangential = std::max(scales.tangential, s.deflection.head<2>().norm());
      }
    }
  }
  if (!(scales.tangential > 0)) {
    throw Error(ExitCode::numerical, "the scene has friction, but no accepted pair has a tangential push");
  }
  return scales;
}

std::vector<float> to_floats(const Eigen::VectorXd& coefs) {
  std::vector<float> result(static_cast<std::size_t>(coefs.size()));
  for (std::size_t k = 0; k < result.size(); ++k) result[k] = static_cast<float>(coefs[static_cast<Eigen::Index>(k)]);
  return result;
}

Response to_response(const SiteResponse& site, std::uint32_t flags, const FitReport& report,
                     const ResponseScales& scales) {
  Response r;
  r.depth_limit = site.depth;
  r.flags = flags;
  r.softening = static_cast<float>(site.response.softening);
  fit::Quantised quantised = fit::quantise(site.response.coefs, scales.degrees, scales.bits, "response");
  r.unit = quantised.unit;
  r.coefficients = std::move(quantised.coefs);
  if (site.grasp) {
    r.bonded_depth = site.grasp->depth;
    r.bonded_pulled = site.grasp->pulled;
    r.bonded = to_floats(site.grasp->curves);
  } else if (report.grasp) {  // another tool of the scene bonds
    r.bonded.assign(layout::kBondedCurves * fit::kGraspCoefs, 0.0F);
  }
  if (site.turn) {
    r.rotated = site.turn->turned;
    r.bonded_torque = to_floats(site.turn->curves);
  } else if (report.turn) {
    r.bonded_torque.assign(layout::kTorqueCurves * fit::kGraspCoefs, 0.0F);
  }
  return r;
}

bool has_bias(const std::vector<Sample>& samples, double threshold) {
  double peak = 0, bias = 0;
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::normal) continue;
    peak = std::max(peak, s.force.z());
    bias = std::max({bias, std::abs(s.force.x()), std::abs(s.force.y())});
  }
  return bias >= threshold * peak;
}

PairFigures pair_figures(std::uint32_t pair, const fit::FitErrors& errors) {
  std::vector<std::pair<double, std::uint32_t>> all;
  for (const double e : errors.normal) all.emplace_back(e, pair);
  for (const double e : errors.tangential) all.emplace_back(e, pair);
  const ErrorFigures figures = error_figures(all);
  return {pair, figures.median, figures.p95, figures.worst};
}

std::string residual_cause(double worst, double allowed) {
  char text[120];
  std::snprintf(text, sizeof text, "fit: misses a force by %.3g %%, allowed %.3g %% (scene: response.max_residual)",
                100 * worst, 100 * allowed);
  return text;
}

}  // namespace

ErrorFigures error_figures(const std::vector<std::pair<double, std::uint32_t>>& errors) {
  ErrorFigures figures;
  figures.samples = errors.size();
  if (errors.empty()) return figures;
  std::vector<std::pair<double, std::uint32_t>> sorted = errors;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  figures.median = n % 2 == 1 ? sorted[n / 2].first : 0.5 * (sorted[n / 2 - 1].first + sorted[n / 2].first);
  figures.p95 = sorted[(95 * n + 99) / 100 - 1].first;
  figures.worst = sorted.back().first;
  figures.worst_pair = sorted.back().second;
  return figures;
}

FittedResponses fit_responses(const Plan& plan, const std::vector<std::array<std::int32_t, 3>>& triangles,
                              const std::vector<std::uint32_t>& tool_vertices, const JournalContent& journal,
                              const FitSettings& settings, const PairSources& sources) {
  FittedResponses result;
  FitReport& report = result.report;
  report.planned = check_finished(plan, journal, sources);
  check_given(plan, sources, settings.friction);
  std::vector<const std::vector<Sample>*> all, exact;
  for (std::uint32_t pair = 0; pair < plan.pairs.size(); ++pair) {
    const std::vector<Sample>* samples = samples_of(pair, journal, sources);
    if (samples == nullptr) continue;
    const auto given = sources.given.find(pair);
    const bool noisy = given != sources.given.end() && given->second.measured;
    all.push_back(samples);
    if (!noisy) exact.push_back(samples);
    report.bias = report.bias || (noisy ? has_steady_bias(*samples, settings.bias_threshold)
                                        : has_bias(*samples, settings.bias_threshold));
  }
  result.scales = make_scales(all, settings);
  report.friction = settings.friction;
  std::vector<std::uint32_t> first(tool_vertices.size() + 1, 0);
  std::partial_sum(tool_vertices.begin(), tool_vertices.end(), first.begin() + 1);

  std::vector<SiteRow> rows(first.back(), SiteRow(plan.sites.size()));
  std::vector<std::vector<std::uint32_t>> flags(
      rows.size(), std::vector<std::uint32_t>(plan.sites.size(), layout::response_filled));
  std::vector<std::pair<double, std::uint32_t>> normal, tangential, paths, grasped, turned, laws;
  std::vector<RefusedPair> refused;
  const fit::DegreeChoice choice = choose_degrees(plan, sources, exact, result.scales, report.bias, settings);
  result.scales.degrees = choice.degrees;
  result.scales.bits = choice.bits;
  report.bias = choice.degrees.bias > 0;
  report.held_out = choice.held_out;
  for (std::uint32_t pair = 0; pair < plan.pairs.size(); ++pair) {
    const PairPlan& planned = plan.pairs[pair];
    const std::uint32_t row = first[planned.tool] + planned.tool_vertex;
    if (const auto given = sources.given.find(pair); given != sources.given.end()) {
      rows[row][planned.site] = fit_given(plan, pair, given->second, result.scales, report, laws);
      flags[row][planned.site] = given->second.measured ? layout::response_measured : layout::response_analytic;
      continue;
    }
    if (!sources.solved(pair)) continue;
    const JournalPair& solved = *solved_pair(journal, pair);
    if (!solved.outcome->accepted) {
      refused.push_back({pair, solved.outcome->cause});
      continue;
    }
    PairResponse response;
    std::optional<fit::GraspCurves> grasp;
    std::optional<fit::TurnCurves> turn;
    try {
      response = fit::fit_pair(solved.samples, result.scales, "fit");
      if (planned.tool < settings.grasps.size() && settings.grasps[planned.tool]) {
        grasp = fit::fit_grasp(solved.samples, result.scales.depth, "fit");
        if (planned.tool < settings.turns.size() && settings.turns[planned.tool]) {
          turn = fit::fit_turns(solved.samples, *grasp, result.scales.depth, "fit");
        }
      }
    } catch (const Error& error) {  // filled from neighbours like a refused pair
      refused.push_back({pair, error.what()});
      continue;
    }
    const fit::FitErrors errors = fit::fit_errors(response, result.scales, solved.samples);
    const PairFigures figures = pair_figures(pair, errors);
    if (!(figures.worst <= settings.max_residual)) {
      refused.push_back({pair, residual_cause(figures.worst, settings.max_residual)});
      continue;
    }
    ++report.accepted;
    if (!solved.outcome->cause.empty()) ++report.shortened;
    for (const double e : errors.normal) normal.emplace_back(e, pair);
    for (const double e : errors.tangential) tangential.emplace_back(e, pair);
    for (const double e : errors.paths) paths.emplace_back(e, pair);
    if (grasp) {
      const std::vector<double> own = fit::grasp_errors(*grasp, result.scales.depth, solved.samples);
      for (const double e : own) grasped.emplace_back(e, pair);
      report.grasp = true;
    }
    if (turn) {
      for (const double e : fit::turn_errors(*grasp, *turn, result.scales.depth, solved.samples)) {
        turned.emplace_back(e, pair);
      }
      report.turn = true;
    }
    report.pairs.push_back(figures);
    report.softenings.push_back(response.softening);
    rows[row][planned.site] = SiteResponse{std::move(response), planned.depth, std::move(grasp), std::move(turn)};
    flags[row][planned.site] = layout::response_solved;
  }
  check_refused(plan, report.planned, refused, settings.max_refused);
  report.refused = refused.size();
  std::sort(report.softenings.begin(), report.softenings.end());
  if (report.softenings.empty() || !(report.softenings.back() > 0)) report.softenings.clear();
  report.normal = error_figures(normal);
  report.tangential = error_figures(tangential);
  report.paths = error_figures(paths);
  report.grasped = error_figures(grasped);
  report.turned = error_figures(turned);
  report.laws = error_figures(laws);
  for (const SkippedPair& pair : plan.skipped) {
    ++(pair.reason == SkipReason::support       ? report.support
       : pair.reason == SkipReason::unreachable ? report.unreachable
                                                : report.outside);
  }

  std::vector<ContactFrame> frames;
  std::vector<double> depths;
  for (const PlanSite& site : plan.sites) {
    frames.push_back(site.frame);
    depths.push_back(site.depth);
  }
  const fit::SiteGraph graph = fit::site_graph(plan.sites.size(), triangles);
  result.responses.resize(plan.sites.size() * rows.size());
  for (std::size_t vertex = 0; vertex < rows.size(); ++vertex) {
    SiteRow& row = rows[vertex];
    fit::fill_from_neighbours(graph, frames, depths, result.scales, row, "tool vertex " + std::to_string(vertex));
    for (std::size_t site = 0; site < row.size(); ++site) {
      result.responses[site * rows.size() + vertex] =
          to_response(*row[site], flags[vertex][site], report, result.scales);
      report.filled += flags[vertex][site] == layout::response_filled ? 1 : 0;
    }
  }
  return result;
}

}  // namespace palpate
