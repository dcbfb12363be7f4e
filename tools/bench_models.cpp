// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench_models.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "formats/error.hpp"
#include "precompute/bake/pipeline.hpp"
#include "precompute/fit/coupled_degrees.hpp"
#include "tools/output.hpp"
#include "tools/response_input.hpp"
#include "tools/tick_bench.hpp"
#include "tools/verify_checks.hpp"

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Row {
  std::string model;
  double bytes = 0;
  fit::HeldOutFigures error;
  ErrorFigures paths;
  double stick = 0, slide = 0;  // ns
};

Row measure(const pipeline::Pipeline& p, const JournalContent& journal, const FitSettings& settings,
            const std::string& name, int contacts) {
  const pipeline::FittedFile file = pipeline::fit_file(p, journal, settings);
  const runtime::OpenResult opened = runtime::View::open(file.bytes.data(), file.bytes.size());
  if (!opened) throw Error(ExitCode::numerical, name + ": " + opened.error);
  std::vector<const std::vector<Sample>*> pairs;
  for (const auto& [pair, solved] : journal.pairs) {
    if (solved.outcome && solved.outcome->accepted) pairs.push_back(&solved.samples);
  }
  TickBenchOptions timing;
  timing.contacts = contacts;
  const TickBench bench = bench_ticks(opened.view, timing);
  return {name,
          bytes_per_response(opened.view),
          fit::held_out_figures(pairs, file.fitted.scales),
          file.fitted.report.paths,
          bench.press.quantile(0.5),
          bench.slide.quantile(0.5)};
}

}  // namespace

void run_model_bench(const ModelBenchCommand& command, const Globals& globals) {
  pipeline::Pipeline p = pipeline::prepare(command.scene, {command.work, {}});
  if (p.scene.response.model != ResponseScene::Model::coupled) {
    throw Error(ExitCode::bad_input, command.scene +
                                         ": response.model must be \"coupled\": what its bake samples is "
                                         "what the models are compared by");
  }
  check_baked(p);
  pipeline::plan(p);
  const JournalContent journal = pipeline::samples(p);
  std::vector<Row> rows;
  FitSettings settings = pipeline::fit_settings(p.scene);
  for (const int order : {0, 2, 3, 4}) {
    const std::string name = order == 0 ? "separable" : "coupled " + std::to_string(order);
    note(globals, "fitting and timing " + name);
    settings.coupled.reset();
    if (order > 0) settings.coupled = {order, p.scene.response.tolerance};
    rows.push_back(measure(p, journal, settings, name, command.contacts));
  }
  char line[200];
  std::snprintf(line, sizeof line, "%s; %zu forces left out, %zu along paths\n", machine_name().c_str(),
                rows[0].error.samples, rows[0].paths.samples);
  std::string text = line;
  text +=
      "| model | bytes | median | 95th | worst | paths: median | 95th | worst | sticking tick | sliding |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n";
  Json json{{"machine", machine_name()}, {"scene", command.scene}, {"rows", Json::array()}};
  for (const Row& row : rows) {
    std::snprintf(line, sizeof line,
                  "| %s | %.0f | %.2f %% | %.2f %% | %.2f %% | %.2f %% | %.2f %% | %.2f %% | %.0f ns | %.0f ns |\n",
                  row.model.c_str(), row.bytes, 100 * row.error.median, 100 * row.error.p95, 100 * row.error.worst,
                  100 * row.paths.median, 100 * row.paths.p95, 100 * row.paths.worst, row.stick, row.slide);
    text += line;
    json["rows"].push_back({{"model", row.model},
                            {"bytes_per_response", row.bytes},
                            {"error",
                             {{"count", row.error.samples},
                              {"median", row.error.median},
                              {"p95", row.error.p95},
                              {"worst", row.error.worst}}},
                            {"error_paths",
                             {{"count", row.paths.samples},
                              {"median", row.paths.median},
                              {"p95", row.paths.p95},
                              {"worst", row.paths.worst}}},
                            {"tick_ns", row.stick},
                            {"slide_ns", row.slide}});
  }
  globals.json ? print_json(json) : print(text);
}

}  // namespace palpate::cli
