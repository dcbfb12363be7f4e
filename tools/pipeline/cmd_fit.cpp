// SPDX-License-Identifier: GPL-3.0-or-later
// palpate fit: from a finished bake to the response file.
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"
#include "tools/pipeline/pipeline_steps.hpp"

namespace palpate::cli {
namespace {

struct FitArguments {
  std::string scene, work, output;
  std::vector<std::string> measured;
};

void run_fit(const FitArguments& options, const Globals& globals) {
  pipeline::Pipeline p = pipeline::prepare(
      options.scene, {options.work, options.output, {options.measured.begin(), options.measured.end()}});
  pipeline::plan_baked(p);
  if (!options.measured.empty()) {
    note(globals,
         "--measured is for this fit alone; build and verify read the recordings that the scene names ([[measured]])");
  }
  const fit::FitReport report = pipeline::fit(p);
  if (globals.json) {
    print_json(fit_json(p, report));
  } else {
    print(fit_text(p, report));
  }
  check_tolerance(p, report);
}

}  // namespace

void add_fit(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<FitArguments>();
  Command command(app, "fit", "Fits the solved samples and writes the response file NAME.palp");
  command.option("scene", options->scene, "Scene file").required();
  command.option("--work", options->work, "Work folder (default: NAME.work beside the scene)");
  command.option("-o,--output", options->output, "Response file (default: NAME.palp beside the scene)");
  command.option("--measured", options->measured,
                 "Recordings with a real tool (CSV, formats/recording/recording-file.md), as [[measured]] in the "
                 "scene: they stand "
                 "in place of what is solved at the sites nearest to them");
  command.runs([options, &globals] { run_fit(*options, globals); });
}

}  // namespace palpate::cli
