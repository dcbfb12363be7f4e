// SPDX-License-Identifier: GPL-3.0-or-later
// palpate fit: from a finished bake to the response file.
#include <memory>
#include <nlohmann/json.hpp>

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
  CLI::App* command = app.add_subcommand("fit", "Fits the solved samples and writes the response file NAME.palp");
  command->add_option("scene", options->scene, "Scene file")->required();
  command->add_option("--work", options->work, "Work folder (default: NAME.work beside the scene)");
  command->add_option("-o,--output", options->output, "Response file (default: NAME.palp beside the scene)");
  command->callback([options, &globals] { run(*options, globals); });
}

}  // namespace palpate::cli
