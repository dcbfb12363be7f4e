// SPDX-License-Identifier: GPL-3.0-or-later
// palpate fit: from a finished bake to the response file.
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/command.hpp"
#include "tools/commands.hpp"
#include "tools/output.hpp"
#include "tools/pipeline_steps.hpp"

namespace palpate::cli {
namespace {

struct Options {
  std::string scene, work, output;
};

void run(const Options& options, const Globals& globals) {
  pipeline::Pipeline p = pipeline::prepare(options.scene, {options.work, options.output});
  pipeline::plan(p);
  const FitReport report = pipeline::fit(p);
  if (globals.json) {
    print_json(fit_json(p, report));
  } else {
    print(fit_text(p, report));
  }
}

}  // namespace

void add_fit(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<Options>();
  Command command(app, "fit", "Fits the solved samples and writes the response file NAME.palp");
  command.option("scene", options->scene, "Scene file").required();
  command.option("--work", options->work, "Work folder (default: NAME.work beside the scene)");
  command.option("-o,--output", options->output, "Response file (default: NAME.palp beside the scene)");
  command.runs([options, &globals] { run(*options, globals); });
}

}  // namespace palpate::cli
