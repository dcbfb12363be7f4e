// SPDX-License-Identifier: GPL-3.0-or-later
// Fits every accepted pair, fills the others from neighbours, collects the errors.
#include "precompute/fit/fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "formats/io/error.hpp"
#include "precompute/bake/bake.hpp"
#include "precompute/fit/carry.hpp"
#include "precompute/fit/external_samples.hpp"
#include "precompute/fit/fill.hpp"
#include "precompute/fit/laws/potential_degrees.hpp"
#include "precompute/fit/push_field.hpp"

namespace palpate::fit {
namespace {

using SiteRow = std::vector<std::optional<SiteResponse>>;  // per site, of one tool vertex

const JournalPair* solved_pair(const JournalContent& journal, std::uint32_t pair) {
  const auto at = journal.pairs.find(pair);
  return at == journal.pairs.end() || !at->second.outcome ? nullptr : &at->second;
}

/// Number of the pairs to be solved. Throws where one has not been.
std::size_t check_finished(const bake::Plan& plan, const JournalContent& journal, const PairSources& sources) {
  std::size_t open = 0, all = 0;
  for (std::uint32_t pair = 0; pair < plan.pairs.size(); ++pair) {
    if (!sources.solved(pair) || plan.pairs[pair].role == PairRole::hidden) continue;
    ++all;
    open += solved_pair(journal, pair) == nullptr ? 1 : 0;
  }
  if (open > 0) {
    throw Error(ExitCode::bad_input, "the bake is not finished: " + std::to_string(open) + " of " +
                                         std::to_string(all) + " pairs have no outcome yet");
  }
  return all;
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
  Quantised quantised = quantise(site.response.coefs, scales.degrees, scales.bits, "response");
  r.unit = quantised.unit;
  r.coefficients = std::move(quantised.coefs);
  if (site.grasp) {
    r.bonded_depth = site.grasp->depth;
    r.bonded_pulled = site.grasp->pulled;
    r.bonded = to_floats(site.grasp->curves);
  } else if (report.grasp) {  // another tool of the scene bonds
    r.bonded.assign(layout::kBondedCurves * kGraspCoefs, 0.0F);
  }
  if (site.turn) {
    r.rotated = site.turn->turned;
    r.bonded_torque = to_floats(site.turn->curves);
  } else if (report.turn) {
    r.bonded_torque.assign(layout::kTorqueCurves * kGraspCoefs, 0.0F);
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

PairFigures pair_figures(std::uint32_t pair, const FitErrors& errors) {
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

using RowErrors = std::vector<std::pair<double, std::uint32_t>>;  // relative error, pair

/// One fit of a plan: responses by tool vertex (row) and site.
class PlanFit {
public:
  PlanFit(const bake::Plan& plan, const std::vector<std::array<std::int32_t, 3>>& triangles,
          const std::vector<std::uint32_t>& tool_vertices, const JournalContent& journal, const FitSettings& settings,
          const PairSources& sources)
      : plan_(plan), triangles_(triangles), journal_(journal), settings_(settings), sources_(sources) {
    first_.assign(tool_vertices.size() + 1, 0);
    std::partial_sum(tool_vertices.begin(), tool_vertices.end(), first_.begin() + 1);
    rows_.assign(first_.back(), SiteRow(plan.sites.size()));
    flags_.assign(first_.back(), std::vector<std::uint32_t>(plan.sites.size(), layout::response_filled));
  }

  FittedResponses run() {
    report_.planned = check_finished(plan_, journal_, sources_);
    report_.friction = settings_.friction;
    check_external(plan_, sources_, settings_.friction);
    choose_law();
    for (std::uint32_t pair = 0; pair < plan_.pairs.size(); ++pair) fit_one(pair);
    for (std::uint32_t row = 0; row < rows_.size(); ++row) carry(row);
    report_refusals();
    report_errors();
    fill();
    return std::move(result_);
  }

private:
  [[nodiscard]] std::uint32_t row_of(const PairPlan& pair) const { return first_[pair.tool] + pair.tool_vertex; }

  /// Scales and degrees, from the pairs that were solved in full or have external samples, and normal indentations.
  void choose_law() {
    std::vector<const std::vector<Sample>*> all, exact, pushes;
    for (std::uint32_t pair = 0; pair < plan_.pairs.size(); ++pair) {
      if (plan_.pairs[pair].role == PairRole::hidden) continue;
      const std::vector<Sample>* samples = samples_of(pair, journal_, sources_);
      if (samples == nullptr) continue;
      const auto external = sources_.external.find(pair);
      const bool noisy = external != sources_.external.end() && external->second.measured;
      report_.bias = report_.bias || (noisy ? has_steady_bias(*samples, settings_.bias_threshold)
                                            : has_bias(*samples, settings_.bias_threshold));
      const bool solved = external == sources_.external.end();
      if (solved && (plan_.pairs[pair].role == PairRole::normal || normal_alone(*samples))) {
        pushes.push_back(samples);
        continue;
      }
      all.push_back(samples);
      if (!noisy) exact.push_back(samples);
    }
    if (all.empty()) refuse_all();
    result_.scales = make_scales(all, settings_);
    if (result_.scales.friction() != settings_.friction) refuse_all();
    const DegreeChoice choice = choose_degrees(plan_, sources_, exact, pushes, result_.scales, report_.bias, settings_);
    result_.scales.degrees = choice.degrees;
    result_.scales.bits = choice.bits;
    report_.bias = choice.degrees.bias > 0;
    report_.held_out = choice.held_out;
  }

  /// A contact whose tangential pushes found no answer although there is friction.
  [[nodiscard]] bool normal_alone(const std::vector<Sample>& samples) const {
    return settings_.friction && std::none_of(samples.begin(), samples.end(),
                                              [](const Sample& s) { return s.kind == SampleKind::tangential; });
  }

  [[noreturn]] void refuse_all() const {
    std::vector<bake::RefusedPair> refused;
    for (const auto& [pair, solved] : journal_.pairs) {
      if (solved.outcome && !solved.outcome->cause.empty()) refused.push_back({pair, solved.outcome->cause});
    }
    throw Error(ExitCode::numerical,
                "nothing to make a response file of: no pair was solved with all paths of the scene\n" +
                    to_text(group_refusals(plan_, refused)));
  }

  void fit_one(std::uint32_t pair) {
    const PairPlan& planned = plan_.pairs[pair];
    const std::uint32_t row = row_of(planned);
    if (const auto external = sources_.external.find(pair); external != sources_.external.end()) {
      rows_[row][planned.site] = fit_external(plan_, pair, external->second, result_.scales, report_, laws_);
      flags_[row][planned.site] = external->second.measured ? layout::response_measured : layout::response_analytic;
      return;
    }
    if (!sources_.solved(pair) || planned.role == PairRole::hidden) return;
    const JournalPair& solved = *solved_pair(journal_, pair);
    if (!solved.outcome->accepted) {
      refused_.push_back({pair, solved.outcome->cause});
      return;
    }
    if (planned.role == PairRole::normal) {
      alone_.insert(pair);
      ++report_.accepted;
    } else if (normal_alone(solved.samples)) {
      alone_.insert(pair);
      ++report_.accepted;
      ++report_.shortened;
    } else {
      fit_full(pair, solved);
    }
  }

  void fit_full(std::uint32_t pair, const JournalPair& solved) {
    const PairPlan& planned = plan_.pairs[pair];
    const std::uint32_t row = row_of(planned);
    PairResponse response;
    std::optional<GraspCurves> grasp;
    std::optional<TurnCurves> turn;
    try {
      response = fit_pair(solved.samples, result_.scales, "fit");
      if (planned.tool < settings_.grasps.size() && settings_.grasps[planned.tool]) {
        grasp = fit_grasp(solved.samples, result_.scales.depth, "fit");
        if (planned.tool < settings_.turns.size() && settings_.turns[planned.tool]) {
          turn = fit_turns(solved.samples, *grasp, result_.scales.depth, "fit");
        }
      }
    } catch (const Error& error) {  // filled from neighbours like a refused pair
      refused_.push_back({pair, error.what()});
      return;
    }
    const FitErrors errors = fit_errors(response, result_.scales, solved.samples);
    const PairFigures figures = pair_figures(pair, errors);
    if (!(figures.worst <= settings_.max_residual)) {
      refused_.push_back({pair, residual_cause(figures.worst, settings_.max_residual)});
      return;
    }
    ++report_.accepted;
    ++report_.full;
    if (!solved.outcome->cause.empty()) ++report_.shortened;
    for (const double e : errors.normal) normal_.emplace_back(e, pair);
    for (const double e : errors.tangential) tangential_.emplace_back(e, pair);
    for (const double e : errors.paths) paths_.emplace_back(e, pair);
    if (grasp) {
      const std::vector<double> own = grasp_errors(*grasp, result_.scales.depth, solved.samples);
      for (const double e : own) grasped_.emplace_back(e, pair);
      report_.grasp = true;
    }
    if (turn) {
      for (const double e : turn_errors(*grasp, *turn, result_.scales.depth, solved.samples)) {
        turned_.emplace_back(e, pair);
      }
      report_.turn = true;
    }
    report_.pairs.push_back(figures);
    report_.softenings.push_back(response.softening);
    rows_[row][planned.site] = SiteResponse{std::move(response), planned.depth, std::move(grasp), std::move(turn)};
    flags_[row][planned.site] = layout::response_solved;
  }

  /// The normal indentations of a tool vertex in as many steps, by site: the pairs planned for it or, where there are
  /// none, the pushes of the pairs that were to be solved in full.
  [[nodiscard]] std::map<std::uint32_t, std::uint32_t> normal_pairs(std::uint32_t row) const {
    const auto pairs_of = [&](PairRole role) {
      std::map<std::uint32_t, std::uint32_t> pairs;
      for (std::uint32_t pair = 0; pair < plan_.pairs.size(); ++pair) {
        const PairPlan& planned = plan_.pairs[pair];
        if (planned.role != role || row_of(planned) != row || !sources_.solved(pair)) continue;
        if (solved_pair(journal_, pair)->outcome->accepted) pairs[planned.site] = pair;
      }
      return pairs;
    };
    const auto normal = pairs_of(PairRole::normal);
    return normal.empty() ? pairs_of(PairRole::full) : normal;
  }

  /// Gives the sites of a tool vertex that had a normal indentation alone the responses of those solved in full.
  void carry(std::uint32_t row) {
    const std::map<std::uint32_t, std::uint32_t> pairs = normal_pairs(row);
    const auto wants = [&](const auto& at) { return alone_.count(at.second) > 0 && !rows_[row][at.first]; };
    if (std::none_of(pairs.begin(), pairs.end(), wants)) return;
    std::map<std::uint32_t, NormalCurve> curves;
    for (const auto& [site, pair] : pairs) {
      try {
        curves.emplace(site, NormalCurve(journal_.pairs.at(pair).samples));
      } catch (const Error& error) {
        if (wants(std::pair{site, pair})) refused_.push_back({pair, error.what()});
      }
    }
    std::vector<CarrySource> sources;
    std::vector<std::uint32_t> sites;  // of the sources
    for (const auto& [site, curve] : curves) {
      if (!rows_[row][site]) continue;
      sources.push_back({&plan_.sites[site].frame, &*rows_[row][site], &curve, 0.0});
      sites.push_back(site);
    }
    if (sources.empty()) return;
    for (std::size_t k = 0; k < sources.size() && sources.size() > 1; ++k) {
      test_carried(pairs.at(sites[k]), curves.at(sites[k]), *rows_[row][sites[k]],
                   near_sources(*sources[k].frame, sources, &sources[k]));
    }
    SiteRow carried(plan_.sites.size());
    for (const auto& [site, curve] : curves) {
      if (!wants(std::pair{site, pairs.at(site)})) continue;
      try {
        carried[site] = carried_to(site, curve, sources);
        flags_[row][site] = layout::response_solved;
        ++report_.carried;
        add_normal_errors(pairs.at(site), *carried[site]);
      } catch (const Error& error) {
        refused_.push_back({pairs.at(site), error.what()});
      }
    }
    if (plan_.pairs[pairs.begin()->second].role == PairRole::normal) extrapolate(curves, sources, carried);
    for (std::size_t site = 0; site < carried.size(); ++site) {
      if (carried[site]) rows_[row][site] = std::move(carried[site]);
    }
  }

  /// Fills sites beside those with a normal indentation.
  void extrapolate(const std::map<std::uint32_t, NormalCurve>& curves, const std::vector<CarrySource>& sources,
                   SiteRow& carried) const {
    const SiteGraph graph = site_graph(plan_.sites.size(), triangles_);
    const PushField field(plan_.sites, graph, curves);
    for (const auto& [site, curve] : field.extrapolated()) {
      try {
        carried[site] = carried_to(site, curve, sources);
      } catch (const Error&) {  // filled from its neighbours with the others
      }
    }
  }

  /// Depth (m) to which a response holds: the site's, less where its normal indentation stopped short of it.
  [[nodiscard]] double depth_of(std::uint32_t site, const NormalCurve& own) const {
    constexpr double kWhole = 0.9;  // of the depth; the give of the penalty is taken off what the tool moved
    return own.deepest() >= kWhole * plan_.sites[site].depth ? plan_.sites[site].depth : own.deepest();
  }

  [[nodiscard]] std::vector<Sample> samples_carried(std::uint32_t site, const NormalCurve& own,
                                                    const std::vector<CarrySource>& sources) const {
    const double depth = depth_of(site, own);
    return carried_samples(plan_.sites[site].frame, depth, own, settings_.path(depth), sources, result_.scales);
  }

  /// Errors of a carried response at the normal indentation of its site.
  void add_normal_errors(std::uint32_t pair, const SiteResponse& site) {
    std::vector<Sample> push;
    for (const Sample& s : journal_.pairs.at(pair).samples) {
      if (s.kind == SampleKind::normal) push.push_back(s);
    }
    for (const double e : fit_errors(site.response, result_.scales, push).normal) normal_.emplace_back(e, pair);
  }

  /// Throws Error(numerical) where the carried samples cannot be fitted.
  [[nodiscard]] SiteResponse carried_to(std::uint32_t site, const NormalCurve& own,
                                        const std::vector<CarrySource>& all) const {
    const bake::PlanSite& at = plan_.sites[site];
    const double depth = depth_of(site, own);
    const std::vector<CarrySource> sources = near_sources(at.frame, all);
    std::vector<FillSource> blended;
    for (const CarrySource& source : sources) blended.push_back({source.frame, source.full, source.weight});
    SiteResponse carried = blend_sites(at.frame, depth, blended, result_.scales);
    const double softening = carried.response.softening;
    carried.response = fit_pair(samples_carried(site, own, sources), result_.scales, "carried");
    carried.response.softening = softening;
    carried.depth = depth;
    return carried;
  }

  /// Errors of tangential pushes that would have been carried to a site that was solved in full.
  void test_carried(std::uint32_t pair, const NormalCurve& own, const SiteResponse& full,
                    const std::vector<CarrySource>& sources) {
    const Potential law(full.response.coefs, result_.scales);
    const std::vector<Sample> carried = samples_carried(plan_.pairs[pair].site, own, sources);
    double peak = 0;
    for (const Sample& s : carried) peak = std::max(peak, law.force(s.deflection).norm());
    for (const Sample& s : carried) {
      if (s.kind != SampleKind::tangential) continue;
      const Eigen::Vector3d solved = law.force(s.deflection);
      const double error = (s.force - solved).norm() / std::max(solved.norm(), 0.02 * peak);
      left_out_.emplace_back(error, pair);
    }
  }

  void report_refusals() {
    report_.refused = refused_.size();
    report_.refusals = group_refusals(plan_, refused_);
    for (const bake::SkippedPair& pair : plan_.skipped) {
      ++(pair.reason == bake::SkipReason::support       ? report_.support
         : pair.reason == bake::SkipReason::unreachable ? report_.unreachable
                                                        : report_.outside);
    }
  }

  void report_errors() {
    std::sort(report_.softenings.begin(), report_.softenings.end());
    if (report_.softenings.empty() || !(report_.softenings.back() > 0)) report_.softenings.clear();
    report_.normal = error_figures(normal_);
    report_.tangential = error_figures(tangential_);
    report_.paths = error_figures(paths_);
    report_.grasped = error_figures(grasped_);
    report_.turned = error_figures(turned_);
    report_.laws = error_figures(laws_);
    report_.left_out = error_figures(left_out_);
  }

  /// A tool vertex without any response takes those of the vertex nearest to it in the file that has some.
  [[nodiscard]] SiteRow row_to_fill(std::size_t vertex) const {
    const auto known = [](const SiteRow& row) {
      return std::any_of(row.begin(), row.end(), [](const auto& site) { return site.has_value(); });
    };
    for (std::size_t step = 0; step < rows_.size(); ++step) {
      if (vertex >= step && known(rows_[vertex - step])) return rows_[vertex - step];
      if (vertex + step < rows_.size() && known(rows_[vertex + step])) return rows_[vertex + step];
    }
    refuse_all();
  }

  void fill() {
    std::vector<ContactFrame> frames;
    std::vector<double> depths;
    for (const bake::PlanSite& site : plan_.sites) {
      frames.push_back(site.frame);
      depths.push_back(site.depth);
    }
    const SiteGraph graph = site_graph(plan_.sites.size(), triangles_);
    result_.responses.resize(plan_.sites.size() * rows_.size());
    for (std::size_t vertex = 0; vertex < rows_.size(); ++vertex) {
      SiteRow row = row_to_fill(vertex);
      fill_from_neighbours(graph, frames, depths, result_.scales, row, "tool vertex " + std::to_string(vertex));
      for (std::size_t site = 0; site < row.size(); ++site) {
        result_.responses[site * rows_.size() + vertex] =
            to_response(*row[site], flags_[vertex][site], report_, result_.scales);
        report_.filled += flags_[vertex][site] == layout::response_filled ? 1 : 0;
      }
    }
  }

  const bake::Plan& plan_;
  const std::vector<std::array<std::int32_t, 3>>& triangles_;
  const JournalContent& journal_;
  const FitSettings& settings_;
  const PairSources& sources_;
  std::vector<std::uint32_t> first_;  // row of each tool's first vertex
  std::vector<SiteRow> rows_;
  std::vector<std::vector<std::uint32_t>> flags_;  // layout::ResponseFlag, by row and site
  std::set<std::uint32_t> alone_;                  // accepted pairs with a normal indentation and nothing else
  std::vector<bake::RefusedPair> refused_;
  RowErrors normal_, tangential_, paths_, grasped_, turned_, laws_, left_out_;
  FittedResponses result_;
  FitReport& report_ = result_.report;
};

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

double expected_p95(const FitReport& report) {
  if (!report.sampling) return 0.0;
  return std::hypot(report.sampling->p95(), report.normal.p95);
}

FittedResponses fit_responses(const bake::Plan& plan, const std::vector<std::array<std::int32_t, 3>>& triangles,
                              const std::vector<std::uint32_t>& tool_vertices, const JournalContent& journal,
                              const FitSettings& settings, const PairSources& sources) {
  return PlanFit(plan, triangles, tool_vertices, journal, settings, sources).run();
}

}  // namespace palpate::fit
