// SPDX-License-Identifier: GPL-3.0-or-later
// Fits every accepted pair, covers the others, gathers the errors.
#include "precompute/fit/fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <optional>

#include "formats/error.hpp"
#include "precompute/bake/bake.hpp"
#include "precompute/fit/coupled_degrees.hpp"
#include "precompute/fit/cover.hpp"
#include "precompute/fit/given_pairs.hpp"

namespace palpate {
namespace {

using fit::ModelScales;
using fit::PairCurves;
using fit::SiteCurves;
using SiteRow = std::vector<std::optional<SiteCurves>>;  // per site, of one tool vertex

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

ModelScales make_scales(const std::vector<const std::vector<Sample>*>& pairs, const FitSettings& settings) {
  ModelScales scales;
  scales.depth = settings.depth_scale;
  if (!settings.friction) return scales;
  for (const std::vector<Sample>* samples : pairs) {
    for (const Sample& s : *samples) {
      if (s.kind == SampleKind::tangential) scales.sideways = std::max(scales.sideways, s.deflection.head<2>().norm());
    }
  }
  if (!(scales.sideways > 0)) {
    throw Error(ExitCode::numerical, "the scene has friction, but no accepted pair has a sideways push");
  }
  return scales;
}

std::vector<float> to_floats(const Eigen::VectorXd& coefs) {
  std::vector<float> result(static_cast<std::size_t>(coefs.size()));
  for (std::size_t k = 0; k < result.size(); ++k) result[k] = static_cast<float>(coefs[static_cast<Eigen::Index>(k)]);
  return result;
}

Response to_response(const SiteCurves& site, std::uint32_t flags, const FitReport& report, const ModelScales& scales) {
  Response r;
  r.depth_limit = site.depth;
  r.flags = flags;
  r.relief = static_cast<float>(site.curves.relief);
  if (site.grasp) {
    r.grasp_depth = site.grasp->depth;
    r.grasp_pulled = site.grasp->pulled;
    r.grasp = to_floats(site.grasp->curves);
  } else if (report.grasp) {  // another tool of the scene holds on
    r.grasp.assign(layout::kGraspCurves * fit::kGraspCoefs, 0.0F);
  }
  if (site.turn) {
    r.turned = site.turn->turned;
    r.turn = to_floats(site.turn->curves);
  } else if (report.turn) {
    r.turn.assign(layout::kTurnCurves * fit::kGraspCoefs, 0.0F);
  }
  if (scales.coupled) {
    fit::Quantised quantised = fit::quantise(site.curves.coupled, *scales.coupled, scales.bits, "response");
    r.unit = quantised.unit;
    r.coupled = std::move(quantised.coefs);
    return r;
  }
  r.normal = to_floats(site.curves.normal);
  if (report.lateral) {
    r.lateral_x = to_floats(site.curves.lateral_x);
    r.lateral_y = to_floats(site.curves.lateral_y);
  }
  r.growth_x = to_floats(site.curves.growth_x);
  r.growth_y = to_floats(site.curves.growth_y);
  r.sideways_x = to_floats(site.curves.sideways_x);
  r.sideways_y = to_floats(site.curves.sideways_y);
  r.friction = to_floats(site.curves.friction);
  return r;
}

bool has_lateral_force(const std::vector<Sample>& samples, double threshold) {
  double peak = 0, lateral = 0;
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::normal) continue;
    peak = std::max(peak, s.force.z());
    lateral = std::max({lateral, std::abs(s.force.x()), std::abs(s.force.y())});
  }
  return lateral >= threshold * peak;
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
    report.lateral = report.lateral || (noisy ? has_steady_lateral_force(*samples, settings.lateral_threshold)
                                              : has_lateral_force(*samples, settings.lateral_threshold));
  }
  result.scales = make_scales(all, settings);
  report.friction = settings.friction;
  std::vector<std::uint32_t> first(tool_vertices.size() + 1, 0);
  std::partial_sum(tool_vertices.begin(), tool_vertices.end(), first.begin() + 1);

  std::vector<SiteRow> rows(first.back(), SiteRow(plan.sites.size()));
  std::vector<std::vector<std::uint32_t>> flags(
      rows.size(), std::vector<std::uint32_t>(plan.sites.size(), layout::response_covered));
  std::vector<std::pair<double, std::uint32_t>> normal, tangential, paths, grasped, turned, laws;
  std::vector<RefusedPair> refused;
  if (settings.coupled) {
    const fit::DegreeChoice choice = choose_degrees(plan, sources, exact, result.scales, report.lateral, settings);
    result.scales.coupled = choice.degrees;
    result.scales.bits = choice.bits;
    report.lateral = choice.degrees.straight > 0;  // a spring has none
    report.held_out = choice.held_out;
  }
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
    PairCurves curves;
    std::optional<fit::GraspCurves> grasp;
    std::optional<fit::TurnCurves> turn;
    try {
      curves = fit::fit_pair(solved.samples, result.scales, "fit");
      if (planned.tool < settings.grasps.size() && settings.grasps[planned.tool]) {
        grasp = fit::fit_grasp(solved.samples, result.scales.depth, "fit");
        if (planned.tool < settings.turns.size() && settings.turns[planned.tool]) {
          turn = fit::fit_turns(solved.samples, *grasp, result.scales.depth, "fit");
        }
      }
    } catch (const Error& error) {  // one odd pair is covered from its neighbours like a refused one
      refused.push_back({pair, error.what()});
      continue;
    }
    const fit::FitErrors errors = fit::fit_errors(curves, result.scales, solved.samples);
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
    report.reliefs.push_back(curves.relief);
    rows[row][planned.site] = SiteCurves{std::move(curves), planned.depth, std::move(grasp), std::move(turn)};
    flags[row][planned.site] = layout::response_solved;
  }
  check_refused(plan, report.planned, refused, settings.max_refused);
  report.refused = refused.size();
  std::sort(report.reliefs.begin(), report.reliefs.end());
  if (report.reliefs.empty() || !(report.reliefs.back() > 0)) report.reliefs.clear();
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
    fit::cover_sites(graph, frames, depths, result.scales, row, "tool vertex " + std::to_string(vertex));
    for (std::size_t site = 0; site < row.size(); ++site) {
      result.responses[site * rows.size() + vertex] =
          to_response(*row[site], flags[vertex][site], report, result.scales);
      report.covered += flags[vertex][site] == layout::response_covered ? 1 : 0;
    }
  }
  return result;
}

}  // namespace palpate
