// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/cost.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "formats/io/error.hpp"
#include "precompute/verify/held_out/statistics.hpp"
#include "tools/bench/bench_models.hpp"
#include "tools/bench/tick_bench.hpp"
#include "tools/cli/output.hpp"
#include "tools/report/numbers.hpp"

namespace palpate::report {
namespace {

Json figures(const verify::ErrorStatistics& s) {
  return {{"count", s.count}, {"median", s.median}, {"p95", s.p95}, {"worst", s.worst}};
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100 * share);
  return text;
}

/// Bytes, time and held-out error of one file.
Json file_row(const runtime::View& view, const CostInput& input) {
  cli::TickBenchOptions timing;
  timing.contacts = input.contacts;
  const layout::Meta& m = *view.meta;
  Json row{{"bytes", view.size},
           {"bytes_per_response", cli::bytes_per_response(view)},
           {"coefficient_bits", m.coef_bits},
           {"coefficients", response::count(response::degrees(m))},
           {"degrees", {m.normal_degree, m.bias_degree, m.stiffness_degree, m.friction_degree}},
           {"sites", m.site_count},
           {"tick_ns", rounded(cli::bench_ticks(view, timing).press.quantile(0.5))}};
  if (input.held_out.empty()) return row;
  std::vector<verify::HeldOut> contacts = input.held_out;
  verify::compare_with_file(view, contacts);
  const verify::VerifyStatistics s = verify::summarise(contacts);
  row["error"] = figures(s.normal);
  if (s.tangential.count > 0) row["error_tangential"] = figures(s.tangential);
  return row;
}

using Form = std::array<std::uint32_t, 5>;
Form form_of(const layout::Meta& m) {
  return {m.coef_bits, m.normal_degree, m.bias_degree, m.stiffness_degree, m.friction_degree};
}

/// The same samples fitted to other tolerances, which choose degrees and coefficient widths: each new form once.
void add_tolerances(Json& files, const CostInput& input, const cli::Globals& globals) {
  const pipeline::Pipeline& p = input.pipeline;
  std::set<Form> seen{form_of(*input.response.view().meta)};
  for (const double tolerance : {0.3, 0.1, 0.05, 0.02, 0.01, 0.003}) {
    cli::note(globals, "fitting to a tolerance of " + percent(tolerance));
    fit::FitSettings settings = pipeline::fit_settings(p);
    settings.tolerance = tolerance;
    const pipeline::FittedFile file = pipeline::fit_file(p, input.journal, settings);
    const runtime::OpenResult opened = runtime::View::open(file.bytes.data(), file.bytes.size());
    if (!opened || !seen.insert(form_of(*opened.view.meta)).second) continue;
    Json row{{"label", "tolerance " + percent(tolerance)},
             {"chosen", false},
             {"kind", "tolerance"},
             {"tolerance", tolerance}};
    row.update(file_row(opened.view, input));
    row["spacing_m"] = p.scene.sampling.spacing;
    row["bake_hours"] = rounded(pipeline::bake_seconds(p) / 3600);
    files.push_back(row);
  }
}

void add_beside(Json& files, const CostInput& input, const std::string& scene) {
  pipeline::Pipeline p = pipeline::prepare(scene);
  pipeline::plan(p);
  pipeline::resume(p);
  const cli::ResponseInput response(p.paths.response);
  char label[64];
  std::snprintf(label, sizeof label, "spacing %.3g mm", 1e3 * p.scene.sampling.spacing);
  Json row{{"label", label},
           {"chosen", false},
           {"kind", "scene"},
           {"scene", scene},
           {"tolerance", p.scene.response.tolerance}};
  row.update(file_row(response.view(), input));
  row["spacing_m"] = p.scene.sampling.spacing;
  row["bake_hours"] = rounded(pipeline::bake_seconds(p) / 3600);
  files.push_back(row);
}

/// The plain solve: time of an equilibrium, and the error that the solver estimates for its normal indentations.
Json solve_row(const CostInput& input) {
  std::vector<double> errors;
  std::size_t equilibria = 0;
  for (const auto& [index, pair] : input.journal.pairs) {
    if (pair.outcome) equilibria += pair.outcome->normal_solves + pair.outcome->tangential_solves;
    for (const Sample& s : pair.samples) {
      if (s.kind == SampleKind::normal) errors.push_back(s.error_estimate);
    }
  }
  if (equilibria == 0) return nullptr;
  return {{"equilibria", equilibria},
          {"ns", rounded(1e9 * pipeline::bake_seconds(input.pipeline) / static_cast<double>(equilibria))},
          {"error",
           {{"count", errors.size()},
            {"median", rounded(verify::quantile(errors, 0.5))},
            {"p95", rounded(verify::quantile(errors, 0.95))},
            {"worst", rounded(verify::quantile(errors, 1))}}}};
}

}  // namespace

Json error_against_time(const CostInput& input, const cli::Globals& globals) {
  const pipeline::Pipeline& p = input.pipeline;
  Json json{{"noticeable", kNoticeable}, {"machine", cli::machine_name()}, {"laws", Json::array()}};
  if (input.laws) json["laws"] = cli::model_rows_json(p, input.journal, input.contacts, globals);
  json["solve"] = solve_row(input);
  Json& files = json["files"];
  Json own{{"label", "this file"}, {"chosen", true}, {"kind", "file"}, {"tolerance", p.scene.response.tolerance}};
  own.update(file_row(input.response.view(), input));
  own["spacing_m"] = p.scene.sampling.spacing;
  own["bake_hours"] = rounded(pipeline::bake_seconds(p) / 3600);
  files.push_back(own);
  if (input.held_out.empty()) return json;
  if (input.laws) add_tolerances(files, input, globals);
  for (const std::string& scene : input.beside) add_beside(files, input, scene);
  return json;
}

}  // namespace palpate::report
