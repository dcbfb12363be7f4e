// SPDX-License-Identifier: GPL-3.0-or-later
// palpate plan: the pairs that a scene needs, written as the manifest.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "formats/io/file.hpp"
#include "formats/io/same_file.hpp"
#include "precompute/bake/progress.hpp"
#include "precompute/pipeline/pipeline.hpp"
#include "precompute/pipeline/plan_costs.hpp"
#include "precompute/pipeline/scene_warnings.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"
#include "tools/pipeline/pipeline_steps.hpp"
#include "tools/play/plot.hpp"

namespace palpate::cli {
namespace {

struct PlanArguments {
  std::string scene, work, plot;
  bool quick = false;
};

constexpr const char* kRoles[] = {"full", "normal", "hidden"};

std::string costs_text(const pipeline::PlanCosts& costs, const pipeline::Pipeline& p, int threads) {
  std::string text;
  char line[300];
  for (std::size_t role = 0; role < costs.roles.size(); ++role) {
    const pipeline::RoleCost& cost = costs.roles[role];
    if (cost.pairs == 0) continue;
    std::snprintf(line, sizeof line, "%-8s %5zu pairs, %zu open, %.2f s of a processor each\n", kRoles[role],
                  cost.pairs, cost.open, cost.seconds);
    text += line;
  }
  std::snprintf(line, sizeof line, "%s: %s on %d threads, %.0f MB of memory, file %.0f kB\n",
                p.automatic ? "this round" : "bake", bake::duration_text(costs.processor_seconds / threads).c_str(),
                threads, 1e-6 * costs.peak_bytes, 1e-3 * costs.file_bytes);
  text += line;
  if (!p.automatic) return text;
  if (p.sampling) text += sampling_text(*p.sampling, p.scene.response.tolerance) + "\n";
  if (!p.ended) {
    std::snprintf(line, sizeof line,
                  "rounds follow until the expected error of normal forces is within %.2f %%, or with %d sites, after "
                  "%s at most\n",
                  100 * p.scene.response.tolerance, p.scene.sampling.most_sites,
                  bake::duration_text(
                      p.scene.sampling.most_sites *
                      (costs.roles[1].seconds + pipeline::RoundLimits{}.full_share * costs.roles[0].seconds) / threads)
                      .c_str());
    text += line;
  }
  return text;
}

nlohmann::ordered_json costs_json(const pipeline::PlanCosts& costs) {
  nlohmann::ordered_json json;
  for (std::size_t role = 0; role < costs.roles.size(); ++role) {
    const pipeline::RoleCost& cost = costs.roles[role];
    json[kRoles[role]] = {{"pairs", cost.pairs}, {"open", cost.open}, {"seconds", cost.seconds}};
  }
  json["processor_seconds"] = costs.processor_seconds;
  json["peak_bytes"] = costs.peak_bytes;
  json["file_bytes"] = costs.file_bytes;
  return json;
}

void run_plan(const PlanArguments& options, const Globals& globals) {
  if (!options.plot.empty()) check_writable(options.plot);
  refuse_same({options.plot}, pipeline::files_of(options.scene, {options.work, {}}));
  pipeline::Pipeline p = pipeline::prepare(options.scene, {options.work, {}});
  pipeline::plan(p);
  for (const std::string& warning : pipeline::scene_warnings(p.scene, p.body)) warn(warning);
  const bake::Plan& plan = p.plan;
  std::size_t support = 0, unreachable = 0;
  for (const bake::SkippedPair& pair : plan.skipped) {
    support += pair.reason == bake::SkipReason::support ? 1 : 0;
    unreachable += pair.reason == bake::SkipReason::unreachable ? 1 : 0;
  }
  std::vector<double> depths;
  for (const PairPlan& pair : plan.pairs) depths.push_back(pair.depth);
  std::sort(depths.begin(), depths.end());
  if (!options.plot.empty()) {
    std::vector<PlotSeries> series;
    for (const tool::Tool& tool : p.tools) series.push_back({tool.scene.name, {}});
    for (const PairPlan& pair : plan.pairs) series[pair.tool].values.push_back(1e3 * pair.depth);
    write_file(options.plot, distribution_svg("Deepest pushes of " + p.scene.name, "depth (mm)", series));
  }
  std::size_t solved = 0;
  for (std::uint32_t k = 0; k < plan.pairs.size(); ++k) solved += p.sources.solved(k) ? 1 : 0;
  const fit::ExternalCounts external = fit::count_external(p.sources);
  const std::size_t filled = plan.pairs.size() - solved - external.measured - external.analytic;

  std::optional<pipeline::PlanCosts> costs;
  if (!options.quick) costs = pipeline::cost_plan(p, globals.threads);
  if (globals.json) {
    print_json({{"sites", plan.sites.size()},
                {"pairs_planned", solved},
                {"pairs_measured", external.measured},
                {"pairs_analytic", external.analytic},
                {"pairs_filled", filled},
                {"pairs_on_support", support},
                {"support_area_share", plan.support_share},
                {"pairs_unreachable", unreachable},
                {"unreachable_area_share", plan.unreachable_share},
                {"pairs_outside", plan.skipped.size() - support - unreachable},
                {"depth_min", depths.front()},
                {"depth_median", depths[depths.size() / 2]},
                {"depth_max", depths.back()},
                {"manifest", p.paths.manifest.string()},
                {"manifest_hash", to_hex(p.manifest)},
                {"automatic", p.automatic},
                {"costs", costs ? costs_json(*costs) : nlohmann::ordered_json()}});
    return;
  }
  char text[640], others[128] = "";
  if (solved < plan.pairs.size()) {
    std::snprintf(others, sizeof others, "; %zu recorded, %zu by closed forms, %zu filled from neighbours",
                  external.measured, external.analytic, filled);
  }
  std::snprintf(text, sizeof text,
                "%s, %s to solve%s\n"
                "not touchable: %s on or beside a support (%.1f %% of the area), %zu in folds narrower than the tool "
                "(%.1f %%), %zu outside the region\n"
                "depth %.2f to %.2f mm, median %.2f mm\n",
                counted(plan.sites.size(), "site").c_str(), counted(solved, "pair").c_str(), others,
                counted(support, "pair").c_str(), 100 * plan.support_share, unreachable, 100 * plan.unreachable_share,
                plan.skipped.size() - support - unreachable, 1e3 * depths.front(), 1e3 * depths.back(),
                1e3 * depths[depths.size() / 2]);
  print(text + (costs ? costs_text(*costs, p, globals.threads) : std::string()) + p.paths.manifest.string() + "\n");
}

}  // namespace

void add_plan(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<PlanArguments>();
  Command command(app, "plan", "Lists every pair to be solved (NAME.work/manifest.json) and what that costs");
  command.option("scene", options->scene, "Scene file").required();
  command.option("--work", options->work, "Work folder (default: NAME.work beside the scene)");
  command.flag("--quick", options->quick, "Do not time a pair: no hours and no memory");
  command.option("--plot", options->plot, "Write a plot of the pairs' depths here (SVG)");
  command.runs([options, &globals] { run_plan(*options, globals); });
}

}  // namespace palpate::cli
