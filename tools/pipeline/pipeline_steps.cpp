// SPDX-License-Identifier: GPL-3.0-or-later
// Progress and reports of bake and fit.
#include "tools/pipeline/pipeline_steps.hpp"

#include "precompute/bake/progress.hpp"
#include "tools/cli/interrupt.hpp"
#include "tools/cli/output.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

namespace palpate::cli {
namespace {

/// How long an interrupted bake waits for the solves that are running.
constexpr std::chrono::milliseconds kPatience{1500};

std::string kept_text(std::size_t finished, std::size_t total) {
  return std::to_string(finished) + " of " + std::to_string(total) +
         " pairs are solved and kept; run the same command again to go on";
}

nlohmann::ordered_json figures_json(const fit::ErrorFigures& figures) {
  return {{"samples", figures.samples},
          {"median", figures.median},
          {"p95", figures.p95},
          {"worst", figures.worst},
          {"worst_pair", figures.worst_pair}};
}

std::string figures_text(const char* name, const fit::ErrorFigures& f, const bake::Plan& plan) {
  if (f.samples == 0) return {};
  char text[256];
  std::snprintf(text, sizeof text, "fit, %s: median %.2f %%, 95th percentile %.2f %%, worst %.2f %% in ", name,
                100 * f.median, 100 * f.p95, 100 * f.worst);
  return text + bake::describe(f.worst_pair, plan.pairs[f.worst_pair]) + "\n";
}

std::string recorded_text(const fit::RecordedFigures& f, const bake::Plan& plan) {
  constexpr std::size_t kShown = 10;
  char text[256];
  std::snprintf(text, sizeof text,
                ": %zu rows down to %.3g mm, residual %.3g N rms and %.3g N at worst, %zu left out as outliers", f.rows,
                1e3 * f.depth, f.rms, f.worst, f.outliers.size());
  std::string line = "measured, " + bake::describe(f.pair, plan.pairs[f.pair]) + text;
  for (std::size_t k = 0; k < std::min(kShown, f.outliers.size()); ++k) line += (k == 0 ? ": " : ", ") + f.outliers[k];
  if (f.outliers.size() > kShown) line += ", ... (all by --json)";
  if (f.passed.total() > 0) line += "; " + to_text(f.passed);
  return line + "\n";
}

nlohmann::ordered_json to_json(const compliance::ComplianceReport& report) {
  nlohmann::ordered_json errors = nlohmann::ordered_json::array();
  for (const compliance::ComplianceError& e : report.errors) {
    errors.push_back({{"modes", e.modes}, {"median", e.median}, {"p95", e.p95}, {"worst", e.worst}});
  }
  return {{"modes", report.chosen.modes},
          {"p95", report.chosen.p95},
          {"reached", report.reached},
          {"nodes", report.nodes},
          {"solved_sites", report.columns},
          {"left_out_sites", report.left_out},
          {"load_radius_m", report.load_radius},
          {"self_m_per_N", report.self},
          {"stiffening", report.stiffening.stiffening},
          {"stiffening_pairs", report.stiffening.pairs},
          {"stiffening_error", report.stiffening.error},
          {"stiffening_error_without", report.stiffening.error_without},
          {"stiffening_cause", report.stiffening.cause},
          {"errors", errors}};
}

std::string to_text(const compliance::ComplianceReport& report) {
  char line[256];
  std::snprintf(line, sizeof line,
                "compliance: %d modes, error between sites %.2f %% median, %.2f %% 95th percentile of a site's own "
                "(%zu of %zu solved sites left out)%s\n",
                report.chosen.modes, 100 * report.chosen.median, 100 * report.chosen.p95, report.left_out,
                report.columns, report.reached ? "" : "; the tolerance is not met");
  const compliance::StiffeningReport& s = report.stiffening;
  if (!s.cause.empty()) return line + ("compliance: stiffening with depth is not measured: " + s.cause) + "\n";
  char more[256];
  std::snprintf(
      more, sizeof more,
      "compliance: stiffening %.2f; %zu pairs of tools at once lose %.1f %% more or less than solved (%.1f %% "
      "without)\n",
      s.stiffening, s.pairs, 100 * s.error, 100 * s.error_without);
  return std::string(line) + more;
}

}  // namespace

std::string sampling_text(const bake::SamplingEstimate& estimate, double tolerance) {
  char text[320];
  std::snprintf(
      text, sizeof text,
      "round %d: 95th percentile %.2f %% (aim %.2f %%), the mean of %.2f %% at %zu hidden pushes and of %.2f %% "
      "predicted from the sites; hidden pushes: median %.2f %%, worst %.1f %% at (%.4g, %.4g, %.4g) m",
      estimate.rounds, 100 * estimate.p95(), 100 * pipeline::RoundLimits{}.aim * tolerance, 100 * estimate.hidden_p95,
      estimate.places, 100 * estimate.edges_p95, 100 * estimate.median, 100 * estimate.worst, estimate.worst_at.x(),
      estimate.worst_at.y(), estimate.worst_at.z());
  return text;
}

bake::BakeReport bake_with_progress(pipeline::Pipeline& p, const Globals& globals) {
  pipeline::bake_seconds(p);  // a damaged account is found before the first solve
  const InterruptPolling polling;
  bake::ProgressPrinter printer(stderr);
  bake::BakeOptions bake;
  bake.threads = static_cast<unsigned>(globals.threads);
  bake::BakeProgress last;
  std::optional<std::chrono::steady_clock::time_point> told;
  bake.stop = [&] {
    if (!interrupted()) return false;
    const auto now = std::chrono::steady_clock::now();
    if (!told) {
      told = now;
      printer.finish();
      note(globals, "stopping; what is solved is kept, and Ctrl-C again ends at once");
    } else if (now - *told > kPatience) {
      // Records reach the journal whole, one write each: nothing that was accepted is lost by not waiting.
      std::fprintf(stderr, "palpate: interrupted: %s\n", kept_text(last.done, last.total).c_str());
      std::_Exit(interrupt_exit_code());
    }
    return true;
  };
  bake.progress = [&](const bake::BakeProgress& progress) {
    last = progress;
    if (!globals.quiet) printer(progress);
  };
  bake::BakeReport report;
  for (;;) {
    const std::size_t resumed = report.resumed, rounds = p.sampling ? static_cast<std::size_t>(p.sampling->rounds) : 0;
    report = pipeline::bake(p, bake);
    printer.finish();
    if (rounds > 0) report.resumed = resumed;
    // The next round of shards follows when they are merged.
    if (p.shard || report.stopped || interrupted() || !pipeline::resume(p)) break;
    note(globals, sampling_text(*p.sampling, p.scene.response.tolerance) + "; round " +
                      std::to_string(p.sampling->rounds + 1) + " has " + std::to_string(p.plan.sites.size()) +
                      " sites");
  }
  if (report.torn_bytes > 0) {
    note(globals,
         "the journal ended in " + std::to_string(report.torn_bytes) + " bytes of an unfinished record: cut off");
  }
  // A signal that came after the last solve had begun is obeyed, too.
  if (report.stopped || interrupted()) {
    throw Interrupted(kept_text(report.finished(), report.total));
  }
  return report;
}

nlohmann::ordered_json bake_json(const pipeline::Pipeline& p, const bake::BakeReport& report) {
  nlohmann::ordered_json json{{"pairs_planned", report.total},
                              {"pairs_accepted", report.accepted},
                              {"pairs_refused", report.refused.size()},
                              {"pairs_resumed", report.resumed},
                              {"normal_solves", report.normal_solves},
                              {"tangential_solves", report.tangential_solves},
                              {"factorisations", report.factorisations},
                              {"torn_bytes", report.torn_bytes},
                              {"bake_seconds", pipeline::bake_seconds(p)},
                              {"journal", p.paths.journal.string()},
                              {"refused", nlohmann::ordered_json::array()}};
  for (const bake::RefusedPair& refused : report.refused) {
    json["refused"].push_back({{"pair", refused.pair},
                               {"site", p.plan.pairs[refused.pair].site},
                               {"tool", p.plan.pairs[refused.pair].tool},
                               {"tool_vertex", p.plan.pairs[refused.pair].tool_vertex},
                               {"cause", refused.cause}});
  }
  return json;
}

std::string bake_text(const pipeline::Pipeline& p, const bake::BakeReport& report) {
  std::string text = std::to_string(report.accepted) + " of " + counted(report.total, "pair") + " accepted, " +
                     std::to_string(report.refused.size()) + " refused, " + std::to_string(report.normal_solves) +
                     " normal and " + std::to_string(report.tangential_solves) + " tangential solves, " +
                     bake::duration_text(pipeline::bake_seconds(p)) + (p.shard ? " in all shards\n" : " in all\n");
  for (const bake::RefusedPair& refused : report.refused) {
    text += "refused: " + bake::describe(refused.pair, p.plan.pairs[refused.pair]) + ": " + refused.cause + "\n";
  }
  return text;
}

nlohmann::ordered_json fit_json(const pipeline::Pipeline& p, const fit::FitReport& report) {
  nlohmann::ordered_json json{{"pairs_planned", report.planned},
                              {"pairs_accepted", report.accepted},
                              {"pairs_refused", report.refused},
                              {"rounds", report.sampling ? report.sampling->rounds : 1},
                              {"expected_p95", fit::expected_p95(report)},
                              {"responses_full", report.full},
                              {"responses_carried", report.carried},
                              {"responses_filled", report.filled},
                              {"fit_error_carried_tangential", figures_json(report.left_out)},
                              {"refusals", nlohmann::ordered_json::array()},
                              {"fit_error_normal", figures_json(report.normal)},
                              {"fit_error_tangential", figures_json(report.tangential)},
                              {"fit_error_paths", figures_json(report.paths)},
                              {"fit_error_grasped", figures_json(report.grasped)},
                              {"fit_error_analytic", figures_json(report.laws)},
                              {"responses_analytic", report.analytic},
                              {"responses_measured", report.recorded.size()},
                              {"measured", nlohmann::ordered_json::array()},
                              {"fit_error_turned", figures_json(report.turned)},
                              {"held_out_p95", report.held_out.p95},
                              {"tangential_bias", report.bias},
                              {"friction", report.friction},
                              {"bonded", report.grasp},
                              {"bonded_torque", report.turn},
                              {"contact_surface",
                               {{"triangles", report.surface.triangles},
                                {"tolerance_m", report.surface.tolerance},
                                {"distance_m", report.surface.distance},
                                {"fault", report.surface.fault}}},
                              {"file", p.paths.response.string()},
                              {"bytes", std::filesystem::file_size(p.paths.response)},
                              {"pairs", nlohmann::ordered_json::array()}};
  if (report.compliance) json["compliance"] = to_json(*report.compliance);
  for (const fit::RecordedFigures& f : report.recorded) {
    json["measured"].push_back({{"pair", f.pair},
                                {"site", p.plan.pairs[f.pair].site},
                                {"rows", f.rows},
                                {"passed_over",
                                 {{"not_in_contact", f.passed.out},
                                  {"too_deep", f.passed.deep},
                                  {"too_far_aside", f.passed.aside},
                                  {"of_weight_0", f.passed.weightless}}},
                                {"outliers", f.outliers},
                                {"residual_rms_N", f.rms},
                                {"residual_worst_N", f.worst},
                                {"depth_m", f.depth}});
  }
  for (const fit::Refusals& kind : report.refusals) {
    json["refusals"].push_back({{"pairs", kind.pairs}, {"area_share", kind.area_share}, {"example", kind.example}});
  }
  for (const fit::PairFigures& f : report.pairs) {
    json["pairs"].push_back({{"pair", f.pair}, {"median", f.median}, {"p95", f.p95}, {"worst", f.worst}});
  }
  return json;
}

void check_tolerance(const pipeline::Pipeline& p, const fit::FitReport& report) {
  const double share =
      static_cast<double>(report.refused) / static_cast<double>(std::max<std::size_t>(report.planned, 1));
  const double expected = fit::expected_p95(report), asked = p.scene.response.tolerance;
  char text[400];
  if (share <= p.scene.sampling.max_refused) {
    if (expected <= asked) return;
    const Eigen::Vector3d& at = report.sampling->worst_at;
    std::snprintf(
        text, sizeof text,
        "normal forces are expected to be off by %.2f %% at the 95th percentile, allowed %.2f %%; the worst of "
        "%zu hidden pushes, %.1f %%, lies at (%.4g, %.4g, %.4g) m. %s",
        100 * expected, 100 * asked, report.sampling->places, 100 * report.sampling->worst, at.x(), at.y(), at.z(),
        p.plan.sites.size() >= static_cast<std::size_t>(p.scene.sampling.most_sites)
            ? "All of sampling.most_sites were used: allow more. Written: "
            : "Written: ");
    throw Error(ExitCode::tolerance, text + p.paths.response.string());
  }
  std::snprintf(text, sizeof text,
                "%zu of %zu pairs were refused (%.1f %%, allowed %.1f %%; scene: sampling.max_refused) and are filled "
                "from their neighbours in ",
                report.refused, report.planned, 100 * share, 100 * p.scene.sampling.max_refused);
  throw Error(ExitCode::tolerance, text + p.paths.response.string());
}

std::string fit_text(const pipeline::Pipeline& p, const fit::FitReport& report) {
  std::string text = counted(report.accepted, "pair") + " fitted, " + counted(report.filled, "response") +
                     " filled from neighbours (" + std::to_string(report.refused) + " refused, " +
                     std::to_string(report.support) + " at supports, " + std::to_string(report.unreachable) +
                     " in narrow folds, " + std::to_string(report.outside) + " outside the region)\n" +
                     to_text(report.refusals);
  if (report.sampling) {
    text += sampling_text(*report.sampling, p.scene.response.tolerance) + "\n";
    char line[120];
    std::snprintf(line, sizeof line, "expected error of normal forces: 95th percentile %.2f %%, allowed %.2f %%\n",
                  100 * fit::expected_p95(report), 100 * p.scene.response.tolerance);
    text += line;
  }
  if (report.carried > 0) {
    text += counted(report.full, "response") + " solved in full, " + std::to_string(report.carried) +
            " carried from these to sites with a normal indentation\n";
  }
  text += figures_text("normal pushes", report.normal, p.plan);
  text += figures_text("tangential pushes", report.tangential, p.plan);
  text += figures_text("paths that were not fitted", report.paths, p.plan);
  text += figures_text("carried tangential pushes, left out", report.left_out, p.plan);
  text += figures_text("bonded contacts", report.grasped, p.plan);
  if (report.analytic > 0) text += counted(report.analytic, "response") + " by closed forms\n";
  text += figures_text("closed forms", report.laws, p.plan);
  for (const fit::RecordedFigures& f : report.recorded) text += recorded_text(f, p.plan);
  text += figures_text("torques of rotated tools", report.turned, p.plan);
  if (!report.softenings.empty()) {
    char line[160];
    std::snprintf(line, sizeof line, "share of the normal force that slip removes: median %.2f %%, at most %.2f %%\n",
                  100 * report.softenings[report.softenings.size() / 2], 100 * report.softenings.back());
    text += line;
  }
  if (report.held_out.samples > 0) {
    char line[160];
    std::snprintf(line, sizeof line,
                  "%zu samples left out, with the chosen degrees: median %.2f %%, 95th percentile %.2f %%\n",
                  report.held_out.samples, 100 * report.held_out.median, 100 * report.held_out.p95);
    text += line;
  }
  const fit::SurfaceFigures& surface = report.surface;
  char line[160];
  std::snprintf(line, sizeof line,
                "contact surface: %zu triangles, at most %.3g mm from the body's (allowed: %.3g mm)\n",
                surface.triangles, 1e3 * surface.distance, 1e3 * surface.tolerance);
  text += line;
  if (report.compliance) text += to_text(*report.compliance);
  if (!surface.fault.empty()) text += surface.fault + "; the patches themselves stand for the body's surface\n";
  return text + p.paths.response.string() + ", " + std::to_string(std::filesystem::file_size(p.paths.response)) +
         " bytes\n";
}

}  // namespace palpate::cli
