// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate build`: every stage from a scene to its response file, going on with what is there.
#include "precompute/pipeline/scene_warnings.hpp"
#include "precompute/surface/repair/report.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"
#include "tools/pipeline/pipeline_steps.hpp"
#ifdef PALPATE_REPORT
#include "tools/report/files.hpp"
#include "tools/report/page.hpp"
#endif

#include <memory>
#include <nlohmann/json.hpp>

namespace palpate::cli {
namespace {

struct BuildArguments {
  std::string scene, work, output;
  bool report = false;
};

void run_build(const BuildArguments& options, const Globals& globals) {
#ifdef PALPATE_REPORT
  if (options.report) report::require_page();
#endif
  pipeline::Pipeline p = pipeline::prepare(options.scene, {options.work, options.output});
  note(globals, surface::text(p.body));
  if (p.body.report.thin_bag) {
    warn("the body looks like a thin closed bag, not a solid: its median wall is " +
         std::to_string(1e3 * p.body.report.thickness_median) + " mm thick");
  }
  for (const std::string& warning : pipeline::scene_warnings(p.scene, p.body)) warn(warning);
  check_writable(p.paths.response);  // found after hours of solves it would be found too late
  pipeline::plan(p);
  const bake::BakeReport bake = bake_with_progress(p, globals);
  const fit::FitReport fit = pipeline::fit(p);
  nlohmann::ordered_json json{{"bake", bake_json(p, bake)}, {"fit", fit_json(p, fit)}};
  std::string results = bake_text(p, bake) + fit_text(p, fit);
#ifdef PALPATE_REPORT
  if (options.report) {
    report::ReportInput input;
    input.scene = options.scene;
    const report::WrittenReport written = write_report_files(input, {{}, {}, options.work, options.output}, globals);
    json["report"] = to_json(written);
    results += to_text(written);
  }
#endif
  globals.json ? print_json(json) : print(results);
  check_tolerance(p, fit);
}

}  // namespace

void add_build(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<BuildArguments>();
  Command command(app, "build", "Bakes a scene: mesh, plan, bake, fit; writes NAME.palp");
  command.option("scene", options->scene, "Scene file (TOML)").required();
  command.option("--work", options->work, "Work folder (default: NAME.work beside the scene)");
  command.option("-o,--output", options->output, "Response file (default: NAME.palp beside the scene)");
#ifdef PALPATE_REPORT
  command.flag("--report", options->report, "Also write the page of 'palpate report'");
#endif
  command.runs([options, &globals] { run_build(*options, globals); });
}

}  // namespace palpate::cli
