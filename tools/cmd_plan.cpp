// SPDX-License-Identifier: GPL-3.0-or-later
// palpate plan: the pairs that a scene needs, written as the manifest.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "formats/file.hpp"
#include "formats/same_file.hpp"
#include "precompute/bake/pipeline.hpp"
#include "tools/command.hpp"
#include "tools/commands.hpp"
#include "tools/output.hpp"
#include "tools/plot.hpp"

namespace palpate::cli {
namespace {

struct PlanArguments {
  std::string scene, work, plot;
};

void run_plan(const PlanArguments& options, const Globals& globals) {
  pipeline::Pipeline p = pipeline::prepare(options.scene, {options.work, {}});
  std::vector<std::filesystem::path> inputs = files_of(p.scene);
  inputs.emplace_back(options.scene);
  refuse_same({options.plot}, inputs);
  pipeline::plan(p);
  const Plan& plan = p.plan;
  std::size_t support = 0, unreachable = 0;
  for (const SkippedPair& pair : plan.skipped) {
    support += pair.reason == SkipReason::support ? 1 : 0;
    unreachable += pair.reason == SkipReason::unreachable ? 1 : 0;
  }
  std::vector<double> depths;
  for (const PairPlan& pair : plan.pairs) depths.push_back(pair.depth);
  std::sort(depths.begin(), depths.end());
  if (!options.plot.empty()) {
    std::vector<PlotSeries> series;
    for (const Tool& tool : p.tools) series.push_back({tool.scene.name, {}});
    for (const PairPlan& pair : plan.pairs) series[pair.tool].values.push_back(1e3 * pair.depth);
    write_file(options.plot, distribution_svg("Deepest pushes of " + p.scene.name, "depth (mm)", series));
  }
  std::size_t solved = 0;
  for (std::uint32_t k = 0; k < plan.pairs.size(); ++k) solved += p.sources.solved(k) ? 1 : 0;
  const GivenCounts given = count_given(p.sources);
  const std::size_t filled = plan.pairs.size() - solved - given.measured - given.analytic;

  if (globals.json) {
    print_json({{"sites", plan.sites.size()},
                {"pairs_planned", solved},
                {"pairs_measured", given.measured},
                {"pairs_analytic", given.analytic},
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
                {"manifest_hash", to_hex(p.manifest)}});
    return;
  }
  char text[640], others[128] = "";
  if (solved < plan.pairs.size()) {
    std::snprintf(others, sizeof others, "; %zu recorded, %zu by closed forms, %zu filled from neighbours",
                  given.measured, given.analytic, filled);
  }
  std::snprintf(
      text, sizeof text,
      "%zu sites, %zu pairs to solve%s\n"
      "not touchable: %zu pairs on or beside a support (%.1f %% of the area), %zu in folds narrower than the tool "
      "(%.1f %%), %zu outside the region\n"
      "depth %.2f to %.2f mm, median %.2f mm\n",
      plan.sites.size(), solved, others, support, 100 * plan.support_share, unreachable, 100 * plan.unreachable_share,
      plan.skipped.size() - support - unreachable, 1e3 * depths.front(), 1e3 * depths.back(),
      1e3 * depths[depths.size() / 2]);
  print(text + p.paths.manifest.string() + "\n");
}

}  // namespace

void add_plan(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<PlanArguments>();
  Command command(app, "plan", "Lists every pair to be solved (NAME.work/manifest.json)");
  command.option("scene", options->scene, "Scene file").required();
  command.option("--work", options->work, "Work folder (default: NAME.work beside the scene)");
  command.option("--plot", options->plot, "Write a plot of the pairs' depths here (SVG)");
  command.runs([options, &globals] { run_plan(*options, globals); });
}

}  // namespace palpate::cli
