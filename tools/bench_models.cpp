// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench_models.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "formats/error.hpp"
#include "precompute/bake/pipeline.hpp"
#include "precompute/fit/coupled_degrees.hpp"
#include "precompute/fit/radial_basis.hpp"
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
  std::optional<ErrorFigures> paths;
  double stick = 0;  // ns
  std::optional<double> slide;
};

std::vector<const std::vector<Sample>*> accepted_pairs(const JournalContent& journal) {
  std::vector<const std::vector<Sample>*> pairs;
  for (const auto& [pair, solved] : journal.pairs) {
    if (solved.outcome && solved.outcome->accepted) pairs.push_back(&solved.samples);
  }
  return pairs;
}

Row measure(const pipeline::Pipeline& p, const JournalContent& journal, const FitSettings& settings,
            const std::string& name, int contacts, fit::ModelScales& scales) {
  const pipeline::FittedFile file = pipeline::fit_file(p, journal, settings);
  scales = file.fitted.scales;
  const runtime::OpenResult opened = runtime::View::open(file.bytes.data(), file.bytes.size());
  if (!opened) throw Error(ExitCode::numerical, name + ": " + opened.error);
  TickBenchOptions timing;
  timing.contacts = contacts;
  const TickBench bench = bench_ticks(opened.view, timing);
  return {name,
          bytes_per_response(opened.view),
          fit::held_out_figures(accepted_pairs(journal), file.fitted.scales),
          file.fitted.report.paths,
          bench.press.quantile(0.5),
          bench.slide.quantile(0.5)};
}

// A network is in no file: its time is that of the three evaluations that a contact inside a patch would take.
double network_time(const fit::RadialBasis& network) {
  using Clock = std::chrono::steady_clock;
  constexpr int kRounds = 20, kCalls = 2000;
  double best = HUGE_VAL, sum = 0;
  for (int round = 0; round < kRounds; ++round) {
    const auto start = Clock::now();
    for (int k = 0; k < 3 * kCalls; ++k) {
      const double share = (k % 97 + 1) / 98.0;
      sum += network.force({0.1 * share * network.sideways, 0, share * network.depth}).z();
    }
    best = std::min(best, std::chrono::duration<double, std::nano>(Clock::now() - start).count() / kCalls);
  }
  return std::isfinite(sum) ? best : HUGE_VAL;
}

Row measure_network(const JournalContent& journal, const fit::ModelScales& scales, int centres) {
  const auto fitter = [&](const std::vector<Sample>& samples) -> fit::ForceLaw {
    return [network = fit::fit_radial_basis(samples, scales, centres, "held out")](const Eigen::Vector3d& deflection) {
      return network.force(deflection);
    };
  };
  const std::vector<const std::vector<Sample>*> pairs = accepted_pairs(journal);
  Row row;
  row.model = "radial basis, " + std::to_string(centres);
  row.bytes = fit::RadialBasis::bytes(centres);
  row.error = fit::held_out_figures(pairs, fitter);
  row.stick = network_time(fit::fit_radial_basis(*pairs.at(0), scales, centres, "timed"));
  return row;
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f %%", 100 * share);
  return text;
}

std::string nanoseconds(double time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f ns", time);
  return text;
}

std::string as_text(const Row& row) {
  std::string line = "| " + row.model + " | " + std::to_string(std::lround(row.bytes));
  for (const double share : {row.error.median, row.error.p95, row.error.worst}) line += " | " + percent(share);
  if (row.paths) {
    for (const double share : {row.paths->median, row.paths->p95, row.paths->worst}) line += " | " + percent(share);
  } else {
    line += " | - | - | -";
  }
  return line + " | " + nanoseconds(row.stick) + " | " + (row.slide ? nanoseconds(*row.slide) : "-") + " |\n";
}

Json figures(std::size_t count, double median, double p95, double worst) {
  return {{"count", count}, {"median", median}, {"p95", p95}, {"worst", worst}};
}

Json as_json(const Row& row) {
  Json json{{"model", row.model},
            {"bytes_per_response", row.bytes},
            {"error", figures(row.error.samples, row.error.median, row.error.p95, row.error.worst)},
            {"tick_ns", row.stick}};
  if (row.paths) json["error_paths"] = figures(row.paths->samples, row.paths->median, row.paths->p95, row.paths->worst);
  if (row.slide) json["slide_ns"] = *row.slide;
  return json;
}

}  // namespace

void run_model_bench(const ModelBenchCommand& command, const Globals& globals) {
  pipeline::Pipeline p = pipeline::prepare(command.scene, {command.work, {}});
  if (p.scene.response.model != ResponseScene::Model::coupled) {
    throw Error(ExitCode::bad_input, command.scene +
                                         ": response.model must be \"coupled\": what its bake samples is "
                                         "what the models are compared by");
  }
  pipeline::find_pairs(p);
  check_baked(p);
  pipeline::write_manifest(p);
  const JournalContent journal = pipeline::samples(p);
  if (accepted_pairs(journal).empty()) {
    throw Error(ExitCode::bad_input,
                command.scene + ": no pair of it was solved: the models are compared by solved samples");
  }
  const double tolerance = p.scene.response.tolerance;
  const std::pair<const char*, std::optional<fit::DegreeWish>> models[] = {
      {"linear", fit::DegreeWish{2, tolerance, true}},
      {"separable", std::nullopt},
      {"coupled 2", fit::DegreeWish{2, tolerance}},
      {"coupled 3", fit::DegreeWish{3, tolerance}},
      {"coupled 4", fit::DegreeWish{4, tolerance}}};
  std::vector<Row> rows;
  fit::ModelScales scales;
  for (const auto& [name, wish] : models) {
    note(globals, std::string("fitting and timing ") + name);
    FitSettings settings = pipeline::fit_settings(p.scene);
    settings.coupled = wish;
    rows.push_back(measure(p, journal, settings, name, command.contacts, scales));
  }
  for (const int centres : {6, 24}) rows.push_back(measure_network(journal, scales, centres));
  char line[200];
  std::snprintf(line, sizeof line, "%s; %zu forces left out, %zu along paths\n", machine_name().c_str(),
                rows[0].error.samples, rows[0].paths->samples);
  std::string text = line;
  text +=
      "| model | bytes | median | 95th | worst | paths: median | 95th | worst | sticking tick | sliding |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n";
  Json json{{"machine", machine_name()}, {"scene", command.scene}, {"rows", Json::array()}};
  for (const Row& row : rows) {
    text += as_text(row);
    json["rows"].push_back(as_json(row));
  }
  globals.json ? print_json(json) : print(text);
}

}  // namespace palpate::cli
